/**
 * Control nets as a STEP file (AP214): a geometric set with one B-spline surface a body, as `palpate surface convert`
 * writes it. Coordinates in metres, to the last bit.
 */

import { extendedKnots, knotFault, partedAfter, type Direction } from "./surface/basis";
import type { Body, World } from "./world";

/** The shortest decimal that reads back as the same bits, with a point: `0.1`, `1.0`, `1.E-7`. */
export function real(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e16)) {
    const [mantissa, power] = value.toExponential().split("e");
    return `${mantissa}${mantissa.includes(".") ? "" : "."}E${power.replace("+", "")}`;
  }
  const text = Object.is(value, -0) ? "-0" : String(value);
  return text.includes(".") ? text : `${text}.0`;
}

/** Equal knots gathered. */
function runs(knots: ArrayLike<number>): { values: number[]; times: number[] } {
  const values: number[] = [];
  const times: number[] = [];
  for (let k = 0; k < knots.length; k++) {
    if (k > 0 && knots[k] === knots[k - 1]) times[times.length - 1] += 1;
    else {
      values.push(knots[k]);
      times.push(1);
    }
  }
  return { values, times };
}

const list = (parts: readonly string[]): string => `(${parts.join(",")})`;
const logical = (flag: boolean): string => (flag ? ".T." : ".F.");
const text = (value: string): string => `'${value.replace(/[^\x20-\x7e]/g, "_").replace(/'/g, "''").replace(/\\/g, "\\\\")}'`;

/** Why a body cannot be written; `null` if it can. */
export function stepFault(body: Body): string | null {
  if (body.fault !== null) return body.fault;
  if (body.surface.u.degree === 0) return `${body.id} is a part: its STEP file is the one that the scene names`;
  const fault = knotFault(body.surface.u) ?? knotFault(body.surface.v);
  if (fault !== null) return `${body.id}: ${fault}`;
  const parted = [body.surface.u, body.surface.v].some((direction) => partedAfter(direction).size > 0);
  return parted ? `${body.id} is in several pieces, which STEP does not have` : null;
}

/** Rows of the file in one direction: `degree` points of a periodic one are repeated. */
const rowsOf = ({ degree, periodic, count }: Direction): number => (periodic ? count + degree : count);

class File {
  lines: string[] = [];
  /** Of the first instance that is not yet taken. */
  next: number;

  constructor(first: number) {
    this.next = first;
  }

  surface(at: number, body: Body): void {
    const { u, v, weights } = body.surface;
    const [rows, columns] = [rowsOf(u), rowsOf(v)];
    const control = (i: number, j: number) => (i % u.count) * v.count + (j % v.count);
    const same = (a: number, b: number) => [0, 1, 2].every((c) => body.points[3 * a + c] === body.points[3 * b + c]);
    const closed = [
      u.periodic || Array.from({ length: columns }, (_, j) => same(control(0, j), control(rows - 1, j))).every(Boolean),
      v.periodic || Array.from({ length: rows }, (_, i) => same(control(i, 0), control(i, columns - 1))).every(Boolean),
    ];
    const first = this.next;
    const grid = (cell: (k: number) => string): string =>
      list(Array.from({ length: rows }, (_, i) => `\n${list(Array.from({ length: columns }, (_, j) => cell(i * columns + j)))}`));
    const [ku, kv] = [runs(extendedKnots(u)), runs(extendedKnots(v))];
    const common = `${u.degree},${v.degree},${grid((k) => `#${first + k}`)},.UNSPECIFIED.,${logical(closed[0])},${logical(closed[1])},.U.`;
    const knots = `${list(ku.times.map(String))},${list(kv.times.map(String))},\n${list(ku.values.map(real))},\n${list(kv.values.map(real))},.UNSPECIFIED.`;
    if (weights === null) this.lines.push(`#${at}=B_SPLINE_SURFACE_WITH_KNOTS(${text(body.id)},${common},\n${knots});`);
    else {
      const values = grid((k) => real(weights[control(Math.floor(k / columns), k % columns)]));
      // Parts of a complex instance stand in alphabetical order.
      this.lines.push(`#${at}=(BOUNDED_SURFACE()B_SPLINE_SURFACE(${common})\nB_SPLINE_SURFACE_WITH_KNOTS(${knots})\n`
        + `GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(${values})\nREPRESENTATION_ITEM(${text(body.id)})SURFACE());`);
    }
    for (let i = 0; i < rows; i++) {
      for (let j = 0; j < columns; j++) {
        const at = 3 * control(i, j);
        const [x, y, z] = [0, 1, 2].map((c) => real(body.points[at + c]));
        this.lines.push(`#${this.next++}=CARTESIAN_POINT('',(${x},${y},${z}));`);
      }
    }
  }
}

/** The bodies that can be written, as they are now; `null` if there is none. */
export function stepOf(world: World): string | null {
  const bodies = world.bodies.filter((body) => stepFault(body) === null);
  if (bodies.length === 0) return null;
  const surfaces = bodies.map((_, k) => 22 + k);
  const file = new File(22 + bodies.length);
  bodies.forEach((body, k) => file.surface(surfaces[k], body));
  const name = text(world.name);
  return [
    "ISO-10303-21;", "HEADER;", "FILE_DESCRIPTION(('B-spline surfaces'),'2;1');",
    `FILE_NAME(${text(`${world.name}, tick ${world.tick}`)},'1970-01-01T00:00:00',(''),(''),'palpate','palpate','');`,
    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));", "ENDSEC;", "DATA;",
    "#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');",
    "#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);",
    "#3=PRODUCT_CONTEXT('',#1,'mechanical');",
    `#4=PRODUCT(${name},${name},'',(#3));`,
    "#5=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#4));",
    "#6=PRODUCT_DEFINITION_FORMATION('','',#4);",
    "#7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');",
    "#8=PRODUCT_DEFINITION('design','',#6,#7);",
    "#9=PRODUCT_DEFINITION_SHAPE('','',#8);",
    "#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));",
    "#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));",
    "#12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());",
    "#13=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-9),#10,'distance_accuracy_value','');",
    "#14=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#13))GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('',''));",
    "#15=CARTESIAN_POINT('',(0.,0.,0.));",
    "#16=DIRECTION('',(0.,0.,1.));",
    "#17=DIRECTION('',(1.,0.,0.));",
    "#18=AXIS2_PLACEMENT_3D('',#15,#16,#17);",
    "#19=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#18,#20),#14);",
    `#20=GEOMETRIC_SET('',${list(surfaces.map((at) => `#${at}`))});`,
    "#21=SHAPE_DEFINITION_REPRESENTATION(#9,#19);",
    ...file.lines,
    "ENDSEC;", "END-ISO-10303-21;", "",
  ].join("\n");
}
