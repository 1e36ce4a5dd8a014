/**
 * Mouse, pen and fingers on the picture: on a tool they move the hand, elsewhere they turn the view.
 *
 * The hand moves in the plane of the view; the wheel, or a second finger up and down, pushes along the view. Shift (or
 * the right button) grips, Control turns the tool.
 */

import { Raycaster, Vector2 } from "three";
import { add, scaled } from "../geometry";
import type { Stage } from "../scene/stage";
import type { ToolView } from "../scene/tools";
import type { Hand } from "./hand";

/** A finger is wider than an arrow, px. */
const NEAR = { mouse: 14, pen: 18, touch: 34 } as const;

export class PointerTouch {
  /** Told which tool the pointer is over. */
  onHover: (tool: string | null) => void = () => {};
  onTake: (tool: string) => void = () => {};
  enabled = () => true;

  private readonly caster = new Raycaster();
  private held: number | null = null;
  private at = { x: 0, y: 0 };
  private readonly others = new Map<number, number>();

  constructor(private readonly stage: Stage, private readonly hand: Hand, private readonly views: () => readonly ToolView[]) {
    const { canvas } = stage;
    // Ahead of the camera's own listeners, which are on the canvas as well.
    const area = canvas.parentElement ?? canvas;
    area.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
    area.addEventListener("pointermove", (event) => this.move(event), { capture: true });
    for (const name of ["pointerup", "pointercancel"] as const) {
      addEventListener(name, (event) => this.up(event), { capture: true });
    }
    area.addEventListener("wheel", (event) => this.wheel(event), { capture: true, passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** The tool under a place of the canvas, or beside it. */
  pick(event: PointerEvent): ToolView | null {
    const { canvas, camera } = this.stage;
    const box = canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const views = this.views().filter((view) => view.group.visible);
    this.caster.setFromCamera(new Vector2((2 * x) / box.width - 1, 1 - (2 * y) / box.height), camera);
    const hit = this.caster.intersectObjects(views.map((view) => view.shape), false)[0];
    if (hit !== undefined) return views.find((view) => view.shape === hit.object) ?? null;
    let best: ToolView | null = null;
    let nearest: number = NEAR[event.pointerType as keyof typeof NEAR] ?? NEAR.mouse;
    for (const view of views) {
      const place = this.stage.project(view.tool.proxy);
      if (place === null) continue;
      const radius = Math.min(view.reach / place.metresPerPixel, 60);
      const away = Math.hypot(place.x - x, place.y - y) - radius;
      if (away < nearest) [best, nearest] = [view, away];
    }
    return best;
  }

  private down(event: PointerEvent): void {
    if (event.target !== this.stage.canvas) return;
    if (this.held !== null) {
      // A second finger pushes.
      this.others.set(event.pointerId, event.clientY);
      event.stopPropagation();
      return;
    }
    if (!this.enabled() || event.button > 2 || event.button === 1) return;
    const view = this.pick(event);
    if (view === null) return;
    event.stopPropagation();
    event.preventDefault();
    this.held = event.pointerId;
    this.at = { x: event.clientX, y: event.clientY };
    this.stage.controls.enabled = false;
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.onTake(view.tool.id);
    this.hand.grip = event.shiftKey || event.button === 2;
  }

  private move(event: PointerEvent): void {
    if (event.pointerId !== this.held) {
      const before = this.others.get(event.pointerId);
      if (before !== undefined) {
        this.others.set(event.pointerId, event.clientY);
        this.push((before - event.clientY) / 300);
        event.stopPropagation();
      } else if (event.pointerType === "mouse" && event.buttons === 0 && event.target === this.stage.canvas) {
        this.onHover(this.enabled() ? (this.pick(event)?.tool.id ?? null) : null);
      }
      return;
    }
    event.stopPropagation();
    const [dx, dy] = [event.clientX - this.at.x, event.clientY - this.at.y];
    this.at = { x: event.clientX, y: event.clientY };
    this.hand.grip = event.shiftKey || (event.buttons & 2) !== 0;
    const { right, up } = this.stage.axes();
    if (event.ctrlKey || event.metaKey) {
      this.hand.turn(up, dx * 0.01);
      this.hand.turn(right, dy * 0.01);
      return;
    }
    const place = this.stage.project(this.hand.pose.position);
    if (place === null) return;
    this.hand.move(add(scaled(right, dx * place.metresPerPixel), scaled(up, -dy * place.metresPerPixel)));
  }

  private up(event: PointerEvent): void {
    this.others.delete(event.pointerId);
    if (event.pointerId !== this.held) return;
    this.held = null;
    this.others.clear();
    this.stage.controls.enabled = true;
    this.hand.letGo();
    event.stopPropagation();
  }

  private wheel(event: WheelEvent): void {
    if (this.held === null) return;
    event.preventDefault();
    event.stopPropagation();
    // Lines and pages, as some mice count, in pixels.
    const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1);
    this.push(-pixels / 2500);
  }

  /** Away from the viewer, as a share of the scene's size. */
  push(share: number): void {
    this.hand.move(scaled(this.stage.axes().away, share * this.stage.size));
  }

  /** The daemon took the tool away. */
  drop(): void {
    this.held = null;
    this.stage.controls.enabled = true;
  }
}

