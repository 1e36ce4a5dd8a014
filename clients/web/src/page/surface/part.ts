/** Parts: triangles that move as one. Their net are the eight corners of a box around them, of degree 0. */

import { cross, dot, norm, scaled, sub, type Vec3 } from "../geometry";
import type { Body, Outline } from "../world";

/** What a body is drawn as. */
export interface Triangles {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly indices: Uint32Array;
  readonly curvature: Float32Array;
  readonly vertices: number;
  evaluate(net: Float64Array, curvature?: boolean): number;
}

/** Triangles that meet at a smaller angle share their normals, as a cosine. */
const SMOOTH = Math.cos((30 * Math.PI) / 180);

type Frame = readonly [Vec3, Vec3, Vec3];

/** Directions of the box's edges; the shortest is taken from the others, as it may be none. */
function frameOf(corners: ArrayLike<number>): Frame | null {
  const at = (k: number): Vec3 => [corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]];
  const edges = [1, 2, 4].map((k) => sub(at(k), at(0)));
  const lengths = edges.map(norm);
  const least = lengths.indexOf(Math.min(...lengths));
  edges[least] = cross(edges[(least + 1) % 3], edges[(least + 2) % 3]);
  const [x, y, z] = edges.map((edge) => scaled(edge, 1 / norm(edge)));
  return [...x, ...y, ...z].every(Number.isFinite) ? [x, y, z] : null;
}

export class PartTriangles implements Triangles {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly indices: Uint32Array;
  readonly curvature: Float32Array;
  /** Pairs of vertices: edges at which it is not smooth. */
  readonly creases: number[] = [];
  private readonly restPositions: Float32Array;
  private readonly restNormals: Float32Array;
  private readonly restFrame: Frame | null;

  constructor(outline: Outline, private readonly rest: Float64Array, private readonly origin: readonly [number, number, number]) {
    const { points, triangles } = outline;
    const flat = triangles.map(([a, b, c]): Vec3 => {
      const [p, q, r] = [a, b, c].map((k) => points[k] as unknown as Vec3);
      return cross(sub(q, p), sub(r, p));
    });
    const unit = flat.map((normal) => scaled(normal, 1 / (norm(normal) || 1)));
    const around: number[][] = points.map(() => []);
    triangles.forEach((corners, t) => corners.forEach((k) => around[k].push(t)));
    this.indices = Uint32Array.from({ length: 3 * triangles.length }, (_, k) => k);
    this.positions = new Float32Array(3 * this.indices.length);
    this.normals = new Float32Array(3 * this.indices.length);
    this.curvature = new Float32Array(this.indices.length);
    triangles.forEach((corners, t) => corners.forEach((k, c) => {
      const at = 3 * (3 * t + c);
      this.positions.set(points[k].map((x, axis) => x - origin[axis]), at);
      let normal: Vec3 = [0, 0, 0];
      for (const other of around[k]) {
        if (dot(unit[other], unit[t]) >= SMOOTH) normal = [0, 1, 2].map((axis) => normal[axis] + flat[other][axis]) as unknown as Vec3;
      }
      this.normals.set(scaled(normal, 1 / (norm(normal) || 1)), at);
    }));
    const sides = new Map<number, [number, number, number]>();
    triangles.forEach((corners, t) => corners.forEach((from, c) => {
      const to = corners[(c + 1) % 3];
      const key = Math.min(from, to) * points.length + Math.max(from, to);
      const met = sides.get(key);
      if (met === undefined) sides.set(key, [t, 3 * t + c, 3 * t + ((c + 1) % 3)]);
      else {
        if (dot(unit[met[0]], unit[t]) < SMOOTH) this.creases.push(met[1], met[2]);
        sides.delete(key);
      }
    }));
    for (const [, from, to] of sides.values()) this.creases.push(from, to);
    this.restPositions = this.positions.slice();
    this.restNormals = this.normals.slice();
    this.restFrame = frameOf(rest);
  }

  get vertices(): number {
    return this.indices.length;
  }

  /** Brings it to where the corners of its box are. Returns which of their numbers is not finite, or -1. */
  evaluate(corners: Float64Array): number {
    const fault = corners.findIndex((value) => !Number.isFinite(value));
    if (fault >= 0) return fault;
    const { rest, origin, restFrame } = this;
    if (corners.every((value, k) => value === rest[k])) {
      this.positions.set(this.restPositions);
      this.normals.set(this.restNormals);
      return -1;
    }
    const frame = frameOf(corners);
    if (frame === null || restFrame === null) return 0;
    const turned = (x: number, y: number, z: number): Vec3 => {
      const along = restFrame.map((axis) => dot(axis, [x, y, z]));
      return [0, 1, 2].map((c) => along[0] * frame[0][c] + along[1] * frame[1][c] + along[2] * frame[2][c]) as unknown as Vec3;
    };
    const arm = [0, 1, 2].map((c) => origin[c] - rest[c]);
    for (let k = 0; k < this.positions.length; k += 3) {
      const p = turned(this.restPositions[k] + arm[0], this.restPositions[k + 1] + arm[1], this.restPositions[k + 2] + arm[2]);
      const n = turned(this.restNormals[k], this.restNormals[k + 1], this.restNormals[k + 2]);
      for (let c = 0; c < 3; c++) {
        this.positions[k + c] = p[c] + corners[c] - origin[c];
        this.normals[k + c] = n[c];
      }
    }
    return -1;
  }
}

/** The body has no B-spline. */
export const isPart = (body: Body): boolean => body.surface.u.degree === 0;
