/** A recording: ticks, nets and events at any tick, read through the index, chunk by chunk. */

import { SceneSnapshot, decode } from "../../index";
import { isFiniteVec } from "../geometry";
import { McapFile, type ChunkPlace } from "./file";
import { eventOf, netOf, tickOf, type NetRow, type TickRow, type ToolRow } from "./messages";
import type { ByteSource } from "./source";

export interface EventRow {
  readonly tick: number;
  readonly kind: string;
  readonly detail: string;
}

/** What one chunk holds, decoded. */
export interface Chunk {
  readonly ticks: TickRow[];
  readonly nets: NetRow[];
  readonly events: EventRow[];
}

/** State after a tick. */
export interface Moment {
  readonly tick: TickRow | null;
  readonly nets: ReadonlyMap<string, NetRow>;
  /** The newest pose of each tool's device. */
  readonly hands: readonly ToolRow["hand"][];
}

const KEPT_CHUNKS = 48;
/** Nets come after each keyframe, once a second or so: farther back there is none to find. */
const MOST_BACK = 64;

/** Largest index at which `test` still holds, if it holds up to some index and not after; -1 if never. */
export function lastWhere(count: number, test: (index: number) => boolean): number {
  let [low, high] = [0, count];
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (test(middle)) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export class Recording {
  readonly dt: number;
  readonly toolIds: readonly string[];
  readonly bodyIds: readonly string[];
  readonly firstTick: number;
  readonly lastTick: number;
  /** How the recording ended, in words, where it did not end as it should. */
  readonly warnings: string[] = [];
  private search: Promise<void> | null = null;
  private readonly cache = new Map<number, Promise<Chunk>>();

  private constructor(readonly name: string, readonly file: McapFile, readonly snapshot: SceneSnapshot | null, first: number, last: number) {
    const run = file.metadata.get("palpate.run");
    this.dt = Number(run?.get("dt_ns") ?? 1e6) * 1e-9 || 1e-3;
    const list = (name: string) => (run?.get(name) ?? "").split(",").map((part) => part.trim()).filter((part) => part !== "");
    this.toolIds = snapshot?.tools.map((tool) => tool.id) ?? list("tools");
    this.bodyIds = snapshot?.bodies.map((body) => body.id) ?? list("bodies");
    this.firstTick = first;
    this.lastTick = last;
  }

  /** Only every so-manyth tick is in it: a page made for sending is thinned. */
  get every(): number {
    return Number(this.file.metadata.get("palpate.run")?.get("thinned_every") ?? 1) || 1;
  }

  /** The build that made it, for people. */
  get build(): string {
    return this.file.metadata.get("palpate.run")?.get("build") ?? "an unknown build";
  }

  get scene(): string {
    return this.file.metadata.get("palpate.run")?.get("scene") ?? this.snapshot?.scene_name ?? this.name;
  }

  /** `scene`: the snapshot's bytes from elsewhere, used if the file holds none. Throws if the file cannot be shown. */
  static async open(name: string, source: ByteSource, scene: () => Promise<Uint8Array | null>): Promise<Recording> {
    const file = await McapFile.open(source);
    const warnings: string[] = [];
    let snapshot: SceneSnapshot | null = null;
    for (const bytes of [() => file.attachment("scene.snapshot"), scene]) {
      if (snapshot !== null) break;
      try {
        const found = await bytes();
        if (found !== null && found.length > 0) snapshot = decode(SceneSnapshot, found);
      } catch (error) {
        warnings.push(`its scene cannot be read (${error instanceof Error ? error.message : String(error)})`);
      }
    }
    const dtNs = Number(file.metadata.get("palpate.run")?.get("dt_ns") ?? 1e6) || 1e6;
    const end = file.metadata.get("palpate.end");
    const ends = file.chunks.reduce((most, chunk) => Math.max(most, chunk.endNs), 0);
    const first = Number(end?.get("first_tick") ?? Math.max(1, Math.round(file.chunks[0].startNs / dtNs)));
    const last = Number(end?.get("last_tick") ?? Math.round(ends / dtNs));
    const recording = new Recording(name, file, snapshot, first, Math.max(first, last));
    if (file.cutOff) warnings.push("it was cut off; what is whole of it is shown");
    else if (end !== undefined && end.get("clean") === "false") warnings.push("it did not end as it should");
    const dropped = Number(end?.get("dropped_records") ?? 0);
    if (dropped > 0) warnings.push(`${dropped} records were lost while recording`);
    if (snapshot === null) warnings.push("it does not hold its scene: surfaces are drawn with uniform knots, bodies that never move are missing");
    if (recording.every > 1) warnings.push(`it was thinned: one tick of ${recording.every} is in it`);
    const format = file.metadata.get("palpate.run")?.get("format");
    if (file.metadata.get("palpate.run") === undefined) warnings.push("it was not made by Palpate, or by a build that says nothing of itself");
    else if (format !== undefined && Number(format) > 2) warnings.push(`it is of a newer format (${format})`);
    recording.warnings.push(...warnings);
    return recording;
  }

  async attachmentText(name: string): Promise<string | null> {
    const bytes = await this.file.attachment(name);
    return bytes === null ? null : new TextDecoder().decode(bytes);
  }

  chunk(index: number): Promise<Chunk> {
    const known = this.cache.get(index);
    if (known !== undefined) {
      // The newest used is last.
      this.cache.delete(index);
      this.cache.set(index, known);
      return known;
    }
    const made = this.decodeChunk(this.file.chunks[index]);
    this.cache.set(index, made);
    for (const oldest of this.cache.keys()) {
      if (this.cache.size <= KEPT_CHUNKS) break;
      this.cache.delete(oldest);
    }
    return made;
  }

  /** As `chunk`, for going through the whole file: does not push others out of memory. */
  passing(index: number): Promise<Chunk> {
    return this.cache.get(index) ?? this.decodeChunk(this.file.chunks[index]);
  }

  private async decodeChunk(place: ChunkPlace): Promise<Chunk> {
    const chunk: Chunk = { ticks: [], nets: [], events: [] };
    const messages = await this.file.messages(place);
    if (messages.some(({ channel }) => !this.file.channels.has(channel))) await this.findChannels();
    for (const { channel, data } of messages) {
      const topic = this.file.channels.get(channel) ?? "";
      try {
        if (topic === "/sim/tick") chunk.ticks.push(tickOf(data));
        else if (topic === "/sim/event") chunk.events.push(eventOf(data));
        else if (topic.startsWith("/body/") && topic.endsWith("/net")) chunk.nets.push(netOf(data));
      } catch {
        this.file.damaged += 1;
      }
    }
    return chunk;
  }

  /** Channels stand in the chunk that first uses them: without an index, going through the chunks finds them. */
  private findChannels(): Promise<void> {
    return (this.search ??= this.goThrough());
  }

  private async goThrough(): Promise<void> {
    for (const place of this.file.chunks) {
      await this.file.messages(place);
      const topics = new Set(this.file.channels.values());
      if (topics.has("/sim/tick") && topics.has("/sim/event") && this.bodyIds.every((id) => topics.has(`/body/${id}/net`))) return;
    }
  }

  /** Chunk in which the state after a tick is, or the last one before it. */
  chunkOf(tick: number): number {
    const timeNs = Math.round(tick * this.dt * 1e9);
    return lastWhere(this.file.chunks.length, (k) => this.file.chunks[k].startNs <= timeNs);
  }

  /** The state after a tick. */
  async at(tick: number): Promise<Moment> {
    const { chunks, channels } = this.file;
    const nets = new Map<string, NetRow>();
    const hands: ToolRow["hand"][] = this.toolIds.map(() => null);
    const netChannel = new Map([...channels].map(([id, topic]) => [topic, id]));
    let row: TickRow | null = null;
    const newest = this.chunkOf(tick);
    for (let k = newest; k >= 0 && k > newest - MOST_BACK; k--) {
      const missing = this.bodyIds.filter((id) => !nets.has(id));
      if (row !== null && missing.length === 0) break;
      const place = chunks[k].channels;
      const wanted = missing.some((id) => {
        const channel = netChannel.get(`/body/${id}/net`);
        return place === null || (channel !== undefined && place.has(channel));
      });
      if (row !== null && !wanted) continue;
      const chunk = await this.chunk(k);
      for (const net of chunk.nets) {
        const known = nets.get(net.body);
        if (net.tick <= tick && (known === undefined || known.tick <= net.tick)) nets.set(net.body, net);
      }
      const last = lastWhere(chunk.ticks.length, (index) => chunk.ticks[index].tick <= tick);
      if (last < 0 || (row !== null && row.tick >= chunk.ticks[last].tick)) continue;
      row = chunk.ticks[last];
      for (let index = last; index >= 0 && hands.includes(null); index--) {
        chunk.ticks[index].tools.forEach(({ hand }, t) => {
          if (hand !== null && hands[t] === null && isFiniteVec(hand.position)) hands[t] = hand;
        });
      }
    }
    return { tick: row, nets, hands };
  }
}
