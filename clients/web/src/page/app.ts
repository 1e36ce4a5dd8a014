/**
 * The page: a source fills worlds, views draw them, panels tell of them.
 *
 * Everything is brought up to date in one place, `frame`, once a picture and only as far as something changed. A page in
 * the background gets no frames and costs nothing.
 */

import { add, Bounds, norm, scaled, type Vec3 } from "./geometry";
import { bindKeys } from "./keys";
import { BlobSource, httpSource, MemorySource, type ByteSource } from "./mcap/source";
import { Recording } from "./mcap/recording";
import { insidesOf, type Inside } from "./inside";
import { download, fileName, objOf } from "./save";
import { stepFault, stepOf } from "./step";
import { Stage } from "./scene/stage";
import { WorldView, type Look } from "./scene/view";
import { SettingsStore } from "./settings";
import { embedded, fetchSession, type RecordingLink, type Session } from "./session";
import { ForceSound } from "./sound";
import { Live } from "./sources/live";
import { Playback } from "./sources/playback";
import { Hand } from "./touch/hand";
import { PointerTouch } from "./touch/pointer";
import { Charts } from "./ui/charts";
import { LiveDeck, PlaybackDeck } from "./ui/deck";
import { byId, el } from "./ui/dom";
import { EventLog } from "./ui/events";
import { Help } from "./ui/help";
import { directionOf, LookPanel, type ViewName } from "./ui/look";
import { Notices } from "./ui/notices";
import { Gizmo, Labels, Legend } from "./ui/overlay";
import { StatusBar } from "./ui/status";
import { applyTheme, onSystemTheme, type Theme } from "./ui/theme";
import { Readout, ToolList } from "./ui/tools";
import { liveTracks, recordedTracks } from "./ui/tracks";
import { bytes } from "./units";
import { World, type Outline } from "./world";

/** Words and numbers change this often at most, ms. */
const WORDS_MS = 66;
/** Turned a little, rad, so that the first picture has depth. */
const FIRST_TURN = 0.2;

interface Opened {
  readonly recording: Recording;
  readonly outlines: readonly Outline[];
  readonly insides: readonly Inside[];
}

export class App {
  readonly settings = new SettingsStore();
  readonly notices = new Notices();
  readonly look: LookPanel;
  stage: Stage | null = null;
  live: Live | null = null;
  hand: Hand | null = null;
  playback: Playback | null = null;
  liveDeck: LiveDeck | null = null;
  playbackDeck: PlaybackDeck | null = null;

  private theme: Theme;
  private world = new World();
  private views: WorldView[] = [];
  private second: Playback | null = null;
  private pointer: PointerTouch | null = null;
  private readonly chosen = new Set<string>();
  private focus: string | null = null;
  private hovered: string | null = null;
  private touched = false;
  private version = "";
  private range: readonly [number, number] | null = null;

  private readonly status = new StatusBar();
  private readonly toolList: ToolList;
  private readonly readout: Readout;
  private readonly charts = new Charts();
  private events = new EventLog(null);
  private readonly gizmo = new Gizmo();
  private readonly labels = new Labels();
  private readonly legend = new Legend();
  private readonly help: Help;
  private readonly sound = new ForceSound();

  private drawnVersions = "";
  private sceneName = "";
  private instancesListed = "";
  private lastFrame = 0;
  private lastWords = 0;
  private frames = 0;
  private fps = 0;
  private fpsSince = 0;
  private drawnLast = false;
  /** When the first picture of a scene was drawn, and what bringing views up to date costs in the mean, ms. */
  private firstPicture = 0;
  private updating = 0;

  constructor() {
    this.theme = applyTheme(this.settings.value.theme);
    this.look = new LookPanel(this.settings, () => this.fit(), (name) => this.lookFrom(name));
    const actions = {
      choose: (tool: string, more: boolean) => this.choose(tool, more),
      take: (tool: string) => this.take(tool),
      letGo: () => this.hand?.letGo(),
    };
    this.toolList = new ToolList(actions);
    this.readout = new Readout(actions);
    this.help = new Help(() => this.playback !== null, () => this.version);
    this.startStage();
    this.bindPage();
    bindKeys(this);
    const span = el("select", { "aria-label": "Seconds shown" }, ...[5, 10, 30, 60].map((s) => el("option", { value: String(s), selected: s === this.settings.value.span }, `${s} s`)));
    span.addEventListener("change", () => this.settings.set((s) => (s.span = Number(span.value))));
    const label = el("label", { id: "span" }, "Last ", span);
    byId("actions").append(label);
    requestAnimationFrame((now) => this.frame(now));
  }

  /** Size of what is shown, m. */
  get size(): number {
    return this.views[0]?.size ?? 0.1;
  }

  private startStage(): void {
    const canvas = byId<HTMLCanvasElement>("view");
    try {
      this.stage = new Stage(canvas);
    } catch {
      this.say("No picture", "This browser has no WebGL, which the picture in three dimensions needs. Charts, values and controls work all the same.");
      canvas.hidden = true;
      byId("gizmo").toggleAttribute("hidden", true);
      this.look.toggle(false);
      return;
    }
    const { stage } = this;
    const fitSize = () => stage.resize(canvas.clientWidth, canvas.clientHeight, this.look.width);
    this.look.onToggle = fitSize;
    new ResizeObserver(fitSize).observe(canvas);
    fitSize();
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.notices.keep("webgl", "The graphics were lost; they come back by themselves.");
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.notices.keep("webgl", null);
      this.drawnVersions = "";
      stage.ask();
    });
  }

  private bindPage(): void {
    this.settings.onChange(() => this.applySettings());
    onSystemTheme(() => this.applySettings());
    byId("theme").addEventListener("click", () => this.settings.set((s) => (s.theme = this.theme.light ? "dark" : "light")));
    byId("sound").addEventListener("click", () => this.settings.set((s) => (s.sound = !s.sound)));
    this.applySettings();
    // A page in the background is given no time to send poses: better to give the tool back than to hold it stale.
    document.addEventListener("visibilitychange", () => {
      if (!document.hidden) return;
      this.hand?.end(null);
      this.sound.update(0);
    });
    const area = byId("drop");
    const holdsFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
    addEventListener("dragover", (event) => {
      if (!holdsFiles(event)) return;
      event.preventDefault();
      area.hidden = false;
    });
    addEventListener("dragleave", (event) => {
      if (event.relatedTarget === null) area.hidden = true;
    });
    addEventListener("drop", (event) => {
      event.preventDefault();
      area.hidden = true;
      void this.openFiles([...(event.dataTransfer?.files ?? [])]);
    });
  }

  private applySettings(): void {
    const { value } = this.settings;
    this.theme = applyTheme(value.theme);
    this.sound.set(value.sound);
    byId("sound").setAttribute("aria-pressed", String(value.sound));
    this.stage?.setPalette({ grid: this.theme.colour("grid"), light: this.theme.light });
    this.stage?.setGrid(value.layers.grid);
    this.stage?.setShadows(value.layers.shadows && value.layers.grid);
    this.setClip();
    this.drawnVersions = "";
  }

  private setClip(): void {
    const { clip, clipAt, clipFlip } = this.settings.value;
    const bounds = this.world.bounds();
    if (this.stage === null || clip === "off" || bounds.empty) return;
    const axis = { x: 0, y: 1, z: 2 }[clip];
    const sign = clipFlip ? 1 : -1;
    const place = bounds.low[axis] + clipAt * (bounds.high[axis] - bounds.low[axis]);
    this.stage.clip.normal.set(axis === 0 ? sign : 0, axis === 1 ? sign : 0, axis === 2 ? sign : 0);
    this.stage.clip.constant = -sign * place;
    this.stage.ask();
  }

  // Sources.

  /** Opens what the page was made for: a recording inside it, one of the server's, or its loop. */
  async start(): Promise<void> {
    const inside = embedded();
    if (inside !== null) {
      const outlines = inside.tools === null ? null : inside.tools;
      const source = new MemorySource(inside.bytes);
      return this.show([await this.opened(inside.name, source, async () => inside.scene, async () => outlines)]);
    }
    const session = await fetchSession();
    if (session === null) {
      if (!location.protocol.startsWith("http")) return this.say("No recording", "Drop a recording (.mcap) on this page to see it.");
      this.world.link = "lost";
      this.notices.keep("link", "The daemon does not answer; trying again …");
      setTimeout(() => void this.start(), 1000);
      return;
    }
    this.notices.keep("link", null);
    this.version = session.version ?? "";
    this.warnOfOpen(session.open ?? []);
    if (session.mode === "view") return this.openSession(session);
    this.goLive(session);
  }

  /** A loop that strangers may move is marked as such for as long as it is shown. */
  private warnOfOpen(addresses: readonly string[]): void {
    const mark = byId<HTMLButtonElement>("open-network");
    const words = `Everybody who reaches ${addresses.join(", ")} can move tools and give commands.`;
    mark.hidden = addresses.length === 0;
    mark.title = words;
    mark.onclick = () => this.notices.tell(words, true);
  }

  private goLive(session: Session): void {
    this.leave();
    document.body.dataset["mode"] = "live";
    const live = new Live(this.world, session);
    this.live = live;
    const hand = new Hand(this.world, live, () => this.size);
    this.hand = hand;
    hand.onEnd = (tool, why) => {
      this.pointer?.drop();
      if (why !== null) this.notices.tell(`${tool}: ${why}`, true);
    };
    live.onOpen = () => hand.end("the connection was lost");
    live.onRefused = (key, error) => {
      const tool = /^tool\/([^/]+)\//.exec(key)?.[1];
      if (tool !== undefined && hand.tool?.id === tool) hand.end(error);
      else this.notices.tell(error, true);
    };
    this.addView(this.world);
    this.liveDeck = new LiveDeck(live, this.world, this.notices, { picture: () => this.savePicture(), nets: () => this.saveNets(), step: () => this.saveStep() });
    if (this.stage !== null && this.pointer === null) {
      this.pointer = new PointerTouch(this.stage, hand, () => this.views[0]?.tools ?? []);
      this.pointer.enabled = () => this.live?.mayHold ?? false;
      this.pointer.onHover = (tool) => (this.hovered = tool);
      this.pointer.onTake = (tool) => this.take(tool);
    }
    live.start();
  }

  private async openSession(session: Session): Promise<void> {
    const links = session.recordings ?? [];
    if (links.length === 0) return this.say("No recordings", "There is none to show here. Drop one (.mcap) on this page.");
    const against = links.filter((link) => link.against === true);
    if (against.length > 0) return this.openLinks([links.find((link) => link.against !== true) ?? links[0], against[0]]);
    if (links.length === 1) return this.openLinks(links);
    this.offer(links);
    await this.openLinks([links[0]]);
  }

  /** A list of recordings, in the bar. */
  private offer(links: readonly RecordingLink[]): void {
    const label = byId("instances");
    const select = label.querySelector("select");
    if (select === null) return;
    label.firstChild?.replaceWith("Recording ");
    select.replaceChildren(...links.map(({ name, bytes: size }, k) => el("option", { value: String(k) }, size === undefined ? name : `${name} (${bytes(size)})`)));
    select.addEventListener("change", () => void this.openLinks([links[Number(select.value)]]));
    label.hidden = false;
  }

  private async openLinks(links: readonly RecordingLink[]): Promise<void> {
    const get = async (url: string | null | undefined) => {
      if (url === null || url === undefined) return null;
      const answer = await fetch(url);
      return answer.ok ? answer : null;
    };
    const scene = async (link: RecordingLink) => {
      const answer = await get(link.scene_url);
      return answer === null ? null : new Uint8Array(await answer.arrayBuffer());
    };
    await this.tryShow(() => Promise.all(links.map(async (link) =>
      this.opened(link.name, await httpSource(link.url), () => scene(link), async () => (await get(link.tools_url))?.text() ?? null,
        async () => (await get(link.inside_url))?.json() ?? null))));
  }

  private async openFiles(files: readonly File[]): Promise<void> {
    const recordings = files.filter(({ name }) => /\.mcap(\.part)?$/.test(name)).slice(0, 2);
    if (recordings.length === 0) {
      if (files.length > 0) this.notices.tell(`${files[0].name} is not a recording (.mcap)`, true);
      return;
    }
    await this.tryShow(() => Promise.all(recordings.map((file) =>
      this.opened(file.name, new BlobSource(file), async () => null, async () => null))));
  }

  private async opened(name: string, source: ByteSource, scene: () => Promise<Uint8Array | null>, tools: () => Promise<string | null>,
    inside: () => Promise<unknown> = async () => null): Promise<Opened> {
    const recording = await Recording.open(name, source, scene);
    let outlines: Outline[] = [];
    try {
      outlines = JSON.parse((await recording.attachmentText("tools.json")) ?? (await tools()) ?? "[]") as Outline[];
    } catch {
      recording.warnings.push("the shapes of its tools cannot be read");
    }
    let insides: Inside[] = [];
    try {
      insides = insidesOf(await inside());
    } catch {
      // Materials are then not offered.
    }
    return { recording, outlines, insides };
  }

  private async tryShow(open: () => Promise<readonly Opened[]>): Promise<void> {
    try {
      this.show(await open());
    } catch (error) {
      const why = error instanceof Error ? error.message : String(error);
      if (this.playback === null && this.live === null) this.say("This recording cannot be shown", why);
      else this.notices.tell(why, true);
    }
  }

  /** Plays one recording, or two side by side. */
  private show(opened: readonly Opened[]): void {
    this.leave();
    document.body.dataset["mode"] = "recording";
    byId("empty").hidden = true;
    byId("span").hidden = true;
    const [first, other] = opened;
    this.playback = new Playback(first.recording, this.world, first.outlines);
    this.world.setInsides(first.insides);
    this.addView(this.world);
    if (other !== undefined) {
      const world = new World();
      this.second = new Playback(other.recording, world, other.outlines);
      world.setInsides(other.insides);
      this.addView(world);
    }
    for (const { recording } of opened) for (const warning of recording.warnings) this.notices.tell(`${recording.name}: ${warning}`, true);
    const builds = new Set(opened.map(({ recording }) => recording.build));
    if (builds.size > 1) this.notices.tell(`The two are of different builds: ${[...builds].join("; ")}`);
    this.look.offerDifference(other !== undefined);
    if (other !== undefined) this.settings.set((s) => (s.colourBy = "difference"));
    const { playback } = this;
    this.playbackDeck = new PlaybackDeck(playback, () => this.second, this.world, { picture: () => this.savePicture(), nets: () => this.saveNets(), step: () => this.saveStep() });
    const go = (tick: number) => this.playbackDeck?.go(tick);
    this.events = new EventLog(go);
    this.charts.onPick = (seconds) => go(Math.round(seconds / playback.recording.dt));
    this.charts.onZoom = (from, to) => (this.range = to > from ? [from, to] : null);
    void playback.seek(playback.first);
  }

  /** Ends what was shown before. */
  private leave(): void {
    this.hand?.end(null);
    this.live?.stop();
    this.playback?.stop();
    this.second?.stop();
    for (const view of this.views) view.dispose();
    this.views = [];
    this.live = this.hand = this.playback = this.second = this.liveDeck = this.playbackDeck = null;
    this.world = new World();
    this.chosen.clear();
    this.focus = this.range = null;
    this.sceneName = "";
    this.drawnVersions = "";
    this.look.offerDifference(false);
    if (this.settings.value.colourBy === "difference") this.settings.set((s) => (s.colourBy = "displacement"));
  }

  private addView(world: World): void {
    if (this.stage !== null) this.views.push(new WorldView(world, this.stage));
  }

  private say(title: string, text: string): void {
    const empty = byId("empty");
    empty.replaceChildren(el("h2", {}, title), el("p", {}, text));
    empty.hidden = false;
  }

  // What panels and keys do.

  choose(tool: string, more: boolean): void {
    if (!more) this.chosen.clear();
    if (more && this.chosen.has(tool) && this.chosen.size > 1) this.chosen.delete(tool);
    else this.chosen.add(tool);
    this.focus = this.chosen.has(tool) ? tool : ([...this.chosen][0] ?? null);
    this.settings.version += 1;
    this.drawnVersions = "";
  }

  chooseNext(by: number): void {
    const { tools } = this.world;
    if (tools.length === 0) return;
    const at = tools.findIndex(({ id }) => id === this.focus);
    this.choose(tools[(at + by + tools.length) % tools.length].id, false);
  }

  take(id: string): void {
    const tool = this.world.tool(id);
    if (tool === undefined || this.hand === null) return;
    this.choose(id, false);
    if (this.live?.mayHold !== true) {
      const why = this.live?.viewOnly === true ? "This page is for looking only."
        : this.live?.mayWrite === true ? "The tools of a recording move by themselves." : "There is no connection to the daemon.";
      this.notices.tell(why, true);
      return;
    }
    this.touched = true;
    this.hand.take(tool);
  }

  takeOrLetGo(): void {
    if (this.hand?.state === "holding") this.hand.letGo();
    else {
      // Between a change of scene and its picture the tool in focus may be one that is gone.
      const tool = this.world.tool(this.focus ?? "") ?? this.world.tools[0];
      if (tool !== undefined) this.take(tool.id);
    }
  }

  private frameOf(): { middle: Vec3; size: number } {
    const [first, other] = this.views;
    if (first === undefined) return { middle: [0, 0, 0], size: 0.1 };
    if (other === undefined) return { middle: first.middle, size: first.size };
    const beside = other.group.position;
    return { middle: add(first.middle, scaled([beside.x, beside.y, beside.z], 0.5)), size: 1.55 * first.size };
  }

  fit(): void {
    const { middle, size } = this.frameOf();
    this.stage?.fit(middle, size, null);
  }

  lookFrom(name: ViewName): void {
    const { middle, size } = this.frameOf();
    this.stage?.fit(middle, size, directionOf(name));
  }

  savePicture(): void {
    void this.stage?.png(this.theme.colour("ground")).then((blob) => {
      if (blob !== null) download(fileName(this.world, "png"), blob);
    });
  }

  saveNets(): void {
    download(fileName(this.world, "obj"), new Blob([objOf(this.world)], { type: "model/obj" }));
  }

  saveStep(): void {
    const left = this.world.bodies.flatMap((body) => stepFault(body) ?? []);
    const text = stepOf(this.world);
    if (text !== null) download(fileName(this.world, "step"), new Blob([text], { type: "model/step" }));
    if (left.length > 0 || text === null) this.notices.tell(`Not in the file: ${left.join("; ") || "there is no body"}`, true);
  }

  showHelp(): void {
    this.help.open(this.playback !== null, this.version);
  }

  // Drawing.

  private lookOf(): Look {
    const colour = (name: string) => this.theme.colour(name);
    return {
      tool: this.theme.light ? "#4b87b8" : "#5f9bcd", focus: this.theme.light ? "#1f78c8" : "#49a7f5",
      hand: colour("text"), force: colour("force"), torque: colour("second"), contact: this.theme.light ? "#0b1b2b" : "#fff6c9",
    };
  }

  private frame(now: number): void {
    requestAnimationFrame((next) => this.frame(next));
    const ms = now - this.lastFrame;
    this.lastFrame = now;
    if (this.playback !== null) {
      this.playback.advance(ms);
      const { second, playback } = this;
      if (second !== null) {
        second.advance(0);
        if (second.tick !== playback.tick && playback.playing) void second.seek(playback.tick);
      }
    }
    if (this.focus === null || this.world.tool(this.focus) === undefined) {
      const first = this.world.tools[0]?.id;
      if (first !== undefined) this.choose(first, false);
    }
    this.lookInside();
    const versions = `${this.world.version} ${this.second?.world.version ?? 0} ${this.settings.version} ${this.theme.light}`;
    const changed = versions !== this.drawnVersions;
    this.drawnVersions = versions;
    if (changed) {
      const start = performance.now();
      this.updateViews();
      this.updating += 0.1 * (performance.now() - start - this.updating);
    }
    const drawn = this.stage?.draw() ?? false;
    if (drawn && this.drawnLast) this.stage?.pace(ms);
    this.drawnLast = drawn;
    if (drawn) this.frames += 1;
    if (drawn && this.firstPicture === 0 && (this.views[0]?.bodies.length ?? 0) > 0) this.firstPicture = performance.now();
    if (now - this.fpsSince > 1000) [this.fps, this.frames, this.fpsSince] = [(1e3 * this.frames) / (now - this.fpsSince), 0, now];
    if (changed || drawn) this.updateOverlay();
    if (now - this.lastWords > WORDS_MS) {
      this.lastWords = now;
      this.updateWords();
    }
    if (this.charts.due(now)) this.updateCharts();
  }

  /** Asks for what is inside bodies when it is to be shown. */
  private lookInside(): void {
    const { layers, colourBy } = this.settings.value;
    this.live?.lookInside(layers.lattice && this.stage !== null, colourBy === "stiffness");
  }

  private updateViews(): void {
    const { stage, views } = this;
    const strongest = Math.max(0, ...this.world.tools.map((tool) => norm(tool.force) / (Number.isFinite(tool.forceMax) && tool.forceMax > 0 ? tool.forceMax : 10)));
    // What is not felt now is not heard: a lost connection or a recording that stands still is silent.
    const felt = this.playback === null ? this.world.link === "live" : this.playback.playing;
    this.sound.update(felt ? strongest : 0);
    if (stage === null) return;
    const look = this.lookOf();
    const fresh = views.map((view) => view.rebuild(look))[0] ?? false;
    const changed = views.map((view, k) => view.update(this.settings.value, this.settings.version, look, this.focus, views.length === 2 ? views[1 - k] : null));
    const [first, second] = views;
    if (first !== undefined && second !== undefined) {
      // The second stands beside the first, as seen from where one looks at first.
      const [x, y] = this.firstDirection(first);
      second.group.position.set(...scaled([-y, x, 0], (0.9 * first.size) / Math.hypot(x, y)));
    }
    if (fresh && first !== undefined && first.bodies.length + first.tools.length > 0) this.setScene(first, stage);
    // Sixty messages a second come of a scene at rest as well, which needs no new picture.
    if (changed.includes(true)) stage.ask();
  }

  private setScene(view: WorldView, stage: Stage): void {
    const { middle, size } = this.frameOf();
    stage.setScene(middle, size, view.groundZ);
    this.setClip();
    // The same scene after a reconnect keeps the place from which it was looked at.
    if (this.sceneName === this.world.name || view.bodies.length === 0) return;
    stage.fit(middle, size, this.firstDirection(view), this.sceneName !== "");
    this.sceneName = this.world.name;
  }

  /** From where a tool that is dragged towards the body meets it: across the line between them, a little from above. */
  private firstDirection(view: WorldView): Vec3 {
    const [tool] = this.world.tools;
    const [body] = this.world.bodies;
    const iso = directionOf("iso");
    if (tool === undefined || body === undefined || this.world.tools.length > 4) return iso;
    const middle = new Bounds().take(body.rest).middle;
    const [x, y] = [tool.proxy[0] - middle[0], tool.proxy[1] - middle[1]];
    const across = Math.hypot(x, y);
    if (!(across > 0.15 * view.size)) return iso;
    const angle = Math.atan2(-x, y) + FIRST_TURN;
    return [Math.cos(angle), Math.sin(angle), 0.36];
  }

  private updateOverlay(): void {
    const { stage } = this;
    const [first] = this.views;
    if (stage === null || first === undefined) return;
    this.gizmo.update(stage);
    this.labels.update(stage, this.views, this.titles(), this.settings.value);
    this.legend.update(first, stage, this.settings.value);
    stage.canvas.toggleAttribute("data-held", this.hand?.state === "holding");
    stage.canvas.toggleAttribute("data-over", this.hovered !== null);
  }

  private titles(): { text: string; kind: string; place: Vec3 }[] {
    if (this.second !== null && this.playback !== null) {
      return this.views.map((view, k) => {
        const { x, y, z } = view.group.position;
        const names = [this.playback, this.second].map((playback) => playback?.recording.name ?? "");
        const name = names[0] === names[1] ? `${names[k]} (${k + 1})` : names[k];
        return { text: name, kind: "title", place: [view.middle[0] + x, view.middle[1] + y, view.groundZ + z] };
      });
    }
    const tool = this.hovered === null || this.hand?.state === "holding" ? undefined : this.world.tool(this.hovered);
    return tool === undefined ? [] : [{ text: tool.holder === null ? tool.id : `${tool.id}, held by ${tool.holder}`, kind: "title", place: tool.proxy }];
  }

  private updateWords(): void {
    const { world, live } = this;
    this.status.update(world, this.playback);
    this.toolList.update(world, this.chosen);
    const held = this.hand?.state !== undefined && this.hand.state !== "free" && this.hand.tool?.id === this.focus;
    this.readout.update(this.focus === null ? undefined : world.tool(this.focus), world.link === "live", live?.mayHold ?? false, held);
    this.events.update(world);
    this.liveDeck?.update();
    this.playbackDeck?.update(this.theme);
    if (live !== null) {
      this.notices.keep("link", world.link === "lost" ? world.trouble : null);
      this.showInstances(world.instances, live.instance);
    } else if (world.trouble !== "") this.notices.keep("trouble", world.trouble);
    const faults = world.bodies.flatMap(({ fault }) => (fault === null ? [] : [fault]));
    this.notices.keep("nets", faults.length === 0 ? null : `Not drawn: ${faults.slice(0, 3).join("; ")}${faults.length > 3 ? ` and ${faults.length - 3} more` : ""}`);
    this.look.offerInside(live !== null, live !== null || world.insides.length > 0);
    this.updateHint();
  }

  private showInstances(instances: readonly string[], own: string): void {
    const label = byId("instances");
    label.hidden = instances.length < 2;
    const select = label.querySelector("select");
    // Each daemon has a page of its own; one without a page is named all the same.
    const { pages } = this.live ?? { pages: {} as Readonly<Record<string, string>> };
    const listed = instances.map((name) => `${name} ${pages[name] ?? ""}`).join();
    if (select === null || this.instancesListed === listed) return;
    this.instancesListed = listed;
    select.replaceChildren(...instances.map((name) => el("option", { value: name, selected: name === own, disabled: name !== own && pages[name] === undefined }, name)));
    select.onchange = () => {
      const page = this.live?.pages[select.value];
      // An address that is not a page's must not become a script.
      if (page !== undefined && /^https?:/.test(page)) location.href = page;
    };
  }

  private updateHint(): void {
    const hint = byId("hint");
    const tool = this.focus === null ? undefined : this.world.tool(this.focus);
    const may = this.live?.mayHold === true && this.stage !== null && tool !== undefined;
    let words = "";
    if (may && this.hand?.state === "holding") words = matchMedia("(pointer: coarse)").matches ? "Second finger up or down: push along the view" : "Wheel: push along the view · Shift: grip";
    else if (may && !this.touched) words = `Drag the ${tool.id.replace(/[_-]/g, " ")} to press`;
    else if (this.live?.mayWrite === true && this.world.status?.state === "Paused") words = "Paused: space runs on";
    hint.hidden = words === "";
    if (hint.textContent !== words) hint.textContent = words;
  }

  private updateCharts(): void {
    const { playback, world } = this;
    if (playback !== null) {
      const all: readonly [number, number] = [world.seconds(playback.first), world.seconds(playback.last)];
      this.charts.mark = world.seconds(playback.tick);
      this.charts.set(recordedTracks(playback.overview, this.chosen), this.range ?? all, this.theme);
    } else if (this.live !== null) {
      const { span } = this.settings.value;
      const now = world.seconds();
      this.charts.set(liveTracks(world, this.chosen, span), [Math.max(0, now - span), Math.max(now, span)], this.theme);
    }
  }

  /** What is drawn, as plain values: for tests. */
  report(): Record<string, unknown> {
    const { world, stage } = this;
    const plain = (tool: World["tools"][number]) => ({
      id: tool.id, force: [...tool.force], depth: tool.depth, proxy: [...tool.proxy], holder: tool.holder, hand: tool.hand?.position ?? null,
      poseAgeMs: tool.poseAgeMs, rows: tool.history.ticks.length,
      screen: stage?.project(tool.proxy) ?? null,
    });
    return {
      link: world.link, tick: world.tick, scene: world.name, malformed: this.live?.malformed ?? 0,
      firstPictureMs: this.firstPicture, updateMs: this.updating, fps: this.fps, costMs: stage?.cost ?? null, thrifty: stage?.thrifty ?? false, coarse: stage?.coarse ?? false,
      bodies: world.bodies.map((body) => ({
        id: body.id, nodes: body.nodes === null ? 0 : body.nodes.length / 3, points: body.points.length / 3, netTick: body.netTick, fault: body.fault, assumed: body.assumed,
      })),
      extents: this.views.map((view) => view.bodies.map(({ extent }) => extent)),
      tools: world.tools.map(plain),
      contacts: world.contacts.length, events: world.events.length,
      hand: this.hand?.state ?? null,
      playback: this.playback === null ? null : {
        tick: this.playback.tick, first: this.playback.first, last: this.playback.last, playing: this.playback.playing,
        seekMs: this.playback.seekMs, overview: this.playback.overview.done, warnings: this.playback.recording.warnings,
        second: this.second?.tick ?? null,
      },
    };
  }

  /** A body's nodes and net as they are drawn, x y z, for tests. */
  inside(body: string): { nodes: number[]; points: number[] } {
    const known = this.world.body(body);
    return { nodes: [...(known?.nodes ?? [])], points: [...(known?.points ?? [])] };
  }

  /** A body's net as it is drawn, x y z, for tests. */
  net(body: string): number[] {
    return [...(this.world.body(body)?.points ?? [])];
  }
}
