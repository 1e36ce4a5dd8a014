// Surfaces in the browser are those of the server: values of the Rust evaluation, printed by `palpate surface eval`.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import * as page from "../dist/page.js";

const surfaces = JSON.parse(readFileSync(new URL("surfaces.json", import.meta.url), "utf8"));

function surfaceOf(given) {
  const count = [given.points.length, given.points[0].length];
  const side = (k) => ({ degree: given.degree[k], periodic: given.periodic[k], count: count[k], knots: given.knots[k] });
  const weights = given.weights === null ? null : Float64Array.from(given.weights.flat());
  return { surface: { u: side(0), v: side(1), weights }, points: Float64Array.from(given.points.flat(2)) };
}

const sizeOf = (points) => new page.Bounds().take(points).size;
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

for (const given of surfaces) {
  const { surface, points } = surfaceOf(given);
  const size = sizeOf(points);
  const middle = new page.Bounds().take(points).middle;

  test(`${given.name}: points and normals are those of the Rust evaluation within 1e-6 of the size`, () => {
    for (const at of given.at) {
      const tess = new page.Tessellation(surface, middle, page.sampleAt(surface.u, [at.u, at.u]), page.sampleAt(surface.v, [at.v, at.v]));
      assert.equal(tess.evaluate(points), -1);
      const place = [...tess.positions.subarray(0, 3)].map((x, c) => x + middle[c]);
      assert.ok(distance(place, at.point) <= 1e-6 * size, `${at.u} ${at.v}: ${place} is not ${at.point}`);
      // At a pole the server's normal is a limit; the page's is the mean around it.
      if (at.normal === null || Math.hypot(...at.S_u) * Math.hypot(...at.S_v) < 1e-6 * size * size) continue;
      const normal = [...tess.normals.subarray(0, 3)];
      // The page's normal is S_u × S_v; outwards may be its opposite.
      const off = Math.min(distance(normal, at.normal), distance(normal.map((x) => -x), at.normal));
      if (Math.hypot(...normal) > 0) assert.ok(off <= 1e-6, `normal at ${at.u} ${at.v}: ${normal} is not ${at.normal}`);
    }
  });

  test(`${given.name}: mean curvature follows from the Rust derivatives`, () => {
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for (const at of given.at) {
      const { S_u: su, S_v: sv } = at;
      const n = [su[1] * sv[2] - su[2] * sv[1], su[2] * sv[0] - su[0] * sv[2], su[0] * sv[1] - su[1] * sv[0]];
      const length = Math.hypot(...n);
      // Near a pole curvature is a quotient of what vanishes.
      if (length < 1e-3 * Math.hypot(...su) * Math.hypot(...sv) || length === 0) continue;
      const [e, f, g] = [dot(su, su), dot(su, sv), dot(sv, sv)];
      const bend = (along) => dot(along, n) / length;
      const expected = (e * bend(at.S_vv) - 2 * f * bend(at.S_uv) + g * bend(at.S_uu)) / (2 * (e * g - f * f));
      if (Math.abs(e * g - f * f) < 1e-6 * e * g) continue;
      const tess = new page.Tessellation(surface, middle, page.sampleAt(surface.u, [at.u, at.u]), page.sampleAt(surface.v, [at.v, at.v]));
      tess.evaluate(points, true);
      if (!Number.isFinite(tess.curvature[0]) || Math.hypot(...tess.normals.subarray(0, 3)) === 0) continue;
      assert.ok(Math.abs(tess.curvature[0] - expected) <= 1e-4 * (Math.abs(expected) + 1 / size), `${at.u} ${at.v}: ${tess.curvature[0]}, ${expected}`);
    }
  });

  test(`${given.name}: the mesh is whole, its normals are unit vectors everywhere`, () => {
    const tess = page.tessellationOf(surface, middle, 48);
    assert.equal(tess.evaluate(points), -1);
    for (let k = 0; k < tess.vertices; k++) {
      const length = Math.hypot(...tess.normals.subarray(3 * k, 3 * k + 3));
      assert.ok(Math.abs(length - 1) < 1e-5, `vertex ${k}: length ${length}`);
    }
    assert.ok(tess.indices.every((index) => index < tess.vertices));
    assert.ok(tess.positions.every(Number.isFinite));
  });
}

test("a periodic surface closes: its last samples are its first", () => {
  const { surface, points } = surfaceOf(surfaces.find(({ name }) => name === "periodic in both"));
  const tess = page.tessellationOf(surface, [0, 0, 0], 48);
  tess.evaluate(points);
  const at = (a, b) => [...tess.positions.subarray(3 * (a * tess.v.count + b), 3 * (a * tess.v.count + b) + 3)];
  for (let b = 0; b < tess.v.count; b++) assert.ok(distance(at(0, b), at(tess.u.count - 1, b)) < 1e-7);
  for (let a = 0; a < tess.u.count; a++) assert.ok(distance(at(a, 0), at(a, tess.v.count - 1)) < 1e-7);
});

test("a branching surface is drawn in its pieces: no triangle spans a knot that separates it", () => {
  const { surface, points } = surfaceOf(surfaces.find(({ name }) => name.startsWith("vessel")));
  const tess = page.tessellationOf(surface, [0, 0, 0], 96);
  tess.evaluate(points);
  assert.deepEqual([...page.partedAfter(surface.u)], [16]);
  assert.deepEqual([...page.partedAfter(surface.v)], [7]);
  let longest = 0;
  for (let k = 0; k < tess.indices.length; k += 3) {
    const [a, b] = [3 * tess.indices[k], 3 * tess.indices[k + 1]];
    longest = Math.max(longest, distance([...tess.positions.subarray(a, a + 3)], [...tess.positions.subarray(b, b + 3)]));
  }
  assert.ok(longest < 0.1 * sizeOf(points), `an edge of ${longest} m`);
});

test("a net with NaN is refused and names the number", () => {
  const { surface, points } = surfaceOf(surfaces[0]);
  const tess = page.tessellationOf(surface, [0, 0, 0], 16);
  points[13] = NaN;
  assert.equal(tess.evaluate(points), 13);
});

test("knots that cannot be evaluated give no surface rather than a wrong one", () => {
  const { surface } = surfaceOf(surfaces[0]);
  for (const knots of [[0, 1], [0, 0, 0, 0, 1, NaN, 3, 4, 4, 4, 4], [0, 0, 0, 0, 3, 2, 1, 4, 4, 4, 4]]) {
    assert.equal(page.tessellationOf({ ...surface, u: { ...surface.u, knots } }, [0, 0, 0], 16), null);
  }
});

test("a net of 200 x 200 is evaluated within two pictures' time", () => {
  const knots = page.uniformKnots(3, 200);
  const side = { degree: 3, periodic: false, count: 200, knots };
  const points = Float64Array.from({ length: 3 * 200 * 200 }, (_, k) => [Math.floor(k / 600), Math.floor(k / 3) % 200, Math.sin(k)][k % 3] * 1e-3);
  const tess = page.tessellationOf({ u: side, v: side, weights: null }, [0, 0, 0], 128);
  tess.evaluate(points);
  const times = Array.from({ length: 7 }, () => {
    const start = performance.now();
    tess.evaluate(points);
    return performance.now() - start;
  }).sort((a, b) => a - b);
  console.log(`  200 x 200: ${tess.vertices} vertices, median ${times[3].toFixed(1)} ms`);
});
