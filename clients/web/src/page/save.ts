/** Files that the page makes: pictures and nets. */

import { isPart, PartTriangles } from "./surface/part";
import { tessellationOf } from "./surface/tessellate";
import { Bounds } from "./geometry";
import type { World } from "./world";

export function download(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A name that sorts by tick and is a file name on every system. */
export function fileName(world: World, ending: string): string {
  return `${world.name.replace(/[^\w-]+/g, "-") || "palpate"}-${String(world.tick).padStart(7, "0")}.${ending}`;
}

/**
 * Bodies as they are now, as Wavefront OBJ, m: triangles with normals. The control net stands in comments (`#net`), with
 * degrees and knots, because OBJ's own surfaces are read by few.
 */
export function objOf(world: World): string {
  const lines = [`# ${world.name}, tick ${world.tick}, metres`];
  let base = 1;
  for (const body of world.bodies) {
    if (body.fault !== null) continue;
    const { middle } = new Bounds().take(body.points);
    const origin = middle as [number, number, number];
    const outline = world.outlineOf(body);
    const part = isPart(body) && outline !== undefined ? new PartTriangles(outline, body.rest, origin) : null;
    const tess = part ?? tessellationOf(body.surface, origin, 96);
    if (tess === null || tess.evaluate(body.points) >= 0) continue;
    lines.push(`o ${body.id}`);
    for (const [name, side] of part !== null ? [] : [["u", body.surface.u], ["v", body.surface.v]] as const) {
      lines.push(`#net ${name} degree ${side.degree} count ${side.count} ${side.periodic ? "periodic" : ""} knots ${Array.from(side.knots).join(" ")}`);
    }
    for (let k = 0; part === null && k < body.points.length; k += 3) lines.push(`#net p ${body.points[k]} ${body.points[k + 1]} ${body.points[k + 2]}`);
    const { positions: p, normals: n, indices } = tess;
    for (let k = 0; k < p.length; k += 3) lines.push(`v ${p[k] + middle[0]} ${p[k + 1] + middle[1]} ${p[k + 2] + middle[2]}`);
    for (let k = 0; k < n.length; k += 3) lines.push(`vn ${n[k].toFixed(6)} ${n[k + 1].toFixed(6)} ${n[k + 2].toFixed(6)}`);
    for (let k = 0; k < indices.length; k += 3) {
      const corner = [0, 1, 2].map((c) => base + indices[k + c]);
      lines.push(`f ${corner.map((c) => `${c}//${c}`).join(" ")}`);
    }
    base += tess.vertices;
  }
  return lines.join("\n") + "\n";
}
