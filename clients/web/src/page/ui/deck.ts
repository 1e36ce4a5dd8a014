/** The deck: what can be done with a loop, or how a recording is played. */

import type { Live } from "../sources/live";
import type { Playback } from "../sources/playback";
import type { World } from "../world";
import { clock } from "../units";
import { byId, el, icon, ICONS, setText } from "./dom";
import type { Notices } from "./notices";
import type { Theme } from "./theme";

function button(id: string, label: string, title: string, path: string, press: () => void, filled = false): HTMLButtonElement {
  return el("button", { id, type: "button", title, "aria-label": label, onclick: press }, icon(path, filled), el("span", { class: "long" }, ` ${label}`));
}

export interface Saving {
  picture(): void;
  nets(): void;
  step(): void;
}

const savers = (saving: Saving): HTMLElement => el("div", { class: "group push" },
  button("save-picture", "Picture", "Save the picture as PNG (P)", ICONS.picture, () => saving.picture()),
  button("save-net", "OBJ", "Save the surfaces as OBJ, triangles (O)", ICONS.save, () => saving.nets()),
  button("save-step", "STEP", "Save the surfaces as STEP, exact (E)", ICONS.saveExact, () => saving.step()));

const SPEEDS = [0.01, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10];

/** Pause, step, reset, record, snapshot. */
export class LiveDeck {
  private readonly pauseButton = button("pause", "Pause", "Pause or resume (space)", ICONS.pause, () => this.pause());
  private readonly stepButton = button("step", "Step", "One tick, while paused (.)", ICONS.step, () => this.step());
  private readonly recordButton = button("record", "Record", "Record, or stop recording (R)", ICONS.record, () => this.record(), true);
  private readonly why = el("span", { class: "why" });
  private readonly speed = el("select", { id: "speed", "aria-label": "Speed in lockstep", title: "Simulated to real time" }, ...SPEEDS.map((speed) => el("option", { value: String(speed), selected: speed === 1 }, `× ${speed}`)));
  private readonly acting: readonly HTMLButtonElement[];

  constructor(private readonly live: Live, private readonly world: World, private readonly notices: Notices, saving: Saving) {
    const resetButton = button("reset", "Reset", "Back to the start of the scene (backspace)", ICONS.reset, () => this.reset());
    const snapshotButton = button("snapshot", "Snapshot", "Write the last seconds to a recording (K)", ICONS.snapshot, () => this.snapshot());
    this.acting = [this.pauseButton, this.stepButton, resetButton, this.recordButton, snapshotButton];
    this.speed.addEventListener("change", () => live.speed(Number(this.speed.value)));
    byId("deck").replaceChildren(
      el("div", { class: "group" }, this.pauseButton, this.stepButton, resetButton),
      this.speed, el("div", { class: "group" }, this.recordButton, snapshotButton),
      this.why, savers(saving));
  }

  private async ask(method: string, args: Readonly<Record<string, unknown>>, done: (path: string) => string | null): Promise<void> {
    const answer = await this.live.call(method, args);
    const words = answer.ok ? done(String(answer.path ?? "")) : `Refused (${method.replace("_", " ")}): ${answer.error ?? "no reason given"}`;
    if (words !== null) this.notices.tell(words, !answer.ok);
  }

  private get paused(): boolean {
    return this.world.status?.state === "Paused";
  }

  pause = (): void => void this.ask(this.paused ? "resume" : "pause", {}, () => null);
  step = (): void => void this.ask("step", { ticks: 1 }, () => null);
  reset = (): void => void this.ask("reset", {}, () => null);
  snapshot = (): void => void this.ask("snapshot", { before: 10, after: 0 }, (path) => `The last 10 seconds are in ${path}`);
  record = (): void => {
    if (this.world.status?.recorder === "Recording") void this.ask("record_stop", {}, (path) => `Recorded ${path}`);
    else void this.ask("record_start", {}, (path) => `Recording to ${path}`);
  };

  update(): void {
    const may = this.live.mayWrite;
    for (const part of this.acting) part.disabled = !may;
    this.speed.hidden = !this.live.lockstep;
    this.speed.disabled = !may;
    this.stepButton.disabled = !may || !this.paused;
    const recording = this.world.status?.recorder === "Recording";
    this.relabel(this.pauseButton, this.paused ? "Resume" : "Pause", this.paused ? ICONS.play : ICONS.pause);
    this.relabel(this.recordButton, recording ? "Stop" : "Record", ICONS.record);
    this.recordButton.classList.toggle("recording", recording);
    this.recordButton.setAttribute("aria-pressed", String(recording));
    setText(this.why, this.live.viewOnly ? "This page is for looking only." : "");
  }

  private relabel(part: HTMLButtonElement, label: string, path: string): void {
    if (part.getAttribute("aria-label") === label) return;
    part.setAttribute("aria-label", label);
    const text = part.querySelector("span");
    if (text !== null) text.textContent = ` ${label}`;
    part.querySelector("path")?.setAttribute("d", path);
  }
}

/** Play, pause, speed, step, loop, and a timeline with contacts and events. */
export class PlaybackDeck {
  private readonly playButton = button("pause", "Play", "Play or pause (space)", ICONS.play, () => this.playback.toggle());
  private readonly loopButton = el("button", { id: "loop", type: "button", "aria-pressed": "false", title: "Play again at the end (L)", "aria-label": "Loop", onclick: () => this.toggleLoop() }, icon(ICONS.loop));
  private readonly speed = el("select", { id: "speed", "aria-label": "Speed" }, ...SPEEDS.map((speed) => el("option", { value: String(speed), selected: speed === 1 }, `× ${speed}`)));
  private readonly time = el("span", { class: "time" });
  private readonly slider: HTMLInputElement;
  private readonly canvas = el("canvas");
  private drawn = "";

  constructor(private readonly playback: Playback, private readonly second: () => Playback | null, private readonly world: World, saving: Saving) {
    this.slider = el("input", {
      id: "timeline", type: "range", min: String(playback.first), max: String(playback.last), step: "1", "aria-label": "Time",
      oninput: () => this.go(Number(this.slider.value)),
    });
    this.speed.addEventListener("change", () => (this.playback.speed = Number(this.speed.value)));
    byId("deck").replaceChildren(
      el("div", { class: "group" },
        button("back", "Back", "A tick back (,)", ICONS.back, () => this.stepBy(-1)), this.playButton,
        button("step", "Step", "A tick on (.)", ICONS.step, () => this.stepBy(1)), this.loopButton, this.speed),
      el("div", { id: "track" }, this.canvas, this.slider), this.time, savers(saving));
    // The label of `step` and `back` is in their titles: the timeline needs the room.
    for (const part of byId("deck").querySelectorAll("#back .long, #step .long, #pause .long")) part.remove();
  }

  stepBy(ticks: number): void {
    this.playback.playing = false;
    this.go(this.playback.tick + ticks);
  }

  go(tick: number): void {
    void this.playback.seek(tick);
    void this.second()?.seek(tick);
  }

  toggleLoop(): void {
    this.playback.loop = !this.playback.loop;
    this.loopButton.setAttribute("aria-pressed", String(this.playback.loop));
  }

  faster(by: number): void {
    const at = SPEEDS.indexOf(this.playback.speed) + by;
    const speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
    this.playback.speed = speed;
    this.speed.value = String(speed);
  }

  update(theme: Theme): void {
    const { playback } = this;
    const label = playback.playing ? "Pause" : "Play";
    if (this.playButton.getAttribute("aria-label") !== label) {
      this.playButton.setAttribute("aria-label", label);
      this.playButton.querySelector("path")?.setAttribute("d", playback.playing ? ICONS.pause : ICONS.play);
    }
    if (this.slider.value !== String(playback.tick)) this.slider.value = String(playback.tick);
    const seconds = (tick: number) => this.world.seconds(tick);
    this.slider.setAttribute("aria-valuetext", `${clock(seconds(playback.tick), 3)} s, tick ${playback.tick}`);
    setText(this.time, `${clock(seconds(playback.tick), 3)} / ${clock(seconds(playback.last), 1)} s · tick ${playback.tick}`);
    this.draw(theme);
  }

  private draw(theme: Theme): void {
    const { canvas, playback } = this;
    const { overview } = playback;
    const [width, height] = [canvas.clientWidth * devicePixelRatio, canvas.clientHeight * devicePixelRatio];
    const key = `${width} ${height} ${overview.version} ${playback.tick} ${theme.light}`;
    if (key === this.drawn || width === 0) return;
    this.drawn = key;
    canvas.width = width;
    canvas.height = height;
    const pen = canvas.getContext("2d");
    if (pen === null) return;
    const span = Math.max(1, playback.last - playback.first);
    const x = (tick: number) => ((tick - playback.first) / span) * (width - 2) + 1;
    const rows = Math.min(overview.tools.length, 6);
    const band = (height * 0.62) / Math.max(rows, 1);
    for (let t = 0; t < rows; t++) {
      pen.fillStyle = theme.colour("force");
      pen.globalAlpha = 0.75;
      for (const [from, to] of overview.contactIntervals(t)) pen.fillRect(x(from), 3 + t * band, Math.max(1.5, x(to + 1) - x(from)), Math.max(2, band - 3));
    }
    pen.globalAlpha = 1;
    // Force over the contacts, as a line: where it was strongest is seen at once.
    const strongest = overview.tools.reduce((most, { size }) => size.reduce((a, b) => Math.max(a, b), most), 0);
    if (strongest > 0) {
      pen.strokeStyle = theme.colour("text");
      pen.lineWidth = devicePixelRatio;
      pen.beginPath();
      for (let row = 0; row < overview.rows; row++) {
        if (overview.filled[row] === 0) continue;
        const size = overview.tools.reduce((most, tool) => Math.max(most, tool.size[row]), 0);
        pen.lineTo(x(overview.tickOf(row)), height * 0.7 - (height * 0.62 * size) / strongest);
      }
      pen.stroke();
    }
    for (const event of this.world.events) {
      pen.fillStyle = theme.colour(event.serious ? "bad" : "muted");
      pen.fillRect(x(event.tick) - devicePixelRatio / 2, height * 0.76, 2 * devicePixelRatio, height * 0.24);
    }
    pen.fillStyle = theme.colour("accent");
    const at = x(playback.tick);
    pen.fillRect(at - devicePixelRatio, 0, 2 * devicePixelRatio, height);
    pen.beginPath();
    pen.arc(at, 5 * devicePixelRatio, 5 * devicePixelRatio, 0, 7);
    pen.fill();
  }
}
