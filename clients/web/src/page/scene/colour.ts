/**
 * Colour maps: a number to a colour, for eyes of every kind.
 *
 * The maps grow steadily darker (or lighter), so that they read without hue; `ember` begins at the plain colour of a
 * body. The diverging one is ColorBrewer's RdBu. Tables are linear RGB, what the renderer takes.
 */

import type { Settings } from "../settings";
import { niceAbove } from "../units";

const STOPS = {
  ember: ["#f1dfd2", "#f8cfa6", "#f9b277", "#f28f4f", "#e0693a", "#c24333", "#962640", "#651746", "#38103c"],
  viridis: ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"],
  cividis: ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#e1cc55", "#fee838"],
  diverging: ["#053061", "#2166ac", "#4393c3", "#92c5de", "#f2f2f2", "#f4a582", "#d6604d", "#b2182b", "#67001f"],
} as const;

export type MapName = keyof typeof STOPS;

const linear = (value: number): number => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);

function channels(hex: string): [number, number, number] {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255) as [number, number, number];
}

const SIZE = 256;
const tables = new Map<MapName, Float32Array>();

/** 256 colours, linear RGB. */
export function tableOf(name: MapName): Float32Array {
  const known = tables.get(name);
  if (known !== undefined) return known;
  const stops = STOPS[name].map(channels);
  const table = new Float32Array(3 * SIZE);
  for (let k = 0; k < SIZE; k++) {
    const place = (k / (SIZE - 1)) * (stops.length - 1);
    const low = Math.min(Math.floor(place), stops.length - 2);
    for (let c = 0; c < 3; c++) table[3 * k + c] = linear(stops[low][c] + (stops[low + 1][c] - stops[low][c]) * (place - low));
  }
  tables.set(name, table);
  return table;
}

/** For a legend. */
export function gradientOf(name: MapName): string {
  return `linear-gradient(to right, ${STOPS[name].join(", ")})`;
}

/** Colours of values between `from` and `to`, three numbers each, into `out`. */
export function paint(values: ArrayLike<number>, from: number, to: number, name: MapName, out: Float32Array): void {
  const table = tableOf(name);
  const scale = (SIZE - 1) / (to - from || 1);
  for (let k = 0; k < values.length; k++) {
    const place = Math.round(Math.min(Math.max((values[k] - from) * scale, 0), SIZE - 1)) * 3;
    out[3 * k] = table[place];
    out[3 * k + 1] = table[place + 1];
    out[3 * k + 2] = table[place + 2];
  }
}

/** What colours mean at the moment: for the legend and for painting. */
export interface Scale {
  readonly label: string;
  readonly unit: string;
  readonly map: MapName;
  readonly from: number;
  readonly to: number;
}

/** The upper end of a scale: follows a larger value at once and a smaller one after a while, in steps of 1, 2, 5. */
export class Range {
  private top = 0;
  private since = 0;

  /** `least` keeps noise from being shown in full colour. */
  follow(largest: number, least: number, now: number, locked: boolean): number {
    if (locked && this.top > 0) return this.top;
    const wanted = niceAbove(Math.max(largest, least));
    if (wanted >= this.top) [this.top, this.since] = [wanted, now];
    else if (largest > 0.4 * this.top) this.since = now;
    else if (now - this.since > 3000) [this.top, this.since] = [wanted, now];
    return this.top;
  }

  reset(): void {
    this.top = 0;
  }
}

/** Name, unit and map of what colours show; `null` for no scale. */
export function meaning(settings: Settings): Omit<Scale, "from" | "to"> | null {
  switch (settings.colourBy) {
    case "displacement": return { label: "Displacement", unit: "m", map: settings.map };
    case "indentation": return { label: "Indentation (inwards)", unit: "m", map: settings.map };
    case "curvature": return { label: "Mean curvature", unit: "1/m", map: "diverging" };
    case "stiffness": return { label: "Young's modulus", unit: "Pa", map: settings.map };
    case "difference": return { label: "Difference of the two", unit: "m", map: settings.map };
    default: return null;
  }
}
