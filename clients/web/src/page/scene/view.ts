/** One world on the stage: keeps what is drawn in step with what is known. */

import { Group } from "three";
import { Bounds, norm, type Vec3 } from "../geometry";
import type { Settings } from "../settings";
import { niceAbove } from "../units";
import { isPart } from "../surface/part";
import type { World } from "../world";
import { BodyView } from "./bodies";
import { meaning, Range, type Scale } from "./colour";
import { ContactsView } from "./contacts";
import { Shown } from "./shown";
import type { Stage } from "./stage";
import { ToolView, type ToolLook } from "./tools";

export interface Look extends ToolLook {
  readonly contact: string;
}

/** How far above the ground a flat body lies, as a share of the scene: it is pressed down, and the grid lies below it. */
const FLAT_ABOVE = 0.14;

/** A tenth of a pixel of a scene that is as wide as a screen; as much of a turn. */
const SEEN = 1e-4;

function isFlat(world: World): boolean {
  const bounds = new Bounds();
  for (const body of world.bodies) bounds.take(body.rest);
  return !bounds.empty && bounds.high[2] - bounds.low[2] < 0.1 * bounds.size;
}

export class WorldView {
  readonly group = new Group();
  bodies: BodyView[] = [];
  tools: ToolView[] = [];
  scale: Scale | null = null;
  /** m of arrow per N. */
  arrowScale = 0.01;
  size = 0.1;
  middle: Vec3 = [0, 0, 0];
  groundZ = 0;

  private readonly contacts = new ContactsView();
  private readonly shown = new Shown();
  private readonly range = new Range();
  private readonly forceRange = new Range();
  private seen = { scene: -1, outlines: -1, what: "", settings: -1 };

  constructor(readonly world: World, private readonly stage: Stage) {
    stage.content.add(this.group);
    this.group.add(this.contacts.group);
  }

  /**
   * Rebuilds what became another. True if the scene is new: the camera may want to know. Of two views both are rebuilt
   * before either is brought up to date, because each looks at the other.
   */
  rebuild(look: Look): boolean {
    const { world, seen } = this;
    const fresh = seen.scene !== world.sceneVersion;
    if (!fresh && seen.outlines === world.outlineVersion) return false;
    seen.outlines = world.outlineVersion;
    const remade = fresh || world.bodies.some(isPart);
    if (remade) {
      for (const view of this.bodies) view.dispose();
      this.bodies = world.bodies.map((body, k) => new BodyView(body, this.stage, k, world.bodies.length, world.outlineOf(body)));
      for (const view of this.bodies) this.group.add(view.group);
    }
    if (fresh) {
      seen.scene = world.sceneVersion;
      const bounds = world.bounds();
      this.size = bounds.size;
      this.middle = bounds.middle;
      this.groundZ = bounds.empty ? 0 : bounds.low[2] - (isFlat(world) ? FLAT_ABOVE * bounds.size : 0);
      this.range.reset();
      this.forceRange.reset();
    }
    for (const view of this.tools) view.dispose();
    this.tools = world.tools.map((tool) => {
      const outline = world.outlines.find(({ id, shape }) => id === tool.id && shape !== "part");
      const view = new ToolView(tool, outline, this.size, look);
      this.group.add(view.group);
      return view;
    });
    seen.settings = -1;
    return fresh;
  }

  /** Brings the picture to the world; true if it shows something else than before. `other` is the view to compare with. */
  update(settings: Settings, version: number, look: Look, focus: string | null, other: WorldView | null): boolean {
    const { world } = this;
    const now = performance.now();
    const what = settings.colourBy;
    if (this.seen.what !== what) {
      this.seen.what = what;
      this.range.reset();
    }
    for (const view of this.bodies) view.update(what, other?.bodies.find(({ body }) => body.id === view.body.id) ?? null);
    this.scale = this.scaleNow(settings, now);
    const clipped = settings.clip !== "off";
    for (const view of this.bodies) {
      view.paint(this.scale, what);
      view.setLayers(settings.layers.surface, settings.layers.lines, settings.layers.net, settings.layers.lattice, clipped);
    }
    if (this.seen.settings !== version) {
      this.seen.settings = version;
      for (const view of this.tools) view.setLook(look, view.tool.id === focus);
      this.contacts.setLook(look.contact);
    }
    const strongest = Math.max(0, ...world.tools.map((tool) => norm(tool.force)).filter(Number.isFinite));
    // The longest arrow is about a third of the scene; one newton alone is not drawn as if it were a hundred.
    this.arrowScale = (0.34 * this.size) / this.forceRange.follow(strongest, 0.5, now, false);
    for (const view of this.tools) view.update(settings.layers, this.arrowScale, this.size);
    this.contacts.group.visible = settings.layers.contacts;
    this.contacts.update(world.contacts, this.size);
    return this.shown.changed(this.figures(version, other));
  }

  /** What the picture depends on, in steps that are too small to be seen. */
  private *figures(version: number, other: WorldView | null): Generator<number> {
    const { world, size, arrowScale } = this;
    const step = SEEN * size;
    yield* [this.seen.scene, this.seen.outlines, version];
    for (const length of [this.scale?.from ?? 0, this.scale?.to ?? 0, arrowScale]) yield Math.log(Math.abs(length) + Number.MIN_VALUE) / SEEN;
    for (const { netVersion, nodesVersion, fault, inside } of [...world.bodies, ...(other?.world.bodies ?? [])]) {
      yield* [netVersion, nodesVersion, fault === null ? 0 : 1, inside === null ? 0 : 1];
    }
    for (const { proxy, orientation, force, torque, hand } of world.tools) {
      for (const k of [0, 1, 2]) {
        yield* [proxy[k] / step, (force[k] * arrowScale) / step, (torque[k] * arrowScale) / (size * step)];
        yield (hand?.position[k] ?? 0) / step;
      }
      for (const k of [0, 1, 2, 3]) yield* [orientation[k] / SEEN, (hand?.orientation[k] ?? 0) / SEEN];
    }
    for (const { point, normal } of world.contacts) {
      for (const k of [0, 1, 2]) yield* [point[k] / step, normal[k] / SEEN];
    }
  }

  private scaleNow(settings: Settings, now: number): Scale | null {
    const meant = meaning(settings);
    if (meant === null || this.bodies.length === 0) return null;
    const lowest = Math.min(...this.bodies.map((view) => view.extent[0]));
    const highest = Math.max(...this.bodies.map((view) => view.extent[1]));
    if (settings.colourBy === "curvature") {
      const top = this.range.follow(Math.max(Math.abs(lowest), Math.abs(highest)), 1e-3 / this.size, now, settings.lockRange);
      return { ...meant, from: -top, to: top };
    }
    if (settings.colourBy === "stiffness") return { ...meant, from: 0, to: this.range.follow(highest, 1, now, settings.lockRange) };
    const least = settings.colourBy === "difference" ? 1e-6 * this.size : niceAbove(this.size / 200);
    return { ...meant, from: 0, to: this.range.follow(highest, least, now, settings.lockRange) };
  }

  dispose(): void {
    for (const view of this.bodies) view.dispose();
    for (const view of this.tools) view.dispose();
    this.group.removeFromParent();
  }
}
