/**
 * Forces that stopped coming are shown no longer: the daemon may be stopped or cut off, and its socket does not say so.
 *
 * As in every client (`Watchdog`), with what is different for a picture: a page that was busy drawing has its messages
 * still before it, so time in which it did not look does not count; and a force that comes again is shown at once, for no
 * hand feels it.
 */

import { Watchdog, type ToolForce } from "../../index";
import type { Tool, World } from "../world";

/** Between two looks, ms; of a longer time so much counts. */
export const LOOK_MS = 10;
const MOST_MS = 20;

export class Fading {
  private readonly newest = new Map<string, { dog: Watchdog; force: ToolForce; gain: number }>();
  /** Time in which this page looked, ms. */
  private clock = 0;
  private looked: number | null = null;

  private tick(now: number): number {
    this.clock += Math.min(now - (this.looked ?? now), MOST_MS);
    this.looked = now;
    return this.clock;
  }

  /** A force came: it is shown in full. */
  take(tool: Tool, force: ToolForce, now = performance.now()): void {
    const clock = this.tick(now);
    const known = this.newest.get(tool.id);
    // The page gets the newest, sixty a second: some may be missing, as with a deadband.
    const dog = known?.dog.gain(clock) === 1 ? known.dog : new Watchdog(true);
    dog.heard(clock);
    this.newest.set(tool.id, { dog, force, gain: 1 });
    tool.force = force.force;
    tool.torque = force.torque;
  }

  /** Shows what is left of forces that stopped coming; true if that became less. `stands`: no forces are due. */
  look(world: World, stands: boolean, now = performance.now()): boolean {
    if (stands) this.looked = now;
    const clock = this.tick(now);
    let changed = false;
    for (const tool of world.tools) {
      const known = this.newest.get(tool.id);
      const gain = known?.dog.gain(clock) ?? 1;
      if (known === undefined || gain === known.gain) continue;
      known.gain = gain;
      const felt = known.dog.felt(known.force, clock);
      tool.force = felt.force;
      tool.torque = felt.torque;
      changed = true;
    }
    return changed;
  }

  /** The link is gone, and all forces with it. */
  drop(world: World): void {
    this.newest.clear();
    for (const tool of world.tools) {
      tool.force = tool.torque = [0, 0, 0];
    }
  }
}
