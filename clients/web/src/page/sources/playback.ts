/** A recording played into a world: play, pause, speed, step, loop, seek. */

import { isFiniteVec, type Vec3 } from "../geometry";
import { Overview } from "../mcap/overview";
import type { Moment, Recording } from "../mcap/recording";
import { uniformKnots } from "../surface/basis";
import { recordedHappening } from "../words";
import { Body, Tool, type Outline, type World } from "../world";

export class Playback {
  playing = false;
  speed = 1;
  loop = false;
  /** How long the last seek took, ms. */
  seekMs = 0;
  readonly overview: Overview;
  private at: number;
  private shown = -1;
  private busy = false;
  private wanted: number | null = null;
  private eventsTold = -1;

  constructor(readonly recording: Recording, readonly world: World, outlines: readonly Outline[]) {
    this.overview = new Overview(recording);
    this.at = recording.firstTick;
    world.outlines = outlines;
    world.outlineVersion += 1;
    world.link = "playing";
    if (recording.snapshot !== null) world.load(recording.snapshot);
    world.name = recording.scene;
    world.dt = recording.dt;
    if (recording.snapshot === null) {
      const still = { position: [0, 0, 0] as Vec3, orientation: [0, 0, 0, 1] as const };
      world.tools = recording.toolIds.map((id) => new Tool(id, "sphere", 0, 0, still));
      world.sceneVersion += 1;
    }
    void this.overview.fill();
  }

  get first(): number {
    return this.recording.firstTick;
  }

  get last(): number {
    return this.recording.lastTick;
  }

  /** Tick under the playhead. */
  get tick(): number {
    return Math.round(this.at);
  }

  toggle(): void {
    // At the end, play means from the beginning.
    if (!this.playing && this.tick >= this.last) this.at = this.first;
    this.playing = !this.playing;
    this.world.touch();
  }

  step(ticks: number): void {
    this.playing = false;
    void this.seek(this.tick + ticks);
  }

  /** Goes to the state after a tick; resolves when it is shown. */
  async seek(tick: number): Promise<void> {
    this.at = Math.min(Math.max(tick, this.first), this.last);
    this.wanted = this.tick;
    if (this.busy) return;
    this.busy = true;
    try {
      // While one moment was read, the hand on the timeline went on: only its newest place is read next.
      while (this.wanted !== null) {
        const target: number = this.wanted;
        this.wanted = null;
        const start = performance.now();
        const moment = await this.recording.at(target);
        this.show(target, moment);
        this.seekMs = performance.now() - start;
      }
    } catch (error) {
      this.world.trouble = `This place of the recording cannot be read: ${error instanceof Error ? error.message : String(error)}`;
      this.world.touch();
    } finally {
      this.busy = false;
    }
  }

  /** Moves on by real time, ms. */
  advance(ms: number): void {
    this.tellEvents();
    if (this.playing) {
      this.at += (Math.min(ms, 250) * 1e-3 * this.speed) / this.recording.dt;
      if (this.at >= this.last) {
        if (this.loop) this.at = this.first;
        else [this.at, this.playing] = [this.last, false];
        this.world.touch();
      }
    }
    if (this.tick !== this.shown && !this.busy) void this.seek(this.at);
  }

  private tellEvents(): void {
    const { overview, world } = this;
    if (overview.version === this.eventsTold) return;
    this.eventsTold = overview.version;
    // Each on a line of its own: it is a place to go to.
    world.events = overview.events.map(({ tick, kind, detail }, k) => recordedHappening(tick, kind, detail, k));
    world.eventVersion += 1;
    world.historyVersion += 1;
    world.touch();
  }

  private show(target: number, { tick, nets, hands }: Moment): void {
    const { world } = this;
    this.shown = target;
    for (const net of nets.values()) {
      const known = world.body(net.body);
      if (known === undefined || !known.takeNet(net.points, net.countU, net.countV, net.tick)) this.replaceBody(net);
    }
    // Before its first recorded net a body is as it was at rest.
    for (const body of world.bodies) if (!nets.has(body.id) && body.netTick > target) body.takeNet(body.rest, body.surface.u.count, body.surface.v.count, 0);
    world.contacts = [];
    tick?.tools.forEach(({ values, contacts, contact, flags }, t) => {
      const tool = world.tools[t];
      if (tool === undefined || values.length < 21) return;
      const vector = (k: number): Vec3 => [values[k], values[k + 1], values[k + 2]];
      tool.tick = tick.tick;
      tool.force = vector(0);
      tool.torque = vector(3);
      tool.proxy = vector(6);
      tool.orientation = [values[9], values[10], values[11], values[12]];
      tool.contactForce = vector(13);
      tool.energy = values[19];
      tool.dissipated = values[20];
      tool.error = values[21] ?? 0;
      tool.flags = flags;
      tool.contacts = contacts;
      tool.depth = contact?.values[8] ?? 0;
      tool.hand = hands[t] ?? null;
      if (contact === null || !isFiniteVec([...contact.values])) return;
      const c = contact.values;
      const at = (k: number): Vec3 => [c[k], c[k + 1], c[k + 2]];
      world.contacts = [...world.contacts, {
        tool: tool.id, body: this.recording.bodyIds[contact.body] ?? "", u: c[0], v: c[1], point: at(2), normal: at(5), depth: c[8], force: at(9),
      }];
    });
    world.tick = target;
    world.touch();
  }

  /** A body that the snapshot does not have, or has otherwise: its first net is its rest, its knots are assumed. */
  private replaceBody(net: { body: string; countU: number; countV: number; degreeU: number; degreeV: number; points: Float64Array; tick: number }): void {
    const { world } = this;
    const direction = (degree: number, count: number) => ({ degree, periodic: false, count, knots: uniformKnots(degree, count) });
    const surface = { u: direction(net.degreeU, net.countU), v: direction(net.degreeV, net.countV), weights: null };
    const body = new Body(net.body, "", surface, net.points, net.points, true);
    body.netTick = net.tick;
    world.bodies = [...world.bodies.filter(({ id }) => id !== net.body), body];
    world.sceneVersion += 1;
  }

  stop(): void {
    this.overview.stop();
    this.playing = false;
  }
}
