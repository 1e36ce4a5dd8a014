/** Bodies: shaded surfaces and their control nets. */

import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshPhongMaterial,
  Points, PointsMaterial, Sphere, Vector3,
} from "three";
import type { Body, Outline } from "../world";
import { Bounds } from "../geometry";
import { youngAt, type Inside } from "../inside";
import { isPart, PartTriangles, type Triangles } from "../surface/part";
import { tessellationOf, Tessellation } from "../surface/tessellate";
import type { ColourBy } from "../settings";
import { paint, type MapName, type Scale } from "./colour";
import { LatticeView } from "./lattice";
import type { Stage } from "./stage";

/** Cells in each direction of a body that is alone. */
const CELLS = 104;

/** More lines than these, in each direction, hide what they are drawn on. */
const MOST_LINES = 18;

/** Okabe and Ito's colours, which differ for every eye. */
const OWN = ["#f1dfd2", "#9fd0f0", "#f3c98b", "#8fd8bd", "#e8b1d1", "#f2e791", "#a9b8e8"];

export class BodyView {
  readonly group = new Group();
  /** Largest and smallest of what colours show, of the net drawn. */
  extent: readonly [number, number] = [0, 0];
  readonly tessellation: Triangles | null;

  private readonly geometry = new BufferGeometry();
  private readonly surface: Mesh<BufferGeometry, MeshPhongMaterial>;
  private readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly net: Group;
  private readonly netPoints: Float32Array;
  private readonly values: Float32Array;
  private readonly colours: Float32Array;
  private readonly restPositions: Float32Array;
  private readonly restNormals: Float32Array;
  private readonly inwards: number;
  private lattice: LatticeView | null = null;
  private young: Float32Array | null = null;
  private readonly size: number;
  private moved = { net: -1, curved: false };
  private measured: { net: number; what: string; other: number; inside: Inside | null } = { net: -1, what: "", other: -1, inside: null };
  private painted = "";

  constructor(readonly body: Body, private readonly stage: Stage, private readonly number: number, many: number, outline?: Outline) {
    const { middle, size } = new Bounds().take(body.rest);
    this.size = size;
    const target = Math.max(28, Math.round(CELLS / Math.sqrt(many)));
    const complete = body.rest.length === 3 * body.surface.u.count * body.surface.v.count;
    const origin = middle as [number, number, number];
    if (isPart(body)) this.tessellation = outline === undefined ? null : new PartTriangles(outline, body.rest, origin);
    else this.tessellation = complete ? tessellationOf(body.surface, origin, target) : null;
    const tess = this.tessellation;
    const material = new MeshPhongMaterial({
      vertexColors: true, side: DoubleSide, specular: 0x2a2a2a, shininess: 22, clipShadows: true,
      // Lines on the surface are nearer than the surface.
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.surface = new Mesh(this.geometry, material);
    this.surface.castShadow = true;
    this.surface.receiveShadow = true;
    this.surface.name = body.id;
    // Nets move with every picture: bounds are set by hand, generously, and not computed from 20,000 points each time.
    this.geometry.boundingSphere = new Sphere(new Vector3(), 4 * size);
    const vertices = tess?.vertices ?? 0;
    this.values = new Float32Array(vertices);
    this.colours = new Float32Array(3 * vertices).fill(1);
    if (tess !== null) {
      tess.evaluate(body.rest);
      this.geometry.setIndex(new BufferAttribute(tess.indices, 1));
      this.geometry.setAttribute("position", new BufferAttribute(tess.positions, 3));
      this.geometry.setAttribute("normal", new BufferAttribute(tess.normals, 3));
      this.geometry.setAttribute("color", new BufferAttribute(this.colours, 3));
    }
    this.restPositions = tess?.positions.slice() ?? new Float32Array();
    this.restNormals = tess?.normals.slice() ?? new Float32Array();
    // Outwards is S_u × S_v or its opposite: the one that gives a closed body a volume above zero.
    this.inwards = tess !== null && signedVolume(tess) < 0 ? 1 : -1;
    this.group.position.set(...middle);
    this.netPoints = new Float32Array(body.rest.length);
    this.net = this.makeNet(size);
    this.lines = this.makeLines();
    this.group.add(this.surface, this.lines, this.net);
  }

  /** Lines of constant u and of constant v at knots: how the surface is divided, and how it is bent. */
  private makeLines(): LineSegments<BufferGeometry, LineBasicMaterial> {
    const geometry = new BufferGeometry();
    const tess = this.tessellation;
    if (tess instanceof PartTriangles) {
      geometry.setAttribute("position", this.geometry.getAttribute("position"));
      geometry.setIndex(tess.creases);
      geometry.boundingSphere = this.geometry.boundingSphere;
    } else if (tess instanceof Tessellation) {
      const { u, v } = tess;
      const index: number[] = [];
      const some = (knots: Int32Array) => knots.filter((_, k) => k % Math.ceil(knots.length / MOST_LINES) === 0);
      for (const a of some(u.knots)) for (const b of v.cells) index.push(a * v.count + b, a * v.count + b + 1);
      for (const b of some(v.knots)) for (const a of u.cells) index.push(a * v.count + b, (a + 1) * v.count + b);
      geometry.setAttribute("position", this.geometry.getAttribute("position"));
      geometry.setIndex(index);
      geometry.boundingSphere = this.geometry.boundingSphere;
    }
    return new LineSegments(geometry, new LineBasicMaterial({ color: 0x241a16, transparent: true, opacity: 0.17, depthWrite: false }));
  }

  private makeNet(size: number): Group {
    const { u, v } = this.body.surface;
    const [partedU, partedV] = this.body.parted;
    const lines: number[] = [];
    for (let i = 0; i < u.count; i++) {
      for (let j = 0; j < v.count; j++) {
        const k = i * v.count + j;
        if (j + 1 < v.count ? !partedV.has(j) : v.periodic) lines.push(k, i * v.count + ((j + 1) % v.count));
        if (i + 1 < u.count ? !partedU.has(i) : u.periodic) lines.push(k, ((i + 1) % u.count) * v.count + j);
      }
    }
    const geometry = new BufferGeometry();
    const at = new BufferAttribute(this.netPoints, 3);
    geometry.setAttribute("position", at);
    geometry.setIndex(lines);
    geometry.boundingSphere = new Sphere(new Vector3(), 4 * size);
    const dots = new BufferGeometry();
    dots.setAttribute("position", at);
    dots.boundingSphere = geometry.boundingSphere;
    const group = new Group();
    const colour = new Color("#2f7fd6");
    group.add(
      new LineSegments(geometry, new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.75 })),
      new Points(dots, new PointsMaterial({ color: colour, size: 4, sizeAttenuation: false })),
    );
    return group;
  }

  /** Cells inside, made when they are first looked at. True while they are shown: the surface lets them be seen. */
  private showLattice(on: boolean): boolean {
    const { inside, nodes, nodesVersion } = this.body;
    if (this.lattice !== null && this.lattice.inside !== inside) {
      this.lattice.dispose();
      this.lattice = null;
      this.young = null;
    }
    // The daemon sends nodes only while they move: until the first message their places are unknown.
    if (on && this.lattice === null && inside !== null && nodes !== null) {
      const { x, y, z } = this.group.position;
      this.lattice = new LatticeView(inside, [x, y, z], this.size);
      this.group.add(this.lattice.group);
    }
    const shown = on && this.lattice !== null && nodes !== null && this.body.fault === null;
    if (this.lattice !== null) this.lattice.group.visible = shown;
    if (shown && nodes !== null) this.lattice?.place(nodes, nodesVersion);
    return shown;
  }

  setLayers(surface: boolean, lines: boolean, net: boolean, lattice: boolean, clipped: boolean): void {
    const seenThrough = this.showLattice(lattice);
    const { material: skin } = this.surface;
    if (skin.transparent !== seenThrough) {
      [skin.transparent, skin.opacity, skin.depthWrite, skin.needsUpdate] = [seenThrough, seenThrough ? 0.28 : 1, !seenThrough, true];
    }
    const whole = this.body.fault === null;
    this.surface.visible = surface && whole && this.tessellation !== null;
    // A body whose knots cannot be used is shown as its net.
    this.net.visible = (net || this.tessellation === null) && whole && !isPart(this.body);
    this.lines.visible = lines && whole && this.tessellation !== null;
    const planes = clipped ? [this.stage.clip] : null;
    for (const material of [this.surface.material, this.lines.material]) {
      if ((material.clippingPlanes === null) !== (planes === null)) material.needsUpdate = true;
      material.clippingPlanes = planes;
    }
  }

  /** Brings the surface and the net to the body's points. */
  private move(what: ColourBy): void {
    const { body, tessellation: tess } = this;
    const curved = what === "curvature";
    if (this.moved.net === body.netVersion && (this.moved.curved || !curved)) return;
    this.moved = { net: body.netVersion, curved };
    if (body.fault !== null || (tess !== null && tess.evaluate(body.points, curved) >= 0)) return;
    const { x, y, z } = this.group.position;
    for (let k = 0; k < body.points.length; k += 3) {
      this.netPoints[k] = body.points[k] - x;
      this.netPoints[k + 1] = body.points[k + 1] - y;
      this.netPoints[k + 2] = body.points[k + 2] - z;
    }
    for (const name of ["position", "normal"]) {
      const attribute = this.geometry.getAttribute(name);
      if (attribute !== undefined) attribute.needsUpdate = true;
    }
    for (const part of this.net.children) (part as LineSegments).geometry.getAttribute("position").needsUpdate = true;
  }

  /** Brings the surface to the body's net and computes what its colours show. `other` is the body to compare with. */
  update(what: ColourBy, other: BodyView | null): void {
    this.move(what);
    // Compared is what both are now, whichever of them is brought up to date first.
    if (what === "difference") other?.move(what);
    const otherNet = what === "difference" && other !== null ? other.body.netVersion : -1;
    const { measured } = this;
    const { inside } = this.body;
    if (measured.net === this.body.netVersion && measured.what === what && measured.other === otherNet && measured.inside === inside) return;
    if (measured.inside !== inside) this.young = null;
    this.measured = { net: this.body.netVersion, what, other: otherNet, inside };
    if (this.tessellation === null || this.body.fault !== null) return;
    this.measure(what, this.tessellation, other);
    this.painted = "";
  }

  /** What colours show, at every vertex. */
  private measure(what: ColourBy, tess: Triangles, other: BodyView | null): void {
    const { values, restPositions: rest, restNormals: normals } = this;
    const p = tess.positions;
    const compared = other?.tessellation?.positions;
    const young = what === "stiffness" ? this.youngNow() : null;
    let [least, most] = [Infinity, -Infinity];
    for (let k = 0; k < values.length; k++) {
      const at = 3 * k;
      const from = what === "difference" && compared?.length === p.length ? compared : rest;
      const [dx, dy, dz] = [p[at] - from[at], p[at + 1] - from[at + 1], p[at + 2] - from[at + 2]];
      let value = 0;
      if (what === "displacement" || what === "difference") value = Math.sqrt(dx * dx + dy * dy + dz * dz);
      else if (what === "indentation") {
        value = Math.max(0, this.inwards * (dx * normals[at] + dy * normals[at + 1] + dz * normals[at + 2]));
      } else if (what === "curvature") value = this.inwards * tess.curvature[k];
      else if (what === "stiffness") value = young?.[k] ?? 0;
      values[k] = value;
      if (value < least) least = value;
      if (value > most) most = value;
    }
    // The few vertices beside a pole have curvatures without bound: what most of the surface has makes the scale.
    if (what === "curvature") {
      const sorted = Float32Array.from(values).sort();
      least = sorted[Math.floor(0.02 * sorted.length)];
      most = sorted[Math.floor(0.98 * (sorted.length - 1))];
    }
    this.extent = values.length > 0 ? [least, most] : [0, 0];
  }

  /** Of the material at each vertex, Pa; that does not change with the net. */
  private youngNow(): Float32Array | null {
    const { inside } = this.body;
    if (inside === null) return null;
    const { x, y, z } = this.group.position;
    this.young ??= youngAt(inside, this.restPositions, [x, y, z]);
    return this.young;
  }

  paint(scale: Scale | null, what: ColourBy): void {
    const key = scale === null ? what : `${what} ${scale.map} ${scale.from} ${scale.to}`;
    if (key === this.painted) return;
    this.painted = key;
    if (scale === null) {
      const colour = new Color(OWN[what === "body" ? this.number % OWN.length : 0]);
      for (let k = 0; k < this.colours.length; k += 3) this.colours.set([colour.r, colour.g, colour.b], k);
    } else {
      paint(this.values, scale.from, scale.to, scale.map as MapName, this.colours);
    }
    const attribute = this.geometry.getAttribute("color");
    if (attribute !== undefined) attribute.needsUpdate = true;
  }

  dispose(): void {
    this.lattice?.dispose();
    this.geometry.dispose();
    this.surface.material.dispose();
    this.lines.geometry.dispose();
    this.lines.material.dispose();
    for (const part of this.net.children as (LineSegments | Points)[]) {
      part.geometry.dispose();
      (part.material as LineBasicMaterial).dispose();
    }
    this.group.removeFromParent();
  }
}

/** Six times the volume between the triangles and the origin of the tessellation. */
function signedVolume({ positions: p, indices }: Triangles): number {
  let sum = 0;
  for (let k = 0; k < indices.length; k += 3) {
    const [a, b, c] = [3 * indices[k], 3 * indices[k + 1], 3 * indices[k + 2]];
    sum += p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1])
      + p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2])
      + p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
  }
  return sum;
}
