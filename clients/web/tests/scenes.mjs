// Scenes for tests: what a daemon would tell, made here.

import { readFileSync } from "node:fs";

const surfaces = JSON.parse(readFileSync(new URL("surfaces.json", import.meta.url), "utf8"));

/** A body of `surfaces.json`, or moved by `shift`. */
export function bodyOf(id, name = "teardrop", shift = [0, 0, 0]) {
  const given = surfaces.find((surface) => surface.name.startsWith(name));
  const points = Float64Array.from(given.points.flat(2)).map((x, k) => x + shift[k % 3]);
  return {
    id, model: "lattice", degree: given.degree, periodic: given.periodic, knots: given.knots.map((knots) => Float64Array.from(knots)),
    count: [given.points.length, given.points[0].length], points, rest_points: points.slice(),
    weights: given.weights === null ? null : Float64Array.from(given.weights.flat()), revision: 1n,
  };
}

/** A flat net of n × n. */
export function sheetOf(id, n, size = 0.1) {
  const points = new Float64Array(3 * n * n);
  for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) points.set([(i / (n - 1) - 0.5) * size, (j / (n - 1) - 0.5) * size, 0], 3 * (i * n + j));
  const knots = Float64Array.from({ length: n + 4 }, (_, k) => Math.min(Math.max(k - 3, 0), n - 3));
  return { id, model: "lattice", degree: [3, 3], periodic: [false, false], knots: [knots, knots.slice()], count: [n, n], points, rest_points: points.slice(), weights: null, revision: 1n };
}

export function toolOf(id, position = [0.06, 0.003, 0.045], radius = 0.01) {
  return { id, shape: "sphere", radius, stiffness: 1000, damping: 1, force_max: 8, position, orientation: [0, 0, 0, 1] };
}

export function snapshotOf(bodies = [bodyOf("drop")], tools = [toolOf("ball")], name = "mock") {
  return { tick: 0n, scene_hash: new Uint8Array(32), scene_name: name, dt_ns: 1_000_000n, lockstep: false, bodies, tools };
}

export function forceOf(tick, force, proxy = [0.06, 0.003, 0.045], depth = 0) {
  return {
    tick, pose_seq: 1n, t_client_ns: 0n, t_server_ns: 0n, force, torque: [0, 0, 0], proxy_position: proxy,
    proxy_orientation: [0, 0, 0, 1], depth, contact_count: depth > 0 ? 1 : 0, flags: 0,
  };
}

export function statusOf(tick, tools, state = "Running", recorder = "Off") {
  const quantiles = { p50_ns: 120_000n, p99_ns: 400_000n, max_ns: 600_000n };
  const zero = { superseded: 0n, wrong_version: 0n, malformed: 0n, oversized: 0n, not_finite: 0n, bad_quaternion: 0n, duplicated: 0n, out_of_order: 0n, jumps: 0n, stale_ticks: 0n, energy_j: 0, forces_sent: 0n, forces_overtaken: 0n, forces_lost: 0n };
  return {
    tick, state, rate_hz: 1000, late_ticks: 3n, skipped_ticks: 0n, period: { p50_ns: 1_000_000n, p99_ns: 1_050_000n, max_ns: 1_200_000n },
    step: quantiles, tools: tools.map((tool) => ({ tool, received: 0n, ...zero })), recorder, recorder_bytes: 0n, recorder_drops: 0n, quality_level: 0, followed_tool: "", shift_s: 0, wait: quantiles,
  };
}

/** Triangles of a ball. */
export function ballOutline(id, radius = 0.01) {
  const [points, triangles, n] = [[], [], 16];
  for (let i = 0; i <= n / 2; i++) for (let j = 0; j < n; j++) {
    const [a, b] = [(Math.PI * 2 * i) / n, (Math.PI * 2 * j) / n];
    points.push([radius * Math.sin(a) * Math.cos(b), radius * Math.sin(a) * Math.sin(b), radius * Math.cos(a)]);
  }
  for (let i = 0; i < n / 2; i++) for (let j = 0; j < n; j++) {
    const [a, b, c, d] = [i * n + j, (i + 1) * n + j, (i + 1) * n + ((j + 1) % n), i * n + ((j + 1) % n)];
    triangles.push([a, b, c], [a, c, d]);
  }
  return { id, shape: "sphere", points, triangles };
}

/** Two cells, one above the other, the upper one ten times as stiff. */
export function twoCells(id) {
  const nodes = [];
  for (const z of [0, 0.05, 0.12]) for (const x of [-0.02, 0.02]) for (const y of [-0.02, 0.02]) nodes.push(x, y, z);
  const at = (layer, a, b) => 4 * layer + 2 * a + b;
  // Corner (a, b, c) at 4 a + 2 b + c.
  const cell = (layer) => Array.from({ length: 8 }, (_, k) => at(layer + (k & 1), k >> 2, (k >> 1) & 1));
  return { id, nodes, cells: [...cell(0), ...cell(1)], young_pa: [3000, 30000] };
}

/** A frame of nodes: the tick, then x y z of each as 32 bits. */
export function nodesFrame(tick, nodes) {
  const bytes = new Uint8Array(8 + 4 * nodes.length);
  const view = new DataView(bytes.buffer);
  view.setBigUint64(0, tick, true);
  nodes.forEach((x, k) => view.setFloat32(8 + 4 * k, x, true));
  return bytes;
}
