/** Frames of the page's socket: a key below `palpate/{instance}/` as postcard text, then the payload as on the bus. */

import { Reader, Writer, text, u64 } from "../../codec";

/** A frame taken apart. Throws a `DecodeError` if it is none. */
export function openFrame(bytes: Uint8Array): { key: string; payload: Uint8Array } {
  const reader = new Reader(bytes);
  const key = text.read(reader);
  return { key, payload: bytes.subarray(reader.at) };
}

export function frame(key: string, payload: Uint8Array = new Uint8Array()): Uint8Array<ArrayBuffer> {
  const writer = new Writer();
  text.write(writer, key);
  writer.raw(payload);
  return writer.finish() as Uint8Array<ArrayBuffer>;
}

/** Payload that is a piece of text. */
export function textOf(payload: Uint8Array): string {
  return text.read(new Reader(payload));
}

export function ofText(value: string): Uint8Array {
  const writer = new Writer();
  text.write(writer, value);
  return writer.finish();
}

/** A question or an answer: its number and JSON. */
export function ofCall(id: number, json: string): Uint8Array {
  const writer = new Writer();
  u64.write(writer, BigInt(id));
  text.write(writer, json);
  return writer.finish();
}

export function callOf(payload: Uint8Array): { id: number; json: string } {
  const reader = new Reader(payload);
  return { id: Number(u64.read(reader)), json: text.read(reader) };
}
