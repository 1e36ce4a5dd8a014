/**
 * When a force is too old to act: a daemon that dies, is stopped or is cut off cannot send zero.
 *
 * The share of a force that may act is 1 while forces come, 0 within 60 ms of the last one (110 with a deadband), and
 * rises to 1 over 100 ms when they come again. It depends on when they came alone. `docs/wire.md`, "The watchdog".
 */

import { ForceFlags, type ToolForce } from "./messages";

const FRESH_MS = 50;
const FRESH_SPARSE_MS = 100;
const FADE_OUT_MS = 10;
const FADE_IN_MS = 100;

/** Times are in ms, of one clock that does not jump. */
export class Watchdog {
  private readonly limit: number;
  private last: number | null = null;
  /** The gain when the last force came. */
  private before = 1;
  /** When forces began to come, at first or again, and the gain then. */
  private since = 0;
  private from = 1;

  /** `deadband`: the device asked for one, so the daemon may leave forces out. */
  constructor(deadband = false) {
    this.limit = deadband ? FRESH_SPARSE_MS : FRESH_MS;
  }

  /** A force came. */
  heard(now = performance.now()): void {
    const silence = this.silence(now);
    const gain = silence === null ? 1 : this.gain(now);
    if (silence === null || silence > this.limit) {
      this.since = now;
      this.from = gain;
    }
    this.before = gain;
    this.last = Math.max(now, this.last ?? now);
  }

  /** How long ago the last force came, ms; null before the first. */
  silence(now = performance.now()): number | null {
    return this.last === null ? null : Math.max(0, now - this.last);
  }

  /** The share of the newest force and torque that may act now, 0 to 1; 0 before the first. */
  gain(now = performance.now()): number {
    const age = this.silence(now);
    if (age === null || this.last === null) return 0;
    // It rises for as long as forces have been coming: those that waited while this program or the link stood still
    // come all at once, and may be as old as that.
    const most = Math.min(this.from + (this.last - this.since) / FADE_IN_MS, 1);
    const held = Math.min(age, this.limit);
    const risen = Math.min(this.before + held / FADE_IN_MS, most);
    return Math.max(0, risen - (age - held) / FADE_OUT_MS);
  }

  /** A force as it may act now; marked as ramping where that is less than all of it. */
  felt(force: ToolForce, now = performance.now()): ToolForce {
    const gain = this.gain(now);
    if (gain === 1) return force;
    const part = ([x, y, z]: ToolForce["force"]): ToolForce["force"] => [x * gain, y * gain, z * gain];
    return { ...force, force: part(force.force), torque: part(force.torque), flags: force.flags | ForceFlags.RAMPING };
  }
}
