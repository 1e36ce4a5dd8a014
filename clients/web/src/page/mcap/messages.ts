/** The Protobuf messages of a recording that the page shows: `palpate.v1`, field by field. */

import type { Vec3, Quat } from "../geometry";

/** Takes fields off a Protobuf message. */
class Proto {
  private readonly view: DataView;
  private at = 0;

  constructor(private readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  /** Number of the next field, or 0 at the end. */
  next(): { field: number; wire: number } {
    if (this.at >= this.bytes.length) return { field: 0, wire: 0 };
    const tag = this.varint();
    return { field: Math.floor(tag / 8), wire: tag % 8 };
  }

  /** Numbers above 2^53 lose their low bits: none of these is shown. */
  varint(): number {
    let [value, scale] = [0, 1];
    for (let k = 0; k < 10; k++) {
      const byte = this.view.getUint8(this.at++);
      value += (byte & 0x7f) * scale;
      if (byte < 0x80) return value;
      scale *= 128;
    }
    throw new Error("a number is too long");
  }

  bytesField(): Uint8Array {
    const length = this.varint();
    const start = this.at;
    this.at += length;
    if (this.at > this.bytes.length) throw new Error("a field ends after its message");
    return this.bytes.subarray(start, this.at);
  }

  text = (): string => new TextDecoder().decode(this.bytesField());

  doubles(): Float64Array {
    const bytes = this.bytesField();
    return new Float64Array(bytes.slice().buffer);
  }

  varints(): number[] {
    const inside = new Proto(this.bytesField());
    const values: number[] = [];
    while (inside.at < inside.bytes.length) values.push(inside.varint());
    return values;
  }

  skip(wire: number): void {
    if (wire === 0) this.varint();
    else if (wire === 1) this.at += 8;
    else if (wire === 2) this.bytesField();
    else if (wire === 5) this.at += 4;
    else throw new Error(`a field of kind ${wire}`);
  }
}

export interface ToolRow {
  /** Pose of the device, where a new one took effect. */
  hand: { position: Vec3; orientation: Quat } | null;
  flags: number;
  contacts: number;
  /** force [3], torque [3], proxy [3], quaternion [4], contact force [3], contact torque [3], energy, dissipated, error (not in older files). */
  values: Float64Array;
  /** Index of the body; u, v, point [3], normal [3], depth, force [3]. */
  contact: { body: number; values: Float64Array } | null;
}

export interface TickRow {
  tick: number;
  tools: ToolRow[];
  fault: number;
  lateNs: number;
  skipped: number;
  stagesNs: number[];
  quality: number;
}

export interface NetRow {
  tick: number;
  body: string;
  countU: number;
  countV: number;
  degreeU: number;
  degreeV: number;
  points: Float64Array;
}

const NONE: Float64Array = new Float64Array();

function handOf(bytes: Uint8Array): ToolRow["hand"] {
  const proto = new Proto(bytes);
  let values = NONE;
  for (let { field, wire } = proto.next(); field !== 0; { field, wire } = proto.next()) {
    if (field === 3 && wire === 2) values = proto.doubles();
    else proto.skip(wire);
  }
  if (values.length < 7) return null;
  return { position: [values[0], values[1], values[2]], orientation: [values[3], values[4], values[5], values[6]] };
}

function contactOf(bytes: Uint8Array): ToolRow["contact"] {
  const proto = new Proto(bytes);
  const contact = { body: 0, values: NONE };
  for (let { field, wire } = proto.next(); field !== 0; { field, wire } = proto.next()) {
    if (field === 1) contact.body = proto.varint();
    else if (field === 2 && wire === 2) contact.values = proto.doubles();
    else proto.skip(wire);
  }
  return contact.values.length < 12 ? null : contact;
}

function toolOf(bytes: Uint8Array): ToolRow {
  const proto = new Proto(bytes);
  const tool: ToolRow = { hand: null, flags: 0, contacts: 0, values: NONE, contact: null };
  for (let { field, wire } = proto.next(); field !== 0; { field, wire } = proto.next()) {
    if (field === 1) tool.hand = handOf(proto.bytesField());
    else if (field === 5) tool.flags = proto.varint();
    else if (field === 6) tool.contacts = proto.varint();
    else if (field === 7 && wire === 2) tool.values = proto.doubles();
    else if (field === 8) tool.contact = contactOf(proto.bytesField());
    else proto.skip(wire);
  }
  return tool;
}

export function tickOf(bytes: Uint8Array): TickRow {
  const proto = new Proto(bytes);
  const row: TickRow = { tick: 0, tools: [], fault: 0, lateNs: 0, skipped: 0, stagesNs: [], quality: 0 };
  for (let { field, wire } = proto.next(); field !== 0; { field, wire } = proto.next()) {
    if (field === 1) row.tick = proto.varint();
    else if (field === 2) row.tools.push(toolOf(proto.bytesField()));
    else if (field === 5) row.fault = proto.varint();
    else if (field === 7) row.lateNs = proto.varint();
    else if (field === 8) row.skipped = proto.varint();
    else if (field === 9 && wire === 2) row.stagesNs = proto.varints();
    else if (field === 10) row.quality = proto.varint();
    else proto.skip(wire);
  }
  return row;
}

export function netOf(bytes: Uint8Array): NetRow {
  const proto = new Proto(bytes);
  const net: NetRow = { tick: 0, body: "", countU: 0, countV: 0, degreeU: 0, degreeV: 0, points: NONE };
  for (let { field, wire } = proto.next(); field !== 0; { field, wire } = proto.next()) {
    if (field === 1) net.tick = proto.varint();
    else if (field === 3) net.body = proto.text();
    else if (field === 4) net.degreeU = proto.varint();
    else if (field === 5) net.degreeV = proto.varint();
    else if (field === 6) net.countU = proto.varint();
    else if (field === 7) net.countV = proto.varint();
    else if (field === 8 && wire === 2) net.points = proto.doubles();
    else proto.skip(wire);
  }
  return net;
}

export function eventOf(bytes: Uint8Array): { tick: number; kind: string; detail: string } {
  const proto = new Proto(bytes);
  const event = { tick: 0, kind: "", detail: "" };
  for (let { field, wire } = proto.next(); field !== 0; { field, wire } = proto.next()) {
    if (field === 1) event.tick = proto.varint();
    else if (field === 2) event.kind = proto.text();
    else if (field === 3) event.detail = proto.text();
    else proto.skip(wire);
  }
  return event;
}
