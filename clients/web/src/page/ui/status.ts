/** The bar: what runs, how fast, and whether all is well. */

import type { LoopStatus } from "../../index";
import type { Playback } from "../sources/playback";
import { bytes, clock, digits, withUnit } from "../units";
import { QUALITY, RECORDER } from "../words";
import type { World } from "../world";
import { byId, el, setText } from "./dom";

interface Item {
  readonly name: string;
  readonly label: string;
  readonly minor?: boolean;
}

const ITEMS: readonly Item[] = [
  { name: "time", label: "time" },
  { name: "rate", label: "rate" },
  { name: "late", label: "late" },
  { name: "forces", label: "forces lost" },
  { name: "tick", label: "p99", minor: true },
  { name: "quality", label: "quality", minor: true },
  { name: "recorder", label: "", minor: true },
];

/** A daemon says how it is ten times a second: one that is silent for so long may stand still, whatever the socket says. */
const SILENCE_MS = 2000;

/** Thousands are enough of a large count. */
const few = (count: number): string => (count < 1e4 ? count.toLocaleString("en") : `${Math.round(count / 1e3)}k`);

export class StatusBar {
  private readonly values = new Map<string, { item: HTMLElement; value: HTMLElement }>();
  private readonly link = byId("link");
  private readonly scene = byId("scene-name");
  private before = { tick: 0, at: 0, hz: 0 };

  constructor() {
    const area = byId("status");
    for (const { name, label, minor } of ITEMS) {
      const value = el("b");
      const item = el("span", { "data-item": name, ...(minor === true ? { class: "minor" } : {}) }, value, ` ${label}`);
      this.values.set(name, { item, value });
      area.append(item);
    }
  }

  update(world: World, playback: Playback | null): void {
    setText(this.scene, world.name);
    const silent = playback === null && world.link === "live" && world.status !== null && performance.now() - world.heard > SILENCE_MS;
    this.link.dataset["state"] = silent ? "lost" : world.link === "live" && world.status?.state === "Paused" ? "paused" : world.link;
    setText(this.link, silent ? "No answer" : this.linkWords(world, playback));
    this.put("time", `${clock(world.seconds())} s`);
    if (playback !== null) {
      this.put("rate", `× ${digits(playback.speed, 2)}`, "speed");
      this.put("late", `${(playback.last - playback.first + 1).toLocaleString("en")}`, "ticks");
      this.put("tick", playback.recording.build.split(" source")[0], "");
      this.put("quality", "", "");
      this.put("recorder", "", "");
      this.put("forces", "");
      return;
    }
    const { status } = world;
    if (status === null) return;
    this.put("rate", `${status.rate_hz.toFixed(0)} Hz`, this.slower(world, status.rate_hz));
    const waited = withUnit(Number(status.wait.p50_ns) * 1e-9, "s");
    this.explain("rate", status.followed_tool === "" ? "Ticks on a fixed grid of time" : `Ticks follow the poses of ${status.followed_tool}, which wait ${waited}`);
    const [late, skipped] = [Number(status.late_ticks), Number(status.skipped_ticks)];
    this.put("late", few(late), skipped > 0 ? `late, ${few(skipped)} skipped` : "late", skipped > 0 ? "warn" : "");
    this.forces(status);
    this.put("tick", withUnit(Number(status.step.p99_ns) * 1e-9, "s"));
    this.explain("tick", "Tick time: 99 of 100 ticks take less");
    const level = status.quality_level;
    this.put("quality", level === 0 ? "full" : `−${level}`, "quality", level > 0 ? "warn" : "");
    this.explain("quality", level === 0 ? "Full quality" : `Quality level ${level}: ${QUALITY[level] ?? ""}`);
    this.explain("late", `${late} ticks began late, ${skipped} were skipped`);
    const failed = status.recorder === "Failed" || status.recorder_drops > 0n;
    const written = status.recorder === "Recording" ? ` ${bytes(Number(status.recorder_bytes))}` : "";
    const lost = status.recorder_drops > 0n ? `, ${status.recorder_drops} records lost` : "";
    this.put("recorder", status.recorder === "Off" && !failed ? "" : `${RECORDER[status.recorder]}${written}${lost}`, "", failed ? "bad" : "");
  }

  /** Forces that did not reach their devices in time, where there were any. */
  private forces(status: LoopStatus): void {
    const missed = status.tools.filter((tool) => tool.forces_overtaken + tool.forces_lost > 0n);
    const count = missed.reduce((sum, tool) => sum + Number(tool.forces_overtaken + tool.forces_lost), 0);
    this.put("forces", count === 0 ? "" : few(count), "forces lost", "warn");
    const words = ({ tool, forces_sent, forces_overtaken, forces_lost }: LoopStatus["tools"][number]) =>
      `${tool}: ${forces_overtaken} were not sent, a newer one was there; ${forces_lost} of ${forces_sent} sent were lost on the way`;
    this.explain("forces", missed.map(words).join("\n"));
  }

  /** Where simulated time is behind real time, that is said next to the rate. */
  private slower(world: World, nominal: number): string {
    const now = performance.now();
    const seconds = (now - this.before.at) * 1e-3;
    if (seconds >= 1) this.before = { tick: world.tick, at: now, hz: (world.tick - this.before.tick) / seconds };
    const { hz } = this.before;
    if (world.status?.state !== "Running" || world.lockstep || !(hz > 0) || hz > 0.93 * nominal) return world.lockstep ? "lockstep" : "";
    return `now ${hz.toFixed(0)}`;
  }

  private linkWords(world: World, playback: Playback | null): string {
    if (playback !== null) return playback.playing ? "Playing" : "Recording";
    switch (world.link) {
      case "connecting": return "Connecting …";
      case "lost": return "No connection";
      case "failed": return "Failed";
      default: return world.status?.state === "Paused" ? "Paused" : world.status?.state === "Stopping" ? "Stopping" : "Live";
    }
  }

  private explain(name: string, text: string): void {
    const item = this.values.get(name)?.item;
    if (item !== undefined && item.title !== text) item.title = text;
  }

  private put(name: string, value: string, label?: string, kind = ""): void {
    const parts = this.values.get(name);
    if (parts === undefined) return;
    setText(parts.value, value);
    if (label !== undefined) {
      const text = parts.item.lastChild;
      if (text !== null && text !== parts.value && text.textContent !== ` ${label}`) text.textContent = ` ${label}`;
    }
    parts.item.classList.toggle("warn", kind === "warn");
    parts.item.classList.toggle("bad", kind === "bad");
    parts.item.hidden = value === "";
  }
}
