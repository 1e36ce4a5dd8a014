/**
 * A recording from afar: what its charts and its timeline show, in a few thousand rows whatever its length.
 *
 * Of a short file every tick is kept. Of a long one each row is the strongest of its ticks; of a very long one only every
 * so-manyth chunk is read, which `sampled` says.
 */

import type { Recording } from "./recording";

const MOST_ROWS = 6000;
/** So much of a file is read for its overview, bytes. */
const MOST_BYTES = 64 << 20;

export interface ToolRows {
  readonly fx: Float64Array;
  readonly fy: Float64Array;
  readonly fz: Float64Array;
  readonly size: Float64Array;
  /** How far that force may be off, N. */
  readonly error: Float64Array;
  readonly depth: Float64Array;
  readonly energy: Float64Array;
  readonly dissipated: Float64Array;
  readonly contact: Uint8Array;
}

export class Overview {
  readonly rows: number;
  readonly ticksPerRow: number;
  readonly filled: Uint8Array;
  readonly tools: readonly ToolRows[];
  readonly step: Float64Array;
  readonly late: Float64Array;
  events: { tick: number; kind: string; detail: string }[] = [];
  version = 0;
  done = false;
  /** Every so-manyth chunk was read. */
  sampled = 1;
  private stopped = false;

  constructor(readonly recording: Recording) {
    const ticks = recording.lastTick - recording.firstTick + 1;
    this.ticksPerRow = Math.max(1, Math.ceil(ticks / MOST_ROWS));
    this.rows = Math.max(1, Math.ceil(ticks / this.ticksPerRow));
    this.filled = new Uint8Array(this.rows);
    const row = () => new Float64Array(this.rows);
    this.tools = recording.toolIds.map(() => ({
      fx: row(), fy: row(), fz: row(), size: row(), error: row(), depth: row(), energy: row(), dissipated: row(), contact: new Uint8Array(this.rows),
    }));
    this.step = row();
    this.late = row();
  }

  tickOf(row: number): number {
    return this.recording.firstTick + row * this.ticksPerRow;
  }

  stop(): void {
    this.stopped = true;
  }

  /** Goes through the file, giving way to everything else. */
  async fill(): Promise<void> {
    const { chunks, channels } = this.recording.file;
    const all = chunks.reduce((sum, chunk) => sum + chunk.length, 0);
    this.sampled = Math.max(1, Math.ceil(all / MOST_BYTES));
    const eventChannel = [...channels].find(([, topic]) => topic === "/sim/event")?.[0] ?? -1;
    let paused = performance.now();
    let extra = 400;
    for (let k = 0; k < chunks.length && !this.stopped; k++) {
      if (k % this.sampled !== 0) {
        if (!(chunks[k].channels?.has(eventChannel) ?? false) || extra-- <= 0) continue;
      }
      const chunk = await this.recording.passing(k);
      this.events.push(...chunk.events);
      for (const row of chunk.ticks) this.take(row);
      if (performance.now() - paused > 24) {
        this.version += 1;
        await new Promise((resolve) => setTimeout(resolve));
        paused = performance.now();
      }
    }
    this.events.sort((a, b) => a.tick - b.tick);
    this.done = true;
    this.version += 1;
  }

  private take(tick: { tick: number; tools: readonly { contacts: number; values: Float64Array; contact: { values: Float64Array } | null }[]; lateNs: number; stagesNs: readonly number[] }): void {
    const row = Math.floor((tick.tick - this.recording.firstTick) / this.ticksPerRow);
    if (row < 0 || row >= this.rows) return;
    this.filled[row] = 1;
    this.step[row] = Math.max(this.step[row], 1e-9 * tick.stagesNs.reduce((sum, ns) => sum + ns, 0));
    this.late[row] = Math.max(this.late[row], 1e-9 * tick.lateNs);
    tick.tools.forEach(({ values, contacts, contact }, t) => {
      const into = this.tools[t];
      if (into === undefined || values.length < 21) return;
      const size = Math.hypot(values[0], values[1], values[2]);
      if (size >= into.size[row]) {
        [into.fx[row], into.fy[row], into.fz[row], into.size[row]] = [values[0], values[1], values[2], size];
        into.error[row] = values[21] ?? 0;
      }
      into.depth[row] = Math.max(into.depth[row], contact?.values[8] ?? 0);
      into.energy[row] = values[19];
      into.dissipated[row] = values[20];
      if (contacts > 0) into.contact[row] = 1;
    });
  }

  /** First and last tick of each stretch of contact of a tool. */
  contactIntervals(tool: number): [number, number][] {
    const intervals: [number, number][] = [];
    const { contact } = this.tools[tool];
    const step = Math.max(this.ticksPerRow, this.recording.every);
    for (let row = 0; row < this.rows; row++) {
      if (contact[row] === 0) continue;
      const last = intervals[intervals.length - 1];
      const end = this.tickOf(row) + step - 1;
      // A gap of a row that was not read is not a gap in contact.
      if (last !== undefined && this.tickOf(row) - last[1] <= 1 + step * (this.sampled - 1)) last[1] = end;
      else intervals.push([this.tickOf(row), end]);
    }
    return intervals;
  }
}
