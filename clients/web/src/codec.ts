/**
 * postcard: the types a message is made of, read and written. https://postcard.jamesmunns.com/wire-format
 *
 * `u64` is always a bigint, smaller numbers are plain ones. Lists of numbers and of points are flat `Float64Array`s. A
 * count is believed only when the bytes left can hold that many items, so hostile bytes cost no memory.
 */

import { DecodeError, EncodeError } from "./errors";

/** Bytes and the place in them. */
export class Reader {
  readonly view: DataView;
  at = 0;

  constructor(readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  /** Bytes not yet read. */
  left(): number {
    return this.bytes.length - this.at;
  }

  /** Moves on by `count` bytes; returns where they begin. */
  skip(count: number): number {
    const start = this.at;
    if (count > this.left()) {
      const all = this.bytes.length;
      throw new DecodeError("truncated", `${all} bytes end where ${count} more were to begin at ${start}`);
    }
    this.at = start + count;
    return start;
  }

  byte(): number {
    return this.view.getUint8(this.skip(1));
  }

  f64(): number {
    return this.view.getFloat64(this.skip(8), true);
  }

  /** A bool, or whether an optional value is there. */
  flag(): boolean {
    const byte = this.byte();
    if (byte > 1) throw new DecodeError("malformed", `${byte} is neither 0 nor 1`);
    return byte === 1;
  }

  /** An unsigned number of at most `bits` bits, seven a byte, low ones first. */
  varint(bits: number): bigint {
    let value = 0n;
    for (let shift = 0; shift < bits; shift += 7) {
      const byte = this.byte();
      value |= BigInt(byte & 0x7f) << BigInt(shift);
      if (byte < 0x80) {
        if (value >> BigInt(bits) !== 0n) break;
        return value;
      }
    }
    throw new DecodeError("malformed", `a number has more than ${bits} bits`);
  }

  /** How many items follow, each of at least `itemBytes`. */
  count(itemBytes: number): number {
    const count = this.varint(64);
    if (count * BigInt(itemBytes) > BigInt(this.left())) {
      throw new DecodeError("truncated", `${count} items cannot be in the ${this.left()} bytes left`);
    }
    return Number(count);
  }
}

/** Grows as it is written. */
export class Writer {
  private buffer = new Uint8Array(256);
  private view = new DataView(this.buffer.buffer);
  private length = 0;

  private room(count: number): number {
    const start = this.length;
    this.length += count;
    if (this.length > this.buffer.length) {
      const grown = new Uint8Array(Math.max(2 * this.buffer.length, this.length));
      grown.set(this.buffer);
      this.buffer = grown;
      this.view = new DataView(grown.buffer);
    }
    return start;
  }

  // Room first, then the view: making room may replace it.
  byte(value: number): void {
    const at = this.room(1);
    this.view.setUint8(at, value);
  }

  f64(value: number): void {
    if (typeof value !== "number") throw new EncodeError(`${show(value)} is not a number`);
    const at = this.room(8);
    this.view.setFloat64(at, value, true);
  }

  raw(bytes: Uint8Array): void {
    const at = this.room(bytes.length);
    this.buffer.set(bytes, at);
  }

  varint(value: number | bigint): void {
    let rest = BigInt(value);
    while (rest >= 0x80n) {
      this.byte(Number(rest & 0x7fn) | 0x80);
      rest >>= 7n;
    }
    this.byte(Number(rest));
  }

  finish(): Uint8Array {
    return this.buffer.slice(0, this.length);
  }
}

/** A value in the words of an error. */
export function show(value: unknown): string {
  return String(value).slice(0, 80);
}

/** A type on the wire. */
export interface Wire<T> {
  /** Fewest bytes that a value has. */
  readonly minBytes: number;
  read(reader: Reader): T;
  write(writer: Writer, value: T): void;
  /** The value as JSON has it; `undefined` for a struct without fields. */
  json(value: T): unknown;
}

/** The value of a wire type. */
export type Value<W> = W extends Wire<infer T> ? T : never;

function whole(bits: 8 | 16 | 32): Wire<number> {
  return {
    minBytes: 1,
    read: (reader) => (bits === 8 ? reader.byte() : Number(reader.varint(bits))),
    write(writer, value) {
      if (!Number.isInteger(value) || value < 0 || value >= 2 ** bits) {
        throw new EncodeError(`${show(value)} is not a whole number of ${bits} bits`);
      }
      if (bits === 8) writer.byte(value);
      else writer.varint(value);
    },
    json: (value) => value,
  };
}

/** One plain byte. */
export const u8 = whole(8);
export const u16 = whole(16);
export const u32 = whole(32);

/** Always a bigint. */
export const u64: Wire<bigint> = {
  minBytes: 1,
  read: (reader) => reader.varint(64),
  write(writer, value) {
    if (typeof value !== "bigint" || value < 0n || value >> 64n !== 0n) {
      throw new EncodeError(`${show(value)} is not a bigint of 64 bits`);
    }
    writer.varint(value);
  },
  // JSON's numbers are doubles.
  json: (value) => (value <= BigInt(Number.MAX_SAFE_INTEGER) ? Number(value) : String(value)),
};

const finite = (value: number): number | null => (Number.isFinite(value) ? value : null);

export const f64: Wire<number> = {
  minBytes: 8,
  read: (reader) => reader.f64(),
  write: (writer, value) => writer.f64(value),
  json: finite,
};

export const bool: Wire<boolean> = {
  minBytes: 1,
  read: (reader) => reader.flag(),
  write(writer, value) {
    if (typeof value !== "boolean") throw new EncodeError(`${show(value)} is not a boolean`);
    writer.byte(value ? 1 : 0);
  },
  json: (value) => value,
};

const utf8 = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });

export const text: Wire<string> = {
  minBytes: 1,
  read(reader) {
    const count = reader.count(1);
    const start = reader.skip(count);
    try {
      return utf8.decode(reader.bytes.subarray(start, start + count));
    } catch {
      throw new DecodeError("malformed", `text of ${count} bytes is not UTF-8`);
    }
  },
  write(writer, value) {
    // A surrogate without its other half has no UTF-8; TextEncoder would put another sign in its place.
    if (typeof value !== "string" || /\p{Surrogate}/u.test(value)) throw new EncodeError(`${show(value)} is not text`);
    const bytes = new TextEncoder().encode(value);
    writer.varint(bytes.length);
    writer.raw(bytes);
  },
  json: (value) => value,
};

/** A known count of plain bytes. */
export function octets(count: number): Wire<Uint8Array> {
  return {
    minBytes: count,
    read(reader) {
      const start = reader.skip(count);
      return reader.bytes.slice(start, start + count);
    },
    write(writer, value) {
      if (!(value instanceof Uint8Array) || value.length !== count) throw new EncodeError(`not ${count} bytes`);
      writer.raw(value);
    },
    json: (value) => [...value],
  };
}

type Tuple<T, N extends number, R extends readonly T[] = []> = R["length"] extends N
  ? R
  : Tuple<T, N, readonly [...R, T]>;

/** A known count of items. */
export function array<T, N extends number>(item: Wire<T>, count: N): Wire<Tuple<T, N>> {
  return {
    minBytes: item.minBytes * count,
    read: (reader) => Array.from({ length: count }, () => item.read(reader)) as unknown as Tuple<T, N>,
    write(writer, value) {
      if (!Array.isArray(value) || value.length !== count) {
        throw new EncodeError(`${show(value)} has not ${count} items`);
      }
      for (const part of value as readonly T[]) item.write(writer, part);
    },
    json: (value) => (value as readonly T[]).map((part) => item.json(part)),
  };
}

/** A count, then the items. */
export function list<T>(item: Wire<T>): Wire<readonly T[]> {
  return {
    minBytes: 1,
    read(reader) {
      const count = reader.count(item.minBytes);
      return Array.from({ length: count }, () => item.read(reader));
    },
    write(writer, value) {
      if (!Array.isArray(value)) throw new EncodeError(`${show(value)} is not an array`);
      writer.varint(value.length);
      for (const part of value as readonly T[]) item.write(writer, part);
    },
    json: (value) => value.map((part) => item.json(part)),
  };
}

/** A count, then `width` numbers for each item, all in one flat array. */
function flat(width: number, jsonItem: (values: Float64Array) => unknown): Wire<Float64Array> {
  return {
    minBytes: 1,
    read(reader) {
      const values = new Float64Array(width * reader.count(8 * width));
      for (let k = 0; k < values.length; k++) values[k] = reader.f64();
      return values;
    },
    write(writer, value) {
      if (!(value instanceof Float64Array) || value.length % width !== 0) {
        throw new EncodeError(`${show(value)} is not a Float64Array of ${width} numbers an item`);
      }
      writer.varint(value.length / width);
      for (const number of value) writer.f64(number);
    },
    json(value) {
      const items = [];
      for (let k = 0; k < value.length; k += width) items.push(jsonItem(value.subarray(k, k + width)));
      return items;
    },
  };
}

/** List of numbers. */
export const numbers = flat(1, ([value]) => finite(value ?? NaN));
/** List of points: x y z of the first, then of the next. */
export const points = flat(3, (values) => [...values].map(finite));

/** 0, or 1 and the value. */
export function optional<T>(item: Wire<T>): Wire<T | null> {
  return {
    minBytes: 1,
    read: (reader) => (reader.flag() ? item.read(reader) : null),
    write(writer, value) {
      writer.byte(value === null ? 0 : 1);
      if (value !== null) item.write(writer, value);
    },
    json: (value) => (value === null ? null : item.json(value)),
  };
}

/** A struct with these fields. */
export type StructOf<F> = { readonly [K in keyof F]: Value<F[K]> };

/** Fields in order, nothing between. */
export function struct<const F extends object>(fields: F): Wire<StructOf<F>> {
  const entries = Object.entries(fields) as [string, Wire<unknown>][];
  return {
    minBytes: entries.reduce((sum, [, wire]) => sum + wire.minBytes, 0),
    read(reader) {
      const value: Record<string, unknown> = {};
      for (const [name, wire] of entries) {
        try {
          value[name] = wire.read(reader);
        } catch (error) {
          if (error instanceof DecodeError) error.inside(name);
          throw error;
        }
      }
      return value as StructOf<F>;
    },
    write(writer, value) {
      if (typeof value !== "object" || value === null) throw new EncodeError(`${show(value)} is not an object`);
      for (const [name, wire] of entries) {
        try {
          wire.write(writer, (value as Record<string, unknown>)[name]);
        } catch (error) {
          throw error instanceof EncodeError ? new EncodeError(`${name}: ${error.message}`) : error;
        }
      }
    },
    json(value) {
      if (entries.length === 0) return undefined;
      const given = value as Record<string, unknown>;
      return Object.fromEntries(entries.map(([name, wire]) => [name, wire.json(given[name])]));
    },
  };
}

function numbered<T>(names: readonly T[], number: bigint): T {
  const name = number < BigInt(names.length) ? names[Number(number)] : undefined;
  if (name === undefined) {
    throw new DecodeError("unknown-case", `no case has number ${number}, the last is ${names.length - 1}`);
  }
  return name;
}

/** A choice without fields: the number of the case. */
export function choice<const N extends string>(...names: N[]): Wire<N> {
  return {
    minBytes: 1,
    read: (reader) => numbered(names, reader.varint(32)),
    write(writer, value) {
      if (!names.includes(value)) throw new EncodeError(`${show(value)} is none of ${names.join(", ")}`);
      writer.varint(names.indexOf(value));
    },
    json: (value) => value,
  };
}

/** One of the cases, told by `type`. */
export type CaseOf<C> = { [K in keyof C]: { readonly type: K } & Value<C[K]> }[keyof C];

/** A choice with fields: the number of the case, then its fields. */
export function cases<const C extends Readonly<Record<string, Wire<object>>>>(table: C): Wire<CaseOf<C>> {
  const names = Object.keys(table);
  const wireOf = (type: unknown): Wire<unknown> => {
    const wire = names.includes(type as string) ? table[type as string] : undefined;
    if (wire === undefined) throw new EncodeError(`${show(type)} is no case of this choice`);
    return wire as Wire<unknown>;
  };
  return {
    minBytes: 1,
    read(reader) {
      const type = numbered(names, reader.varint(32));
      return { type, ...(wireOf(type).read(reader) as object) } as unknown as CaseOf<C>;
    },
    write(writer, value) {
      const type = (value as { type?: unknown } | null | undefined)?.type;
      const wire = wireOf(type);
      writer.varint(names.indexOf(type as string));
      wire.write(writer, value);
    },
    json(value) {
      const type = (value as { type: string }).type;
      const fields = wireOf(type).json(value);
      return fields === undefined ? type : { [type]: fields };
    },
  };
}
