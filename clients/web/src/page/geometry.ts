/** Vectors and quaternions (x y z w) as plain arrays: state has no drawing library in it. */

export type Vec3 = readonly [number, number, number];
export type Quat = readonly [number, number, number, number];

export const ZERO: Vec3 = [0, 0, 0];
export const UPRIGHT: Quat = [0, 0, 0, 1];

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a: Vec3, s: number): Vec3 => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);
export const isFiniteVec = (a: readonly number[]): boolean => a.every(Number.isFinite);

/** Turns by `a`, then by `b` is `product(b, a)`. */
export function product(b: Quat, a: Quat): Quat {
  return [
    b[3] * a[0] + b[0] * a[3] + b[1] * a[2] - b[2] * a[1],
    b[3] * a[1] - b[0] * a[2] + b[1] * a[3] + b[2] * a[0],
    b[3] * a[2] + b[0] * a[1] - b[1] * a[0] + b[2] * a[3],
    b[3] * a[3] - b[0] * a[0] - b[1] * a[1] - b[2] * a[2],
  ];
}

/** Length 1 to the last bit that matters; upright where there is no direction. */
export function unitQuat(q: Quat): Quat {
  const length = Math.hypot(...q);
  return length > 1e-9 ? [q[0] / length, q[1] / length, q[2] / length, q[3] / length] : UPRIGHT;
}

/** A turn about an axis, rad. */
export function turn(axis: Vec3, angle: number): Quat {
  const s = Math.sin(angle / 2) / (norm(axis) || 1);
  return unitQuat([axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)]);
}

/** Lowest and highest corner of points x y z, x y z …; what is not finite is left out. */
export class Bounds {
  readonly low: [number, number, number] = [Infinity, Infinity, Infinity];
  readonly high: [number, number, number] = [-Infinity, -Infinity, -Infinity];

  take(points: ArrayLike<number>): this {
    for (let k = 0; k + 2 < points.length; k += 3) {
      for (let c = 0; c < 3; c++) {
        const value = points[k + c];
        if (value < this.low[c]) this.low[c] = value;
        if (value > this.high[c]) this.high[c] = value;
      }
    }
    return this;
  }

  get empty(): boolean {
    return !this.low.every((low, c) => low <= this.high[c]);
  }

  get middle(): Vec3 {
    return this.empty ? ZERO : scaled(add(this.low, this.high), 0.5);
  }

  /** Length of the diagonal, m; 0.1 of nothing. */
  get size(): number {
    return this.empty ? 0.1 : norm(sub(this.high, this.low)) || 0.1;
  }
}
