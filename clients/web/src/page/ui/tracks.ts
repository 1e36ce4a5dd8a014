/** What charts draw: lines over seconds, from a running loop's history or from a recording's overview. */

import type { Overview } from "../mcap/overview";
import type { World } from "../world";

export interface Line {
  readonly label: string;
  /** Name of a colour of the style sheet. */
  readonly colour: string;
  readonly values: (number | null)[];
  readonly thin?: boolean;
}

export interface Panel {
  readonly time: number[];
  readonly lines: readonly Line[];
  /** What lies about a line: from low to high. */
  readonly band?: { readonly colour: string; readonly low: number[]; readonly high: number[] };
}

export interface Tracks {
  readonly force: Panel;
  readonly depth: Panel;
  readonly energy: Panel;
  readonly loop: Panel;
}

/** Colours of several tools in one chart. */
const MANY = ["size", "x", "z", "y", "second", "force"];

interface Row {
  readonly id: string;
  readonly time: number[];
  readonly fx: number[];
  readonly fy: number[];
  readonly fz: number[];
  readonly depth: number[];
  readonly energy: number[];
  readonly dissipated: number[];
  /** How far the force may be off, N. */
  readonly error: number[];
}

/** Several tools on the times of the first: each as of the newest of its rows. */
function onTimes(time: readonly number[], own: readonly number[], values: readonly number[]): (number | null)[] {
  let k = -1;
  return time.map((t) => {
    while (k + 1 < own.length && own[k + 1] <= t) k += 1;
    return k < 0 ? null : values[k];
  });
}

function tracksOf(rows: readonly Row[], loop: Panel): Tracks {
  const [first] = rows;
  if (first === undefined) {
    const none = { time: [], lines: [] };
    return { force: none, depth: none, energy: none, loop };
  }
  const { time } = first;
  const size = (row: Row) => row.fx.map((x, k) => Math.hypot(x, row.fy[k], row.fz[k]));
  if (rows.length > 1) {
    const each = (pick: (row: Row) => number[]): Panel => ({
      time,
      lines: rows.map((row, k) => ({ label: row.id, colour: MANY[k % MANY.length], values: onTimes(time, row.time, pick(row)) })),
    });
    return { force: each(size), depth: each((row) => row.depth.map((d) => 1e3 * d)), energy: each((row) => row.energy.map((e) => 1e3 * e)), loop };
  }
  const sizes = size(first);
  const aside = (sign: number) => sizes.map((force, k) => Math.max(0, force + sign * first.error[k]));
  return {
    force: {
      time,
      band: { colour: "size", low: aside(-1), high: aside(1) },
      lines: [
        { label: "size", colour: "size", values: sizes },
        { label: "x", colour: "x", values: first.fx, thin: true },
        { label: "y", colour: "y", values: first.fy, thin: true },
        { label: "z", colour: "z", values: first.fz, thin: true },
      ],
    },
    depth: { time, lines: [{ label: "depth", colour: "force", values: first.depth.map((d) => 1e3 * d) }] },
    energy: {
      time,
      lines: [
        { label: "work", colour: "z", values: first.energy.map((e) => 1e3 * e) },
        { label: "taken away", colour: "second", values: first.dissipated.map((e) => 1e3 * e) },
      ],
    },
    loop,
  };
}

/** The last `span` seconds of a running loop. */
export function liveTracks(world: World, chosen: ReadonlySet<string>, span: number): Tracks {
  const from = world.tick - span / world.dt;
  const start = (ticks: readonly number[]) => {
    let [low, high] = [0, ticks.length];
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (ticks[middle] < from) low = middle + 1;
      else high = middle;
    }
    return Math.max(0, low - 1);
  };
  const rows = world.tools.filter((tool) => chosen.has(tool.id)).map(({ id, history }): Row => {
    const k = start(history.ticks);
    const [fx, fy, fz, depth, energy, dissipated, error] = history.columns.map((column) => column.slice(k));
    return { id, time: history.ticks.slice(k).map((tick) => tick * world.dt), fx, fy, fz, depth, energy, dissipated, error };
  });
  const k = start(world.loop.ticks);
  const [p50, p99, , period] = world.loop.columns.map((column) => column.slice(k).map((s) => 1e3 * s));
  const [first] = rows;
  const nominal = 1e3 * world.dt;
  return tracksOf(first === undefined ? [] : rows, {
    time: world.loop.ticks.slice(k).map((tick) => tick * world.dt),
    lines: [
      { label: "median", colour: "z", values: p50 },
      { label: "p99", colour: "size", values: p99 },
      { label: "late", colour: "force", values: period.map((ms) => Math.max(0, ms - nominal)), thin: true },
    ],
  });
}

/** A recording, or what of it has been read. */
export function recordedTracks(overview: Overview, chosen: ReadonlySet<string>): Tracks {
  const { dt, toolIds } = overview.recording;
  const rows: number[] = [];
  for (let row = 0; row < overview.rows; row++) if (overview.filled[row] === 1) rows.push(row);
  const time = rows.map((row) => overview.tickOf(row) * dt);
  const pick = (values: Float64Array) => rows.map((row) => values[row]);
  const tools = toolIds.flatMap((id, t): Row[] => {
    const tool = overview.tools[t];
    if (!chosen.has(id) || tool === undefined) return [];
    return [{
      id, time, fx: pick(tool.fx), fy: pick(tool.fy), fz: pick(tool.fz),
      depth: pick(tool.depth), energy: pick(tool.energy), dissipated: pick(tool.dissipated), error: pick(tool.error),
    }];
  });
  return tracksOf(tools, {
    time,
    lines: [
      { label: "tick", colour: "size", values: pick(overview.step).map((s) => 1e3 * s) },
      { label: "late", colour: "force", values: pick(overview.late).map((s) => 1e3 * s), thin: true },
    ],
  });
}
