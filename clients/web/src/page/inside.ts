/** What is inside a body: cells between nodes, and what each is made of. From `/inside.json` of the server. */

export interface Inside {
  readonly id: string;
  /** Nodes at rest, m: x y z, x y z … */
  readonly nodes: Float32Array;
  /** Eight numbers of nodes a cell: corner (a, b, c) at `4 a + 2 b + c`; equal ones collapse edges. */
  readonly cells: Uint32Array;
  /** Young's modulus of each cell, Pa. */
  readonly youngPa: Float64Array;
}

/** Takes what the server sent; a body that is not whole is left out. */
export function insidesOf(json: unknown): Inside[] {
  if (!Array.isArray(json)) return [];
  const out: Inside[] = [];
  for (const given of json as { id?: unknown; nodes?: unknown; cells?: unknown; young_pa?: unknown }[]) {
    if (typeof given?.id !== "string" || !Array.isArray(given.nodes) || !Array.isArray(given.cells) || !Array.isArray(given.young_pa)) continue;
    const nodes = Float32Array.from(given.nodes as number[]);
    const cells = Uint32Array.from(given.cells as number[]);
    const youngPa = Float64Array.from(given.young_pa as number[]);
    const whole = nodes.length % 3 === 0 && cells.length === 8 * youngPa.length && cells.every((node) => 3 * node < nodes.length)
      && nodes.every(Number.isFinite) && youngPa.every(Number.isFinite);
    if (whole) out.push({ id: given.id, nodes, cells, youngPa });
  }
  return out;
}

/** Corner pairs of a cell's edges. */
const EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]] as const;

/** Pairs of nodes that cells connect, each once. */
export function edgesOf({ cells, nodes }: Inside): Uint32Array {
  const count = nodes.length / 3;
  const seen = new Set<number>();
  for (let at = 0; at < cells.length; at += 8) {
    for (const [a, b] of EDGES) {
      const [from, to] = [cells[at + a], cells[at + b]];
      if (from !== to) seen.add(Math.min(from, to) * count + Math.max(from, to));
    }
  }
  const edges = new Uint32Array(2 * seen.size);
  let k = 0;
  for (const pair of seen) {
    edges[k++] = Math.floor(pair / count);
    edges[k++] = pair % count;
  }
  return edges;
}

/** At each point (relative to `origin`): Young's modulus of the cell whose middle is nearest, Pa. */
export function youngAt(inside: Inside, points: ArrayLike<number>, origin: readonly number[]): Float32Array {
  const { cells, nodes, youngPa } = inside;
  const middles = new Float32Array(3 * youngPa.length);
  for (let k = 0; k < cells.length; k++) {
    for (let c = 0; c < 3; c++) middles[3 * (k >> 3) + c] += (nodes[3 * cells[k] + c] - origin[c]) / 8;
  }
  const out = new Float32Array(points.length / 3);
  const [first] = youngPa;
  if (youngPa.every((value) => value === first)) return out.fill(first ?? 0);
  for (let p = 0; p < out.length; p++) {
    const [x, y, z] = [points[3 * p], points[3 * p + 1], points[3 * p + 2]];
    let [nearest, least] = [0, Infinity];
    for (let k = 0; k < youngPa.length; k++) {
      const [dx, dy, dz] = [middles[3 * k] - x, middles[3 * k + 1] - y, middles[3 * k + 2] - z];
      const away = dx * dx + dy * dy + dz * dz;
      if (away < least) [nearest, least] = [k, away];
    }
    out[p] = youngPa[nearest];
  }
  return out;
}

/** Young's modulus at each node: the mean of the cells around it, Pa. */
export function youngOfNodes({ cells, nodes, youngPa }: Inside): Float32Array {
  const [sum, count] = [new Float64Array(nodes.length / 3), new Float64Array(nodes.length / 3)];
  cells.forEach((node, k) => {
    sum[node] += youngPa[k >> 3];
    count[node] += 1;
  });
  return Float32Array.from(sum, (value, k) => (count[k] > 0 ? value / count[k] : 0));
}
