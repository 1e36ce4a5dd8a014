/** From messages to bytes and back. */

import { Reader, Writer, struct, type StructOf, type Value, type Wire } from "./codec";
import { DecodeError, EncodeError } from "./errors";

/** A message that has a name. */
export interface MessageType<T, N extends string = string> {
  /** Versioned name, for example `palpate.ToolPose.v1`. */
  readonly type: N;
  /** Key below `palpate/{instance}/`, with `{tool}` or `{body}` for an id. */
  readonly key: string;
  /** Most bytes that one has: more are refused before they are read. */
  readonly maxBytes: number;
  readonly wire: Wire<T>;
}

/** Value of a message. */
export type Of<M> = M extends MessageType<infer T> ? T : Value<M>;

/** A message of these fields. */
export function message<const F extends object, const N extends string>(
  type: N,
  key: string,
  fields: F,
  maxBytes = 16 << 20,
): MessageType<StructOf<F>, N> {
  return { type, key, maxBytes, wire: struct(fields) };
}

/** Key expression of a message: `palpate/default/tool/ball/pose`. `id` is that of its tool or body, `*` for all. */
export function keyOf(message: { readonly key: string }, id = "*", instance = "default"): string {
  return `palpate/${instance}/${message.key.replace(/\{\w+\}/, id)}`;
}

/** Schema of the Zenoh encoding `application/octet-stream` that goes with a message: `postcard;palpate.ToolPose.v1`. */
export function encodingSchema(message: { readonly type: string }): string {
  return `postcard;${message.type}`;
}

/**
 * Reads a message. `schema` is that of the sample's encoding; an empty one is not checked.
 *
 * Throws a {@link DecodeError}, and nothing else for any bytes.
 */
export function decode<T>(message: MessageType<T>, bytes: Uint8Array, schema = ""): T {
  try {
    if (schema !== "" && schema !== encodingSchema(message)) {
      throw new DecodeError("wrong-schema", `the encoding's schema is "${schema.slice(0, 128)}"`);
    }
    if (bytes.length > message.maxBytes) {
      throw new DecodeError("oversized", `${bytes.length} bytes are more than any has (${message.maxBytes})`);
    }
    const reader = new Reader(bytes);
    const value = message.wire.read(reader);
    if (reader.left() > 0) throw new DecodeError("trailing-bytes", `${reader.left()} bytes after its end`);
    return value;
  } catch (error) {
    throw error instanceof DecodeError ? error.of(message.type) : error;
  }
}

// Any of them: a message both reads and writes its value, so no narrower type holds all.
type AnyMessage = MessageType<any>;

/** A message with its name, so that a `switch` on `type` knows the value. */
export type Named<M> = M extends MessageType<infer T, infer N> ? { readonly type: N; readonly value: T } : never;

/** Reads one of `messages` by its name or by the schema of the sample's encoding. */
export function decodeNamed<M extends AnyMessage>(messages: readonly M[], schema: string, bytes: Uint8Array): Named<M> {
  const name = schema.startsWith("postcard;") ? schema.slice("postcard;".length) : schema;
  const message = messages.find((candidate) => candidate.type === name);
  if (message === undefined) throw new DecodeError("wrong-schema", `no message is called "${name.slice(0, 128)}"`);
  return { type: message.type, value: decode(message, bytes) } as Named<M>;
}

/** Bytes of a message. Throws an `EncodeError` for a value that its type cannot have. */
export function encode<T>(message: MessageType<T>, value: T): Uint8Array {
  const writer = new Writer();
  message.wire.write(writer, value);
  const bytes = writer.finish();
  if (bytes.length > message.maxBytes) {
    throw new EncodeError(`${bytes.length} bytes are more than any ${message.type} has (${message.maxBytes})`);
  }
  return bytes;
}

/** Plain values for `JSON.stringify`: bigints as numbers up to 2^53 and as text beyond, what is not finite as null. */
export function toJson<T>(message: MessageType<T>, value: T): unknown {
  return message.wire.json(value);
}
