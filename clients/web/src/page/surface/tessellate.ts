/**
 * A control net made into triangles with smooth normals.
 *
 * S(u, v) = Σ N_i(u) Σ M_j(v) P_ij, rational with weights. Positions are relative to `origin`, so that 32 bits are
 * enough wherever the body is. A net with a number that is not finite is refused: nothing of it can be drawn.
 */

import { knotFault, sampleSpans, spanCount, type Direction, type Samples } from "./basis";

/** A net in space. */
export interface Surface {
  readonly u: Direction;
  readonly v: Direction;
  readonly weights: Float64Array | null;
}

type Rows = readonly [Float64Array, Float64Array, Float64Array];

/** Points, normals and triangles of one body; made once, evaluated for every net. */
export class Tessellation {
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  readonly indices: Uint32Array;
  /** Mean curvature at each vertex, 1/m; computed on request. */
  readonly curvature: Float32Array;
  private readonly wide: number;
  private readonly homogeneous: Float64Array;
  private readonly rows: Rows;
  private readonly degenerate: number[] = [];
  /** Derivatives shorter than this are rounding. */
  private readonly least = [0, 0];

  constructor(
    readonly surface: Surface,
    readonly origin: readonly [number, number, number],
    readonly u: Samples,
    readonly v: Samples,
  ) {
    const vertices = u.count * v.count;
    this.positions = new Float32Array(3 * vertices);
    this.normals = new Float32Array(3 * vertices);
    this.curvature = new Float32Array(vertices);
    this.wide = surface.weights === null ? 3 : 4;
    this.homogeneous = new Float64Array(this.wide * surface.u.count * surface.v.count);
    const row = () => new Float64Array(this.wide * surface.v.count);
    this.rows = [row(), row(), row()];
    this.indices = new Uint32Array(6 * u.cells.length * v.cells.length);
    let at = 0;
    for (const a of u.cells) {
      for (const b of v.cells) {
        const k = a * v.count + b;
        this.indices.set([k, k + v.count, k + v.count + 1, k, k + v.count + 1, k + 1], at);
        at += 6;
      }
    }
  }

  /** Number of vertices. */
  get vertices(): number {
    return this.u.count * this.v.count;
  }

  /** Evaluates a net. Returns which of its numbers is not finite, or -1. */
  evaluate(points: Float64Array, curvature = false): number {
    const fault = points.findIndex((value) => !Number.isFinite(value));
    if (fault >= 0) return fault;
    const { u, v, wide } = this;
    this.lift(points);
    this.degenerate.length = 0;
    const sums = new Float64Array(6 * wide);
    const orders = curvature ? 3 : 2;
    for (let a = 0; a < u.count; a++) {
      this.sumRows(a, orders);
      if (wide === 3 && !curvature) {
        this.plainRow(a);
        continue;
      }
      for (let b = 0; b < v.count; b++) {
        this.sumColumns(b, sums, curvature);
        if (wide === 4) divideByWeight(sums, curvature);
        this.store(a * v.count + b, sums, curvature);
      }
    }
    this.mendPoles();
    return -1;
  }

  private lift(points: Float64Array): void {
    const { homogeneous, wide, origin } = this;
    const weights = this.surface.weights;
    let size = 0;
    for (let k = 0; 3 * k < points.length; k++) {
      const weight = weights === null ? 1 : weights[k];
      for (let c = 0; c < 3; c++) {
        homogeneous[wide * k + c] = weight * (points[3 * k + c] - origin[c]);
        size = Math.max(size, Math.abs(points[3 * k + c] - points[c]));
      }
      if (wide === 4) homogeneous[4 * k + 3] = weight;
    }
    [this.u, this.v].forEach(({ params, count }, side) => {
      this.least[side] = (1e-7 * size) / (params[count - 1] - params[0]);
    });
  }

  /** Rows of the net summed at sample `a` in u: value and derivatives. */
  private sumRows(a: number, orders: number): void {
    const { u, homogeneous, wide } = this;
    const stride = wide * this.surface.v.count;
    for (let order = 0; order < orders; order++) {
      const row = this.rows[order].fill(0);
      for (let r = 0; r < u.width; r++) {
        const basis = u.values[order][a * u.width + r];
        const from = ((u.first[a] + r) % u.wrap) * stride;
        for (let k = 0; k < stride; k++) row[k] += basis * homogeneous[from + k];
      }
    }
  }

  /**
   * A row of points and normals without weights and curvature: what runs with every picture. The same sums as below,
   * in local variables, which costs a quarter of the time.
   */
  private plainRow(a: number): void {
    const { v, positions, normals, least } = this;
    const [s, su] = this.rows;
    const [m, m1] = v.values;
    const { width, wrap, first } = v;
    for (let b = 0; b < v.count; b++) {
      let px = 0, py = 0, pz = 0, ax = 0, ay = 0, az = 0, bx = 0, by = 0, bz = 0;
      let k = b * width;
      for (let r = 0; r < width; r++, k++) {
        let column = first[b] + r;
        while (column >= wrap) column -= wrap;
        const from = 3 * column;
        const basis = m[k], slope = m1[k];
        const x = s[from], y = s[from + 1], z = s[from + 2];
        px += basis * x;
        py += basis * y;
        pz += basis * z;
        ax += basis * su[from];
        ay += basis * su[from + 1];
        az += basis * su[from + 2];
        bx += slope * x;
        by += slope * y;
        bz += slope * z;
      }
      const vertex = a * v.count + b;
      const at = 3 * vertex;
      positions[at] = px;
      positions[at + 1] = py;
      positions[at + 2] = pz;
      const nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
      const alongU = Math.sqrt(ax * ax + ay * ay + az * az);
      const alongV = Math.sqrt(bx * bx + by * by + bz * bz);
      const length = Math.sqrt(nx * nx + ny * ny + nz * nz);
      if (alongU <= least[0] || alongV <= least[1] || !(length > 1e-9 * alongU * alongV)) {
        this.degenerate.push(vertex);
        normals[at] = normals[at + 1] = normals[at + 2] = 0;
        continue;
      }
      normals[at] = nx / length;
      normals[at + 1] = ny / length;
      normals[at + 2] = nz / length;
    }
  }

  /** S, S_u, S_v (and S_uu, S_uv, S_vv), homogeneous. */
  private sumColumns(b: number, sums: Float64Array, second: boolean): void {
    const { v, wide, rows } = this;
    const [m, m1, m2] = v.values;
    sums.fill(0);
    for (let r = 0; r < v.width; r++) {
      const k = b * v.width + r;
      const from = ((v.first[b] + r) % v.wrap) * wide;
      for (let c = 0; c < wide; c++) {
        const [s, su] = [rows[0][from + c], rows[1][from + c]];
        sums[c] += m[k] * s;
        sums[wide + c] += m[k] * su;
        sums[2 * wide + c] += m1[k] * s;
        if (second) {
          sums[3 * wide + c] += m[k] * rows[2][from + c];
          sums[4 * wide + c] += m1[k] * su;
          sums[5 * wide + c] += m2[k] * s;
        }
      }
    }
  }

  private store(vertex: number, sums: Float64Array, second: boolean): void {
    const w = this.wide;
    const at = 3 * vertex;
    for (let c = 0; c < 3; c++) this.positions[at + c] = sums[c];
    const [ax, ay, az] = [sums[w], sums[w + 1], sums[w + 2]];
    const [bx, by, bz] = [sums[2 * w], sums[2 * w + 1], sums[2 * w + 2]];
    const nx = ay * bz - az * by;
    const ny = az * bx - ax * bz;
    const nz = ax * by - ay * bx;
    const length = Math.hypot(nx, ny, nz);
    // Where a derivative vanishes but for rounding (a pole) the product has no direction; its neighbours give it one.
    const [alongU, alongV] = [Math.hypot(ax, ay, az), Math.hypot(bx, by, bz)];
    if (alongU <= this.least[0] || alongV <= this.least[1] || !(length > 1e-9 * alongU * alongV)) {
      this.degenerate.push(vertex);
      this.normals.fill(0, at, at + 3);
      this.curvature[vertex] = NaN;
      return;
    }
    this.normals[at] = nx / length;
    this.normals[at + 1] = ny / length;
    this.normals[at + 2] = nz / length;
    if (!second) return;
    const along = (k: number) => (sums[k * w] * nx + sums[k * w + 1] * ny + sums[k * w + 2] * nz) / length;
    const [e, f, g] = [ax * ax + ay * ay + az * az, ax * bx + ay * by + az * bz, bx * bx + by * by + bz * bz];
    // H = (e N − 2 f M + g L) / 2 (e g − f²); less than zero where the surface bends away from its normal.
    this.curvature[vertex] = (e * along(5) - 2 * f * along(4) + g * along(3)) / (2 * (e * g - f * f));
  }

  /** Normals (and curvatures) at poles: the mean over the vertices with the same place and over their neighbours. */
  private mendPoles(): void {
    if (this.degenerate.length === 0) return;
    const { u, v, normals, positions, curvature } = this;
    const groups = new Map<string, number[]>();
    for (const vertex of this.degenerate) {
      const at = 3 * vertex;
      const key = [0, 1, 2].map((c) => Math.fround(positions[at + c]).toPrecision(5)).join();
      const group = groups.get(key);
      if (group === undefined) groups.set(key, [vertex]);
      else group.push(vertex);
    }
    for (const group of groups.values()) {
      const sum = [0, 0, 0];
      let [bend, bends] = [0, 0];
      for (const vertex of group) {
        const [a, b] = [Math.floor(vertex / v.count), vertex % v.count];
        for (const [da, db] of [[-1, 0], [1, 0], [0, -1], [0, 1]]) {
          const [na, nb] = [a + da, b + db];
          if (na < 0 || nb < 0 || na >= u.count || nb >= v.count) continue;
          const near = na * v.count + nb;
          for (let c = 0; c < 3; c++) sum[c] += normals[3 * near + c];
          if (Number.isFinite(curvature[near])) [bend, bends] = [bend + curvature[near], bends + 1];
        }
      }
      const length = Math.hypot(sum[0], sum[1], sum[2]) || 1;
      for (const vertex of group) {
        for (let c = 0; c < 3; c++) normals[3 * vertex + c] = sum[c] / length;
        curvature[vertex] = bends > 0 ? bend / bends : 0;
      }
    }
  }
}

/** Quotient rule, The NURBS Book eq. 4.20: from homogeneous sums (4 wide) to those of the surface, in place. */
function divideByWeight(s: Float64Array, second: boolean): void {
  const [w, wu, wv] = [s[3], s[7], s[11]];
  const [wuu, wuv, wvv] = [s[15], s[19], s[23]];
  for (let c = 0; c < 3; c++) {
    s[c] /= w;
    s[4 + c] = (s[4 + c] - wu * s[c]) / w;
    s[8 + c] = (s[8 + c] - wv * s[c]) / w;
    if (second) {
      s[12 + c] = (s[12 + c] - 2 * wu * s[4 + c] - wuu * s[c]) / w;
      s[16 + c] = (s[16 + c] - wu * s[8 + c] - wv * s[4 + c] - wuv * s[c]) / w;
      s[20 + c] = (s[20 + c] - 2 * wv * s[8 + c] - wvv * s[c]) / w;
    }
  }
}

/** A tessellation of about `target` cells in each direction; `null` where the knots cannot be used. */
export function tessellationOf(surface: Surface, origin: readonly [number, number, number], target: number): Tessellation | null {
  if (knotFault(surface.u) !== null || knotFault(surface.v) !== null) return null;
  const sample = (direction: Direction) => {
    const cells = Math.round(target / spanCount(direction));
    return sampleSpans(direction, direction.degree === 1 ? 1 : Math.min(Math.max(cells, 1), 12));
  };
  return new Tessellation(surface, origin, sample(surface.u), sample(surface.v));
}
