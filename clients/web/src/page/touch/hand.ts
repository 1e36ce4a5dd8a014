/**
 * The page's hand: a device of its own on the bus, moved by mouse, finger or keys.
 *
 * It claims a tool, sends its pose 125 times a second by a timer, whether it moves or not, and lets go gently: the hand
 * follows the proxy until the spring between them is slack, so that nothing snaps. A page that draws slowly speaks less
 * often: the daemon then sends its last pose on for half a second, because the device says that it has no motors.
 */

import { ForceFlags, type DeviceInfo, type ToolPose } from "../../index";
import { add, norm, product, scaled, sub, turn, unitQuat, ZERO, type Quat, type Vec3 } from "../geometry";
import type { HandPose, Tool, World } from "../world";

/** What a hand needs of a daemon. */
export interface Holder {
  readonly mayWrite: boolean;
  claim(tool: string, info: DeviceInfo): void;
  pose(tool: string, pose: ToolPose): void;
  release(tool: string): void;
}

export const PERIOD_MS = 8;
/** A pose is sent at once when the pointer moves, but not more often than this. */
const LEAST_MS = 3;
const RELAX_MS = 700;
const CLAIM_MS = 3000;
/** Time over which velocity is averaged: two or three steps of a mouse. */
const SMOOTH_S = 0.02;
/** After a pause the hand comes no farther than in this time: the loop would take what is left for a jump. */
const STRIDE_S = 0.03;

/** A mouse has no motor: it is described by its rate, and any force can be shown. */
export function mouseInfo(name: string): DeviceInfo {
  return {
    name, dof_force: 0, dof_torque: 0, workspace: [0, 0, 0], force_max: 1e4, force_continuous: 1e4,
    torque_max: 1e4, mass: 0, damping: 0, coulomb_friction: 0, encoder_resolution: 0, rate_hz: 60, delay_s: 0, deadband: 0,
  };
}

type State = "free" | "holding" | "relaxing";

export class Hand {
  state: State = "free";
  tool: Tool | null = null;
  grip = false;
  /** Told when it was let go, with why if that was not asked for. */
  onEnd: (tool: string, why: string | null) => void = () => {};

  /** Of this page: two pages of one scene have different ones. */
  readonly name = `mouse ${crypto.getRandomValues(new Uint16Array(1))[0].toString(16).padStart(4, "0")}`;

  private confirmed = false;
  private claimed = 0;
  /** How far it was moved before the tool was its own. */
  private moved: Vec3 = ZERO;
  private target: Vec3 = ZERO;
  private position: Vec3 = ZERO;
  private velocity: Vec3 = ZERO;
  private orientation: Quat = [0, 0, 0, 1];
  private seq = 0n;
  private last = 0;
  private relaxedSince = 0;
  private timer: ReturnType<typeof setInterval> | undefined;

  constructor(private readonly world: World, private readonly daemon: Holder, private readonly sceneSize: () => number) {}

  get pose(): HandPose {
    return { position: this.position, orientation: this.orientation };
  }

  /** Takes a tool where it is. */
  take(tool: Tool): void {
    if (!this.daemon.mayWrite) return;
    if (this.state !== "free") {
      if (this.tool?.id === tool.id) {
        this.state = "holding";
        this.target = this.position;
        return;
      }
      this.end(null);
    }
    this.tool = tool;
    this.state = "holding";
    this.position = this.target = tool.proxy;
    this.orientation = unitQuat(tool.orientation);
    this.velocity = this.moved = ZERO;
    this.seq = 0n;
    this.grip = this.confirmed = false;
    this.daemon.claim(tool.id, mouseInfo(this.name));
    this.last = this.claimed = performance.now();
    this.timer = setInterval(() => this.step(), PERIOD_MS);
    this.world.touch();
  }

  /** Moves the hand's goal, m. */
  move(by: Vec3): void {
    if (this.state !== "holding" || !by.every(Number.isFinite)) return;
    this.target = add(this.target, by);
    if (!this.confirmed) this.moved = add(this.moved, by);
    if (performance.now() - this.last >= LEAST_MS) this.step();
  }

  /** Turns the tool about an axis of the world, rad. */
  turn(axis: Vec3, angle: number): void {
    if (this.state === "holding") this.orientation = unitQuat(product(turn(axis, angle), this.orientation));
  }

  /** Lets go gently. */
  letGo(): void {
    if (this.state !== "holding") return;
    this.state = "relaxing";
    this.grip = false;
    this.relaxedSince = performance.now();
  }

  /** The daemon would not have it, or the scene lost the tool. */
  end(why: string | null): void {
    const { tool } = this;
    clearInterval(this.timer);
    if (tool === null) return;
    const held = this.world.tool(tool.id);
    if (held !== undefined) held.hand = null;
    if (why === null) this.daemon.release(tool.id);
    this.tool = null;
    this.state = "free";
    this.world.touch();
    this.onEnd(tool.id, why);
  }

  private step(): void {
    const now = performance.now();
    const seconds = Math.max((now - this.last) * 1e-3, 1e-4);
    if (this.tool === null) return;
    const tool = this.world.tool(this.tool.id);
    if (tool === undefined) return this.end("the tool is not in the scene any more");
    // After a change of scene the tool goes on under its name.
    this.tool = tool;
    if (this.state === "relaxing") {
      if (!this.confirmed) return this.end(null);
      this.target = tool.proxy;
      if (now - this.relaxedSince > RELAX_MS) return this.end(null);
    }
    // A flick of the mouse is faster than a hand: the loop would refuse it as a jump.
    const size = this.sceneSize();
    const fastest = Math.min((this.state === "relaxing" ? 2 : 15) * size, 3);
    if (!this.confirmed) {
      // Poses before the daemon has said yes would be refused.
      this.confirmed = tool.holder === this.name;
      if (!this.confirmed && now - this.claimed > CLAIM_MS) return this.end("the daemon did not answer");
      if (!this.confirmed) return;
      // A tool whose first pose is inside a body feels no force: the first pose is where the tool is.
      this.position = tool.proxy;
      this.target = add(this.position, this.moved);
      return this.send(now);
    }
    // After a silence or a jump a tool may be inside: it moves out to its proxy, where the spring is slack, and goes on.
    const withheld = (tool.flags & ForceFlags.WITHHELD) !== 0;
    const way = sub(withheld ? tool.proxy : this.target, this.position);
    const longest = fastest * Math.min(seconds, STRIDE_S);
    const moved = norm(way) > longest ? scaled(way, longest / norm(way)) : way;
    this.position = add(this.position, moved);
    const share = seconds / (seconds + SMOOTH_S);
    this.velocity = add(scaled(this.velocity, 1 - share), scaled(moved, share / seconds));
    this.send(now);
  }

  private send(now: number): void {
    const { tool } = this;
    if (tool === null) return;
    this.seq += 1n;
    this.last = now;
    tool.hand = this.pose;
    this.daemon.pose(tool.id, {
      seq: this.seq,
      t_client_ns: BigInt(Math.round(now * 1e6)),
      position: this.position,
      orientation: this.orientation,
      linear_velocity: this.velocity,
      angular_velocity: ZERO,
      buttons: this.grip ? 1 : 0,
      flags: 0,
    });
    this.world.touch();
  }
}
