/** Figures in the words of the page: a number and its unit, short enough to read at a glance. */

const PREFIXES: readonly (readonly [number, string])[] = [[1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

/** `0.00123, "m"` as `1.23 mm`. Three digits. */
export function withUnit(value: number, unit: string): string {
  if (!Number.isFinite(value)) return `– ${unit}`;
  const size = Math.abs(value);
  if (size === 0) return `0 ${unit}`;
  // 999.6 mm would be rounded to "1000 mm".
  const [scale, prefix] = PREFIXES.find(([scale]) => size >= scale * 0.9995) ?? [1e-9, "n"];
  return `${digits(value / scale, 3)} ${prefix}${unit}`;
}

/** So many significant digits, without an exponent. */
export function digits(value: number, count: number): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const before = size >= 1 ? Math.floor(Math.log10(size) + 1e-12) + 1 : 1;
  return value.toFixed(Math.max(0, count - before)).replace(/^-(0(?:\.0+)?)$/, "$1");
}

/** Force with a fixed number of decimals: it changes many times a second and must not jump about. */
export const newtons = (value: number): string => `${value.toFixed(2).replace(/^-(0\.00)$/, "$1")} N`;

/** Simulated time: `1:02.345`, with hours where there are some. */
export function clock(seconds: number, decimals = 2): string {
  if (!Number.isFinite(seconds)) return "–";
  const whole = Math.floor(Math.abs(seconds));
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  // Cut, not rounded: 59.999 s is not yet a minute.
  const share = Math.floor((Math.abs(seconds) - whole) * 10 ** decimals + 1e-6);
  const part = decimals > 0 ? `.${String(Math.min(share, 10 ** decimals - 1)).padStart(decimals, "0")}` : "";
  const two = (n: number) => String(n).padStart(2, "0");
  return (h > 0 ? `${h}:${two(m)}` : `${m}`) + `:${two(s)}${part}`;
}

/** The next of 1, 2, 5, 10 … at or above a size. */
export function niceAbove(size: number): number {
  if (!(size > 0) || !Number.isFinite(size)) return 1;
  const ten = 10 ** Math.floor(Math.log10(size));
  return ten * ([1, 2, 5, 10].find((step) => step * ten >= size * (1 - 1e-9)) ?? 10);
}

/** Bytes as people read them. */
export function bytes(count: number): string {
  if (count < 1e3) return `${count} B`;
  if (count < 1e6) return `${(count / 1e3).toFixed(0)} kB`;
  return count < 1e9 ? `${(count / 1e6).toFixed(1)} MB` : `${(count / 1e9).toFixed(2)} GB`;
}
