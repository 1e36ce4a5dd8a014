/**
 * A running daemon: its socket, read into a world, and what the page may say to it.
 *
 * The daemon keeps only the newest of each message, and so does the world: a page that was stopped for an hour catches
 * up with one frame of each. A lost socket is opened again, at first at once and then every two seconds.
 */

import {
  ContactSet, ControlNet, DecodeError, DeviceInfo, LoopStatus, SceneSnapshot, SimEvent, ToolContact, ToolForce, ToolForceV2, ToolPose,
  decode, encode,
} from "../../index";
import { fetchSession, type Session } from "../session";
import { happening } from "../words";
import type { Outline, World } from "../world";
import { insidesOf } from "../inside";
import { Fading, LOOK_MS } from "./fading";
import { callOf, frame, ofCall, ofText, openFrame, textOf } from "./frames";

/** An answer of the loop to a request. */
export interface Answer {
  readonly ok: boolean;
  readonly error?: string;
  readonly path?: string;
  readonly [field: string]: unknown;
}

const CALL_TIMEOUT_MS = 30_000;
/** Other scenes come and go on the bus: the list is asked for so often while the page is looked at. */
const NEIGHBOURS_MS = 8_000;

export class Live {
  /** Told when the daemon refuses a tool or another write, in its words. */
  onRefused: (key: string, error: string) => void = () => {};
  /** Told when the socket opens: what was held before is not any more. */
  onOpen: () => void = () => {};

  private socket: WebSocket | null = null;
  private calls = new Map<number, (answer: Answer) => void>();
  private nextCall = 1;
  private attempts = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private neighbours: ReturnType<typeof setInterval> | undefined;
  private readonly fading = new Fading();
  private fader: ReturnType<typeof setInterval> | undefined;
  private closed = false;
  /** Nodes are wanted; cells have been asked for. */
  private looking = false;
  private insideAsked = false;
  /** Frames whose bytes were not what they should be. */
  malformed = 0;

  constructor(
    readonly world: World,
    private session: Session,
  ) {}

  get mayWrite(): boolean {
    return this.session.token !== null && this.world.link === "live";
  }

  get viewOnly(): boolean {
    return this.session.token === null;
  }

  /** Tools can be taken: not those of a recording that is played. */
  get mayHold(): boolean {
    return this.mayWrite && this.session.played !== true;
  }

  get lockstep(): boolean {
    return this.session.lockstep === true || this.world.lockstep;
  }

  get pages(): Readonly<Record<string, string>> {
    return this.session.pages ?? {};
  }

  get instance(): string {
    return this.session.instance ?? "default";
  }

  /** Asks who else is on the bus. */
  private async lookAround(): Promise<void> {
    if (document.hidden || this.world.link !== "live") return;
    const session = await fetchSession();
    if (session === null || this.closed) return;
    const { instances = [], pages = {} } = session;
    this.session = { ...this.session, instances, pages };
    this.world.instances = instances;
  }

  start(): void {
    clearInterval(this.neighbours);
    this.neighbours = setInterval(() => void this.lookAround(), NEIGHBOURS_MS);
    clearInterval(this.fader);
    this.fader = setInterval(() => this.fade(), LOOK_MS);
    this.world.instances = this.session.instances ?? [];
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/live`);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.attempts = 0;
      if (this.session.token !== null) socket.send(frame("token", ofText(this.session.token)));
      this.world.link = "live";
      this.world.trouble = "";
      this.world.touch();
      void this.fetchOutlines();
      this.onOpen();
      this.insideAsked = false;
      if (this.looking) this.send("inside", Uint8Array.of(1));
    };
    socket.onmessage = (event) => {
      if (event.data instanceof ArrayBuffer) this.take(new Uint8Array(event.data));
    };
    socket.onclose = () => this.lose();
  }

  stop(): void {
    this.closed = true;
    clearInterval(this.neighbours);
    clearInterval(this.fader);
    clearTimeout(this.timer);
    this.socket?.close();
  }

  private lose(): void {
    if (this.closed) return;
    this.world.link = "lost";
    this.world.trouble = "The daemon does not answer; trying again …";
    for (const tool of this.world.tools) tool.holder = null;
    this.fading.drop(this.world);
    this.world.touch();
    for (const answer of this.calls.values()) answer({ ok: false, error: "the connection was lost" });
    this.calls.clear();
    this.attempts += 1;
    this.timer = setTimeout(() => void this.again(), Math.min(250 * this.attempts, 2000));
  }

  /** A daemon that was started anew has another token. */
  private async again(): Promise<void> {
    const session = await fetchSession();
    if (this.closed) return;
    if (session === null) return this.lose();
    this.session = session;
    this.start();
  }

  private async fetchOutlines(): Promise<void> {
    try {
      const answer = await fetch("tools.json", { cache: "no-store" });
      this.world.outlines = (await answer.json()) as Outline[];
      this.world.outlineVersion += 1;
      this.world.touch();
    } catch {
      // Tools are then drawn as what their size says.
    }
  }

  /** Takes a frame; one that cannot be read is counted and left out. */
  take(bytes: Uint8Array): void {
    this.world.heard = performance.now();
    try {
      const { key, payload } = openFrame(bytes);
      this.route(key, payload);
    } catch (error) {
      if (!(error instanceof DecodeError || error instanceof SyntaxError)) throw error;
      // An event of a kind that a newer daemon knows is no fault.
      if (!(error instanceof DecodeError && error.fault === "unknown-case")) this.malformed += 1;
    }
  }

  private route(key: string, payload: Uint8Array): void {
    const [kind, id, part] = key.split("/");
    const { world } = this;
    switch (part === undefined ? kind : `${kind}/${part}`) {
      case "scene": {
        world.load(decode(SceneSnapshot, payload));
        if (world.insides.length === 0) this.insideAsked = false;
        void this.fetchOutlines();
        return;
      }
      case "body/net": {
        const net = decode(ControlNet, payload);
        world.body(net.body)?.takeNet(net.points, net.count_u, net.count_v, Number(net.tick));
        break;
      }
      case "body/nodes": return this.takeNodes(id, payload);
      case "tool/force_v2": {
        // It comes before the force of its tick.
        const tool = this.world.tool(id);
        if (tool !== undefined) tool.error = decode(ToolForceV2, payload).error_n;
        return;
      }
      case "tool/force": return this.takeForce(id, decode(ToolForce, payload));
      case "tool/contact": {
        const tool = world.tool(id);
        const contact = decode(ToolContact, payload);
        if (tool === undefined) return;
        tool.contactForce = contact.force;
        tool.energy = contact.energy_j;
        tool.dissipated = contact.dissipated_j;
        break;
      }
      case "tool/device": {
        const tool = world.tool(id);
        if (tool !== undefined) tool.device = decode(DeviceInfo, payload);
        break;
      }
      case "contact":
        world.contacts = decode(ContactSet, payload).contacts;
        break;
      case "status":
        this.takeStatus(decode(LoopStatus, payload));
        break;
      case "event":
        world.addEvent(happening(decode(SimEvent, payload)));
        return;
      case "holders": {
        const holders = JSON.parse(textOf(payload)) as Record<string, string | null>;
        for (const tool of world.tools) {
          tool.holder = holders[tool.id] ?? null;
          if (tool.holder === null) tool.device = null;
        }
        break;
      }
      case "rpc": {
        const { id: call, json } = callOf(payload);
        this.calls.get(call)?.(JSON.parse(json) as Answer);
        this.calls.delete(call);
        return;
      }
      case "refused": {
        const refused = JSON.parse(textOf(payload)) as { key?: string; error?: string };
        this.onRefused(refused.key ?? "", refused.error ?? "refused");
        return;
      }
      default:
        return;
    }
    world.touch();
  }

  /** Looks inside bodies, or no longer: the daemon sends nodes while somebody does. */
  lookInside(nodes: boolean, materials: boolean): void {
    if (nodes !== this.looking) {
      this.looking = nodes;
      this.send("inside", Uint8Array.of(nodes ? 1 : 0));
    }
    if ((nodes || materials) && !this.insideAsked && this.world.link === "live") {
      this.insideAsked = true;
      void this.fetchInside();
    }
  }

  private async fetchInside(): Promise<void> {
    try {
      const answer = await fetch("inside.json", { cache: "no-store" });
      this.world.setInsides(insidesOf(await answer.json()));
    } catch {
      // Bodies are then drawn without.
    }
  }

  private takeNodes(id: string, payload: Uint8Array): void {
    const body = this.world.body(id);
    if (body === undefined || payload.length < 8 || (payload.length - 8) % 12 !== 0) return;
    // A copy begins where 32-bit numbers may.
    body.nodes = new Float32Array(payload.slice(8).buffer);
    body.nodesVersion += 1;
    this.world.touch();
  }

  /** A loop that stands, or waits for poses, sends no forces; neither does a recording by the clock. */
  private fade(): void {
    const stands = this.lockstep || this.session.played === true || this.world.status?.state !== "Running";
    if (this.fading.look(this.world, stands)) this.world.touch();
  }

  private takeForce(id: string, force: ToolForce): void {
    const tool = this.world.tool(id);
    if (tool === undefined) return;
    const tick = Number(force.tick);
    tool.tick = tick;
    this.fading.take(tool, force);
    tool.proxy = force.proxy_position;
    tool.orientation = force.proxy_orientation;
    tool.depth = force.depth;
    tool.contacts = force.contact_count;
    tool.flags = force.flags;
    if (tool.hand !== null) tool.poseAgeMs = performance.now() - Number(force.t_client_ns) * 1e-6;
    this.world.tick = tick;
    tool.history.push(tick, ...force.force, force.depth, tool.energy, tool.dissipated, tool.error);
    this.world.touch();
  }

  private takeStatus(status: LoopStatus): void {
    const { world } = this;
    const tick = Number(status.tick);
    const ns = (value: bigint) => Number(value) * 1e-9;
    if (tick !== world.tick) world.tick = tick;
    world.status = status;
    world.loop.push(tick, ns(status.step.p50_ns), ns(status.step.p99_ns), ns(status.step.max_ns), ns(status.period.max_ns), status.rate_hz);
    // A force that does not change is not sent again: its line goes on all the same.
    for (const tool of world.tools) {
      if (tick > tool.tick) tool.history.push(tick, ...tool.force, tool.depth, tool.energy, tool.dissipated, tool.error);
    }
  }

  // What the page may say.

  claim(tool: string, info: DeviceInfo): void {
    this.send(`tool/${tool}/device`, encode(DeviceInfo, info));
  }

  pose(tool: string, pose: ToolPose): void {
    this.send(`tool/${tool}/pose`, encode(ToolPose, pose));
  }

  release(tool: string): void {
    this.send(`tool/${tool}/release`, new Uint8Array());
  }

  /** Simulated to real time, in lockstep. */
  speed(factor: number): void {
    const payload = new Uint8Array(8);
    new DataView(payload.buffer).setFloat64(0, factor, true);
    this.send("speed", payload);
  }

  /** Asks the loop for something. Always answers, if need be with why not. */
  call(method: string, args: Readonly<Record<string, unknown>> = {}): Promise<Answer> {
    if (!this.mayWrite) {
      const error = this.viewOnly ? "this page is for looking only" : "there is no connection to the daemon";
      return Promise.resolve({ ok: false, error });
    }
    const id = this.nextCall++;
    return new Promise((resolve) => {
      const timer = setTimeout(() => {
        this.calls.delete(id);
        resolve({ ok: false, error: "no answer within 30 s" });
      }, CALL_TIMEOUT_MS);
      this.calls.set(id, (answer) => {
        clearTimeout(timer);
        resolve(answer);
      });
      this.send(`rpc/${method}`, ofCall(id, JSON.stringify(args)));
    });
  }

  private send(key: string, payload: Uint8Array): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(frame(key, payload));
  }
}
