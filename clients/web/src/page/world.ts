/**
 * What is known of a scene: bodies, tools, contacts, status and events, as the newest message told.
 *
 * Plain data, written by a source and read by whoever draws. Counters (`version`, `netVersion` …) say what changed since
 * somebody last looked, so that nothing is drawn twice and nobody needs to be told.
 */

import type { Contact, DeviceInfo, LoopStatus, SceneSnapshot } from "../index";
import { partedAfter, type Direction } from "./surface/basis";
import type { Inside } from "./inside";
import type { Surface } from "./surface/tessellate";
import { Bounds, ZERO, type Quat, type Vec3 } from "./geometry";
import { History } from "./history";

/** A body: its surface, its net at rest and its net now. */
export class Body {
  points: Float64Array;
  netTick = 0;
  /** Grows when a net differs from the one before. */
  netVersion = 1;
  /** Why it is not drawn; `null` if it is. */
  fault: string | null = null;
  /** Its cells, where the server told them; and where its nodes are, m, while somebody looks. */
  inside: Inside | null = null;
  nodes: Float32Array | null = null;
  nodesVersion = 1;

  constructor(
    readonly id: string,
    readonly model: string,
    readonly surface: Surface,
    readonly rest: Float64Array,
    points: Float64Array,
    /** True where the knots are not known but assumed to be uniform. */
    readonly assumed: boolean,
  ) {
    this.points = points;
  }

  /** Rows and columns after which the net begins anew. */
  get parted(): readonly [Set<number>, Set<number>] {
    if (this.surface.u.degree === 0) return [new Set(), new Set()];
    return [partedAfter(this.surface.u), partedAfter(this.surface.v)];
  }

  /** Takes a net of the same size; false if it is another body's. */
  takeNet(points: Float64Array, countU: number, countV: number, tick: number): boolean {
    if (countU !== this.surface.u.count || countV !== this.surface.v.count || points.length !== 3 * countU * countV) return false;
    const moved = points.some((value, k) => value !== this.points[k]);
    this.points = points;
    this.netTick = tick;
    // The daemon repeats the net of a body at rest every second.
    if (!moved) return true;
    this.netVersion += 1;
    const bad = points.findIndex((value) => !Number.isFinite(value));
    this.fault = bad < 0 ? null : `control point ${Math.floor(bad / 3)} of ${this.id} is not a number`;
    return true;
  }
}

/** A kind of event that may come hundreds of times: those that follow each other are one line with their sum. */
export interface Repeated {
  readonly kind: string;
  readonly count: bigint;
  readonly worst: bigint;
  readonly words: (count: bigint, worst: bigint) => string;
}

/** A hand that moves a tool: where its device is. */
export interface HandPose {
  readonly position: Vec3;
  readonly orientation: Quat;
}

/** A tool: its proxy, what it feels, and who holds it. */
export class Tool {
  proxy: Vec3;
  orientation: Quat;
  force: Vec3 = ZERO;
  torque: Vec3 = ZERO;
  contactForce: Vec3 = ZERO;
  /** How far the force may be off, N. */
  error = 0;
  depth = 0;
  contacts = 0;
  flags = 0;
  energy = 0;
  dissipated = 0;
  tick = 0;
  /** Age of the pose that made the newest force, when it arrived, ms; of our own hand. */
  poseAgeMs = 0;
  /** Pose of the device: known of our own mouse and of recorded ones. */
  hand: HandPose | null = null;
  device: DeviceInfo | null = null;
  holder: string | null = null;
  readonly history = new History();

  constructor(
    readonly id: string,
    readonly shape: string,
    readonly radius: number,
    readonly forceMax: number,
    readonly start: HandPose,
  ) {
    this.proxy = start.position;
    this.orientation = start.orientation;
  }
}

/** Triangles, m, as `/tools.json` lists them: of a tool in its own frame, of a part (`shape`) at rest in the world. */
export interface Outline {
  readonly id: string;
  readonly shape: string;
  readonly points: readonly (readonly number[])[];
  readonly triangles: readonly (readonly number[])[];
}

/** An event in plain words. */
export interface Happening {
  readonly tick: number;
  readonly seq: number;
  /** For the filter: `tool`, `fault`, `recorder`, `loop`, `scene`. */
  readonly about: "tool" | "fault" | "recorder" | "loop" | "scene";
  readonly serious: boolean;
  readonly text: string;
  readonly repeated?: Repeated;
}

/** How the page and the daemon (or the file) stand. */
export type Link = "connecting" | "live" | "lost" | "playing" | "failed";

const EVENTS_KEPT = 1000;
/** Events that are remembered as told: a daemon tells its last ones again to a page that comes back. */
const TOLD_KEPT = 4000;
/** A repeated event joins one of its kind among so many that follow each other: two for each tool. */
const NEAR = 128;

export class World {
  name = "";
  sceneHash = "";
  dt = 1e-3;
  lockstep = false;
  bodies: Body[] = [];
  tools: Tool[] = [];
  outlines: readonly Outline[] = [];
  insides: readonly Inside[] = [];
  contacts: readonly Contact[] = [];
  status: LoopStatus | null = null;
  events: Happening[] = [];
  instances: readonly string[] = [];
  link: Link = "connecting";
  /** When the daemon was heard last, by the clock of the page, ms. */
  heard = 0;
  /** What went wrong with the link, in words. */
  trouble = "";
  tick = 0;
  /** Grows with every change of anything. */
  version = 0;
  /** Grows when bodies or tools become others. */
  sceneVersion = 0;
  outlineVersion = 0;
  eventVersion = 0;
  /** Grows when what is drawn over time starts anew (a seek, another file). */
  historyVersion = 0;
  /** Tick time and lateness, by tick. */
  readonly loop = new History();

  /** Seconds of simulated time at a tick. */
  seconds(tick = this.tick): number {
    return tick * this.dt;
  }

  touch(): void {
    this.version += 1;
  }

  /** Takes what is inside the bodies. */
  setInsides(insides: readonly Inside[]): void {
    this.insides = insides;
    const known = new Map(insides.map((inside) => [inside.id, inside]));
    for (const body of this.bodies) {
      body.inside = known.get(body.id) ?? null;
    }
    this.touch();
  }

  /** The triangles of a body that is a part. */
  outlineOf(body: Body): Outline | undefined {
    return this.outlines.find(({ id, shape }) => id === body.id && shape === "part");
  }

  body(id: string): Body | undefined {
    return this.bodies.find((body) => body.id === id);
  }

  tool(id: string): Tool | undefined {
    return this.tools.find((tool) => tool.id === id);
  }

  /** Starts from a snapshot. Tools that stay keep their history and holder. */
  load(snapshot: SceneSnapshot): void {
    const before = new Map(this.tools.map((tool) => [tool.id, tool]));
    const hashBefore = this.sceneHash;
    this.name = snapshot.scene_name;
    this.sceneHash = [...snapshot.scene_hash].map((byte) => byte.toString(16).padStart(2, "0")).join("");
    this.dt = Number(snapshot.dt_ns) * 1e-9 || 1e-3;
    this.lockstep = snapshot.lockstep;
    this.tick = Number(snapshot.tick);
    // What was inside the bodies of another scene is asked for anew.
    if (this.sceneHash !== hashBefore) this.insides = [];
    const inside = new Map(this.insides.map((known) => [known.id, known]));
    this.bodies = snapshot.bodies.map((given) => {
      const direction = (side: 0 | 1): Direction => ({
        degree: given.degree[side],
        periodic: given.periodic[side],
        count: given.count[side],
        knots: given.knots[side],
      });
      const surface = { u: direction(0), v: direction(1), weights: given.weights };
      const body = new Body(given.id, given.model, surface, given.rest_points, given.points, false);
      const whole = given.rest_points.length === given.points.length && body.takeNet(given.points, given.count[0], given.count[1], this.tick);
      body.inside = inside.get(given.id) ?? null;
      if (!whole) body.fault = `the net of ${given.id} has not ${given.count[0]} × ${given.count[1]} points`;
      return body;
    });
    this.tools = snapshot.tools.map((given) => {
      const start = { position: given.position, orientation: given.orientation };
      const tool = new Tool(given.id, given.shape, given.radius, given.force_max, start);
      const old = before.get(given.id);
      if (old === undefined) return tool;
      const { holder, device, history, hand } = old;
      return Object.assign(tool, { holder, device, history, hand });
    });
    this.contacts = [];
    this.sceneVersion += 1;
    this.touch();
  }

  private readonly told = new Set<string>();

  addEvent(event: Happening): void {
    const key = `${event.seq} ${event.tick} ${event.text}`;
    if (this.told.has(key)) return;
    this.told.add(key);
    if (this.told.size > TOLD_KEPT) for (const old of this.told) {
      this.told.delete(old);
      if (this.told.size <= TOLD_KEPT / 2) break;
    }
    this.joinOrPush(event);
    if (this.events.length > EVENTS_KEPT) this.events.splice(0, this.events.length - EVENTS_KEPT);
    this.eventVersion += 1;
    this.touch();
  }

  /** Late ticks come in reports, hands in a bad link come and go, by the hundred: they must not push out what else happened. */
  private joinOrPush(event: Happening): void {
    const { repeated } = event;
    for (let k = this.events.length - 1; repeated !== undefined && k >= Math.max(0, this.events.length - NEAR); k--) {
      const before = this.events[k];
      if (before.repeated === undefined) break;
      if (before.repeated.kind !== repeated.kind) continue;
      const count = before.repeated.count + repeated.count;
      const worst = before.repeated.worst > repeated.worst ? before.repeated.worst : repeated.worst;
      this.events.splice(k, 1);
      this.events.push({ ...event, text: repeated.words(count, worst), repeated: { ...repeated, count, worst } });
      return;
    }
    this.events.push(event);
  }

  /** Space that the bodies take, with their tools where these are near. */
  bounds(): Bounds {
    const bounds = new Bounds();
    for (const body of this.bodies) bounds.take(body.rest);
    const size = bounds.size;
    const whole = bounds.empty ? new Bounds() : new Bounds().take(bounds.low).take(bounds.high);
    for (const tool of this.tools) {
      const far = bounds.low.some((low, c) => tool.proxy[c] < low - size || tool.proxy[c] > bounds.high[c] + size);
      if (!far || bounds.empty) whole.take(tool.proxy);
    }
    return whole;
  }
}
