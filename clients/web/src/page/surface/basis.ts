/**
 * Where a B-spline is evaluated in one direction, and the basis functions there.
 *
 * Piegl & Tiller, *The NURBS Book*, algorithm A2.3. Everything that depends on the knots alone is computed once: a new
 * net then costs sums of products. Pieces that a knot separates are sampled apart, each from its own side.
 */

/** Degree, knots and number of control points in one direction, in the convention of `palpate.surface.v1`. */
export interface Direction {
  readonly degree: number;
  readonly periodic: boolean;
  readonly count: number;
  readonly knots: ArrayLike<number>;
}

/** Samples in one direction. */
export interface Samples {
  readonly count: number;
  readonly width: number;
  readonly params: Float64Array;
  /** Control point of the first of `width` basis functions at each sample; the others follow, modulo `wrap`. */
  readonly first: Int32Array;
  readonly wrap: number;
  /** Basis functions, first and second derivatives: `width` numbers a sample. */
  readonly values: readonly [Float64Array, Float64Array, Float64Array];
  /** Samples between which cells are drawn: `cells[k]` and the one after it. */
  readonly cells: Int32Array;
  /** Samples at knots. */
  readonly knots: Int32Array;
}

/** All knots; of a periodic direction continued by `degree` knots on each side. */
export function extendedKnots({ degree, periodic, count, knots }: Direction): Float64Array {
  if (!periodic) return Float64Array.from(knots);
  const period = knots[count] - knots[0];
  const turn = (index: number) => Math.floor(index / count) * period;
  return Float64Array.from({ length: count + 1 + 2 * degree }, (_, k) => {
    const index = k - degree;
    return knots[((index % count) + count) % count] + turn(index);
  });
}

/** Why these knots cannot be evaluated; `null` if they can. */
export function knotFault(direction: Direction): string | null {
  const { degree, periodic, count, knots } = direction;
  const needed = periodic ? count + 1 : count + degree + 1;
  if (knots.length !== needed) return `${knots.length} knots where ${needed} are needed`;
  if (count < degree + 1 && !periodic) return `${count} control points are too few for degree ${degree}`;
  for (let k = 0; k < knots.length; k++) {
    if (!Number.isFinite(knots[k]) || (k > 0 && knots[k] < knots[k - 1])) return `knot ${k} is ${knots[k]}`;
  }
  return null;
}

/** Equal spans between clamped ends: what is assumed of a recording that does not hold its knots. */
export function uniformKnots(degree: number, count: number): Float64Array {
  return Float64Array.from({ length: count + degree + 1 }, (_, k) =>
    Math.min(Math.max(k - degree, 0), count - degree),
  );
}

/** Basis functions of `span` and their first two derivatives at `t`, into `out[order][at ...]`. */
export function basisAt(knots: Float64Array, degree: number, span: number, t: number, out: readonly Float64Array[], at: number): void {
  const p = degree;
  const ndu: number[][] = Array.from({ length: p + 1 }, () => new Array<number>(p + 1).fill(0));
  const left = new Float64Array(p + 1);
  const right = new Float64Array(p + 1);
  ndu[0][0] = 1;
  for (let j = 1; j <= p; j++) {
    left[j] = t - knots[span + 1 - j];
    right[j] = knots[span + j] - t;
    let saved = 0;
    for (let r = 0; r < j; r++) {
      ndu[j][r] = right[r + 1] + left[j - r];
      const part = ndu[r][j - 1] / ndu[j][r];
      ndu[r][j] = saved + right[r + 1] * part;
      saved = left[j - r] * part;
    }
    ndu[j][j] = saved;
  }
  for (let r = 0; r <= p; r++) out[0][at + r] = ndu[r][p];
  for (let r = 0; r <= p; r++) {
    let [s1, s2] = [0, 1];
    const a = [new Float64Array(p + 1), new Float64Array(p + 1)];
    a[0][0] = 1;
    let factor = p;
    for (let k = 1; k <= 2; k++) {
      if (k > p) {
        out[k][at + r] = 0;
        continue;
      }
      let d = 0;
      const rk = r - k;
      const pk = p - k;
      if (r >= k) {
        a[s2][0] = a[s1][0] / ndu[pk + 1][rk];
        d = a[s2][0] * ndu[rk][pk];
      }
      const j1 = rk >= -1 ? 1 : -rk;
      const j2 = r - 1 <= pk ? k - 1 : p - r;
      for (let j = j1; j <= j2; j++) {
        a[s2][j] = (a[s1][j] - a[s1][j - 1]) / ndu[pk + 1][rk + j];
        d += a[s2][j] * ndu[rk + j][pk];
      }
      if (r <= pk) {
        a[s2][k] = -a[s1][k - 1] / ndu[pk + 1][r];
        d += a[s2][k] * ndu[r][pk];
      }
      out[k][at + r] = d * factor;
      factor *= p - k;
      [s1, s2] = [s2, s1];
    }
  }
}

/** Every place of evaluation as a span and a parameter in it. */
interface Place {
  span: number;
  t: number;
}

function samplesAt(direction: Direction, places: readonly Place[], cells: readonly number[], atKnots: readonly number[]): Samples {
  const { degree, count } = direction;
  const knots = extendedKnots(direction);
  const width = degree + 1;
  const table = () => new Float64Array(width * places.length);
  const values = [table(), table(), table()] as const;
  places.forEach(({ span, t }, k) => basisAt(knots, degree, span, t, values, k * width));
  return {
    count: places.length,
    width,
    params: Float64Array.from(places, ({ t }) => t),
    first: Int32Array.from(places, ({ span }) => span - degree),
    wrap: count,
    values,
    cells: Int32Array.from(cells),
    knots: Int32Array.from(atKnots),
  };
}

/** First and last knot of the domain, in extended knots. */
function domain(direction: Direction, knots: Float64Array): readonly [number, number] {
  return [direction.degree, knots.length - 1 - direction.degree];
}

/** Samples with `cellsPerSpan` cells in every span that is not empty. */
export function sampleSpans(direction: Direction, cellsPerSpan: number): Samples {
  const knots = extendedKnots(direction);
  const [start, end] = domain(direction, knots);
  const places: Place[] = [];
  const cells: number[] = [];
  const atKnots: number[] = [];
  let spans = 0;
  for (let span = start; span < end; span++) {
    const [from, to] = [knots[span], knots[span + 1]];
    if (!(to > from)) continue;
    // At a knot of multiplicity `degree` or more the surface may crease or end: its two sides get a sample each.
    let multiplicity = 0;
    for (let k = span; k >= 0 && knots[k] === from; k--) multiplicity += 1;
    if (spans === 0 || multiplicity >= direction.degree) {
      atKnots.push(places.length);
      places.push({ span, t: from });
    }
    for (let c = 1; c <= cellsPerSpan; c++) {
      cells.push(places.length - 1);
      places.push({ span, t: c === cellsPerSpan ? to : from + ((to - from) * c) / cellsPerSpan });
    }
    atKnots.push(places.length - 1);
    spans += 1;
  }
  return samplesAt(direction, places, cells, atKnots);
}

/** Samples at given parameters, for tests and for single points; at a knot, from the right. */
export function sampleAt(direction: Direction, params: readonly number[]): Samples {
  const knots = extendedKnots(direction);
  const [start, end] = domain(direction, knots);
  const places = params.map((t) => {
    let span = start;
    for (let k = start; k < end; k++) if (knots[k] <= t && knots[k + 1] > knots[k]) span = k;
    return { span, t };
  });
  return samplesAt(direction, places, [], []);
}

/** Spans that are not empty. */
export function spanCount(direction: Direction): number {
  const knots = extendedKnots(direction);
  const [start, end] = domain(direction, knots);
  let spans = 0;
  for (let k = start; k < end; k++) if (knots[k + 1] > knots[k]) spans += 1;
  return spans;
}

/** Rows after which the net begins anew: no line of the net goes on from there. */
export function partedAfter({ degree, periodic, count, knots }: Direction): Set<number> {
  const parted = new Set<number>();
  if (periodic) return parted;
  for (let k = 1; k + degree < knots.length; k++) {
    if (knots[k] === knots[k + degree] && knots[k] > knots[k - 1] && knots[k] > knots[0] && knots[k] < knots[count]) {
      parted.add(k - 1);
    }
  }
  return parted;
}
