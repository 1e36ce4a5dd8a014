/** Where the bytes of a recording are: in memory, in a file dropped on the page, or behind HTTP range requests. */

export interface ByteSource {
  readonly size: number;
  /** Bytes from `start`, at most `length`: fewer at the end. */
  read(start: number, length: number): Promise<Uint8Array>;
}

export class MemorySource implements ByteSource {
  constructor(private readonly bytes: Uint8Array) {}

  get size(): number {
    return this.bytes.length;
  }

  read(start: number, length: number): Promise<Uint8Array> {
    return Promise.resolve(this.bytes.subarray(start, start + length));
  }
}

export class BlobSource implements ByteSource {
  constructor(private readonly blob: Blob) {}

  get size(): number {
    return this.blob.size;
  }

  async read(start: number, length: number): Promise<Uint8Array> {
    return new Uint8Array(await this.blob.slice(start, start + length).arrayBuffer());
  }
}

class HttpSource implements ByteSource {
  constructor(private readonly url: string, readonly size: number) {}

  async read(start: number, length: number): Promise<Uint8Array> {
    const end = Math.min(start + length, this.size) - 1;
    if (end < start) return new Uint8Array();
    const answer = await fetch(this.url, { headers: { Range: `bytes=${start}-${end}` } });
    if (answer.status !== 206) throw new Error(`${this.url}: the server answered ${answer.status} to a range request`);
    return new Uint8Array(await answer.arrayBuffer());
  }
}

/** A recording at a URL. A server that knows no ranges gives the whole of it at once. */
export async function httpSource(url: string): Promise<ByteSource> {
  const answer = await fetch(url, { headers: { Range: "bytes=0-0" } });
  if (!answer.ok) throw new Error(`${url}: the server answered ${answer.status}`);
  const range = /\/(\d+)$/.exec(answer.headers.get("Content-Range") ?? "");
  if (answer.status === 206 && range !== null) {
    await answer.arrayBuffer();
    return new HttpSource(url, Number(range[1]));
  }
  return new MemorySource(new Uint8Array(await answer.arrayBuffer()));
}

/** Reads ahead in blocks, for going through a file from its beginning. */
export class Blocks implements ByteSource {
  private at = 0;
  private block = new Uint8Array();

  constructor(private readonly source: ByteSource, private readonly length = 1 << 20) {}

  get size(): number {
    return this.source.size;
  }

  async read(start: number, length: number): Promise<Uint8Array> {
    if (start < this.at || start + length > this.at + this.block.length) {
      if (length > this.length) return this.source.read(start, length);
      this.block = new Uint8Array(await this.source.read(start, this.length));
      this.at = start;
    }
    return this.block.subarray(start - this.at, start - this.at + length);
  }
}
