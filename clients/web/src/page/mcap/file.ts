/**
 * MCAP: the container of recordings. https://mcap.dev/spec
 *
 * A finished file is opened through the index at its end, whatever its length. One that was cut off (a killed daemon) is
 * gone through once, record by record; what is whole of it is used. `@mcap/core` has a reader for each of the two: the
 * indexed one refuses a file that was cut off, and the one for streams gives no places to go back to.
 */

import { decompress } from "fzstd";
import { Blocks, type ByteSource } from "./source";

const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
const FOOTER_BYTES = 1 + 8 + 20 + 8;
/** Larger ones are not ours. */
const MAX_CHUNK = 64 << 20;
const MAX_SUMMARY = 512 << 20;

const OP = { footer: 2, channel: 4, message: 5, chunk: 6, chunkIndex: 8, attachment: 9, attachmentIndex: 10, metadata: 12, metadataIndex: 13, dataEnd: 15 } as const;

export interface ChunkPlace {
  /** Log times of its first and last message, ns. */
  readonly startNs: number;
  readonly endNs: number;
  readonly offset: number;
  readonly length: number;
  /** Channels with messages in it; `null` where the file has no index. */
  readonly channels: ReadonlySet<number> | null;
}

export interface RawMessage {
  readonly channel: number;
  readonly timeNs: number;
  readonly data: Uint8Array;
}

export interface Attachment {
  readonly name: string;
  readonly data: Uint8Array;
}

/** Takes little-endian fields off a record. */
class Fields {
  private readonly view: DataView;
  at = 0;

  constructor(readonly bytes: Uint8Array) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  get left(): number {
    return this.bytes.length - this.at;
  }

  u8 = (): number => this.view.getUint8(this.step(1));
  u16 = (): number => this.view.getUint16(this.step(2), true);
  u32 = (): number => this.view.getUint32(this.step(4), true);
  /** As a number: sizes, and times up to a hundred days, are far below 2^53. */
  u64 = (): number => Number(this.view.getBigUint64(this.step(8), true));
  text = (): string => new TextDecoder().decode(this.take(this.u32()));

  take(length: number): Uint8Array {
    const start = this.step(length);
    return this.bytes.subarray(start, start + length);
  }

  private step(length: number): number {
    const start = this.at;
    if (!(length >= 0) || start + length > this.bytes.length) throw new Error("a record ends too early");
    this.at += length;
    return start;
  }
}

export class McapFile {
  readonly channels = new Map<number, string>();
  readonly metadata = new Map<string, ReadonlyMap<string, string>>();
  readonly attachments = new Map<string, { offset: number; length: number }>();
  chunks: ChunkPlace[] = [];
  /** True for a file without a usable index. */
  cutOff = false;
  /** Chunks whose bytes could not be read. */
  damaged = 0;

  private constructor(readonly source: ByteSource) {}

  /** Throws if this is no MCAP file, or holds nothing. */
  static async open(source: ByteSource): Promise<McapFile> {
    const file = new McapFile(source);
    const head = await source.read(0, MAGIC.length);
    if (!MAGIC.every((byte, k) => head[k] === byte)) throw new Error("this is not an MCAP recording");
    try {
      await file.readIndex();
    } catch {
      file.cutOff = true;
      file.chunks = [];
      await file.scan();
    }
    file.chunks.sort((a, b) => a.startNs - b.startNs || a.offset - b.offset);
    if (file.chunks.length === 0) throw new Error("this recording holds no whole chunk");
    return file;
  }

  private async readIndex(): Promise<void> {
    const { source } = this;
    const tail = new Fields(await source.read(source.size - FOOTER_BYTES, FOOTER_BYTES));
    if (tail.u8() !== OP.footer || tail.u64() !== 20) throw new Error("no footer");
    const summary = tail.u64();
    const length = source.size - FOOTER_BYTES - summary;
    if (summary === 0 || length <= 0 || length > MAX_SUMMARY) throw new Error("no summary");
    const all = new Fields(await source.read(summary, length));
    const metadata: { offset: number; length: number }[] = [];
    while (all.left >= 9) {
      const [op, record] = [all.u8(), new Fields(all.take(all.u64()))];
      if (op === OP.channel) this.addChannel(record);
      else if (op === OP.chunkIndex) this.addChunkIndex(record);
      else if (op === OP.attachmentIndex) {
        const [offset, size] = [record.u64(), record.u64()];
        record.take(24);
        this.attachments.set(record.text(), { offset, length: size });
      } else if (op === OP.metadataIndex) metadata.push({ offset: record.u64(), length: record.u64() });
    }
    if (this.chunks.length === 0) throw new Error("no chunks in the index");
    for (const { offset, length: size } of metadata) {
      this.addMetadata(new Fields((await source.read(offset, size)).subarray(9)));
    }
  }

  private addChannel(record: Fields): void {
    const id = record.u16();
    record.take(2);
    this.channels.set(id, record.text());
  }

  private addChunkIndex(record: Fields): void {
    const [startNs, endNs, offset, length] = [record.u64(), record.u64(), record.u64(), record.u64()];
    const map = new Fields(record.take(record.u32()));
    const channels = new Set<number>();
    while (map.left >= 10) {
      channels.add(map.u16());
      map.take(8);
    }
    if (length <= MAX_CHUNK && offset + length <= this.source.size) this.chunks.push({ startNs, endNs, offset, length, channels });
  }

  private addMetadata(record: Fields): void {
    const name = record.text();
    const map = new Fields(record.take(record.u32()));
    const values = new Map<string, string>();
    while (map.left >= 8) values.set(map.text(), map.text());
    this.metadata.set(name, values);
  }

  private async scan(): Promise<void> {
    const blocks = new Blocks(this.source);
    let at = MAGIC.length;
    while (at + 9 <= this.source.size) {
      const head = new Fields(await blocks.read(at, 9));
      const [op, length] = [head.u8(), head.u64()];
      if (op === 0 || op > 127 || at + 9 + length > this.source.size || op === OP.dataEnd) return;
      if (op === OP.chunk && length <= MAX_CHUNK) {
        const fields = new Fields(await blocks.read(at + 9, 16));
        this.chunks.push({ startNs: fields.u64(), endNs: fields.u64(), offset: at, length: length + 9, channels: null });
      } else if (op === OP.channel) this.addChannel(new Fields(await blocks.read(at + 9, length)));
      else if (op === OP.metadata) this.addMetadata(new Fields(await blocks.read(at + 9, length)));
      else if (op === OP.attachment) {
        const fields = new Fields(await blocks.read(at + 9, Math.min(length, 4096)));
        fields.take(16);
        this.attachments.set(fields.text(), { offset: at, length: length + 9 });
      }
      at += 9 + length;
    }
  }

  async attachment(name: string): Promise<Uint8Array | null> {
    const place = this.attachments.get(name);
    if (place === undefined) return null;
    const fields = new Fields((await this.source.read(place.offset, place.length)).subarray(9));
    fields.take(16);
    fields.text();
    fields.text();
    return fields.take(fields.u64());
  }

  /** Messages of a chunk, in file order; none of one that is damaged. */
  async messages(chunk: ChunkPlace): Promise<RawMessage[]> {
    try {
      const fields = new Fields((await this.source.read(chunk.offset, chunk.length)).subarray(9));
      fields.take(16);
      const size = fields.u64();
      if (size > MAX_CHUNK) throw new Error("a chunk is too large");
      fields.take(4);
      const compression = fields.text();
      const stored = fields.take(fields.u64());
      if (compression !== "zstd" && compression !== "") throw new Error(`compression ${compression} is not known`);
      const records = new Fields(compression === "zstd" ? decompress(stored, new Uint8Array(size)) : stored);
      const messages: RawMessage[] = [];
      while (records.left >= 9) {
        const [op, record] = [records.u8(), new Fields(records.take(records.u64()))];
        if (op === OP.channel) this.addChannel(record);
        if (op !== OP.message) continue;
        const channel = record.u16();
        record.take(4);
        const timeNs = record.u64();
        record.take(8);
        messages.push({ channel, timeNs, data: record.take(record.left) });
      }
      return messages;
    } catch {
      this.damaged += 1;
      return [];
    }
  }
}
