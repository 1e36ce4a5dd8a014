/** Tools: their shape at the proxy, the device's pose as a ghost, the spring between the two, force and torque. */

import {
  BufferAttribute, BufferGeometry, DoubleSide, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial,
  MeshPhongMaterial, SphereGeometry, Sphere, Vector3,
} from "three";
import { dot, norm, scaled, sub, add, type Vec3 } from "../geometry";
import type { Outline, Tool } from "../world";
import { Arrow } from "./arrow";

export interface ToolLook {
  readonly tool: string;
  readonly focus: string;
  readonly hand: string;
  readonly force: string;
  readonly torque: string;
}

const COILS = 6;
const SPRING_POINTS = 8 * COILS + 1;

/** Triangles of an outline, each with its own normal; `null` if there are none. */
function geometryOf(outline: Outline | undefined): BufferGeometry | null {
  if (outline === undefined || outline.triangles.length === 0) return null;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(outline.points.flat()), 3));
  geometry.setIndex(outline.triangles.flat());
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  return geometry;
}

export class ToolView {
  readonly group = new Group();
  readonly shape: Mesh<BufferGeometry, MeshPhongMaterial>;
  readonly arrow: Arrow;
  readonly torque: Arrow;
  /** Radius of a sphere around the shape, m. */
  readonly reach: number;
  private readonly ghost: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly spring: Line<BufferGeometry, LineBasicMaterial>;
  private readonly springAt = new Float32Array(3 * SPRING_POINTS);

  constructor(readonly tool: Tool, outline: Outline | undefined, size: number, look: ToolLook) {
    // A point has no extent, and a plane has no end: both are drawn as large as the scene lets one see.
    const geometry = geometryOf(outline) ?? new SphereGeometry(tool.radius > 0 ? tool.radius : 0.012 * size, 32, 20);
    geometry.computeBoundingSphere();
    this.reach = geometry.boundingSphere?.radius ?? size / 50;
    const open = tool.shape === "plane";
    this.shape = new Mesh(geometry, new MeshPhongMaterial({
      color: look.tool, specular: 0x4a4a4a, shininess: 90, side: DoubleSide, transparent: open, opacity: open ? 0.35 : 1, depthWrite: !open,
    }));
    this.shape.castShadow = !open;
    this.shape.name = tool.id;
    this.ghost = new Mesh(geometry, new MeshBasicMaterial({ color: look.hand, wireframe: true, transparent: true, opacity: 0.28, depthWrite: false }));
    const line = new BufferGeometry();
    line.setAttribute("position", new BufferAttribute(this.springAt, 3));
    line.boundingSphere = new Sphere(new Vector3(), 1e3);
    this.spring = new Line(line, new LineBasicMaterial({ color: look.force, depthTest: false, transparent: true, opacity: 0.95 }));
    this.spring.renderOrder = 5;
    this.arrow = new Arrow(look.force);
    this.torque = new Arrow(look.torque, 2);
    this.group.add(this.shape, this.ghost, this.spring, this.arrow.group, this.torque.group);
  }

  setLook(look: ToolLook, focused: boolean): void {
    this.shape.material.color.set(focused ? look.focus : look.tool);
    this.ghost.material.color.set(look.hand);
    this.spring.material.color.set(look.force);
    this.arrow.setColour(look.force);
    this.torque.setColour(look.torque);
  }

  /** `arrowScale` in m/N; `size` of the scene, m. */
  update(show: { tools: boolean; hands: boolean; forces: boolean; torques: boolean }, arrowScale: number, size: number): void {
    const { tool } = this;
    const whole = tool.proxy.every(Number.isFinite) && tool.orientation.every(Number.isFinite);
    this.group.visible = whole;
    if (!whole) return;
    this.shape.visible = show.tools;
    this.shape.position.set(...tool.proxy);
    this.shape.quaternion.set(...tool.orientation);
    const { hand } = tool;
    const apart = hand === null ? 0 : norm(sub(hand.position, tool.proxy));
    const seen = show.hands && hand !== null && apart > Math.max(4e-3 * size, 0.08 * Math.min(this.reach, size)) && Number.isFinite(apart);
    this.ghost.visible = seen;
    this.spring.visible = seen;
    if (seen && hand !== null) {
      this.ghost.position.set(...hand.position);
      this.ghost.quaternion.set(...hand.orientation);
      this.coil(tool.proxy, hand.position, Math.min(0.01 * size, 0.25 * apart));
    }
    const thickness = 0.0075 * size;
    if (show.forces) {
      // From the skin of the tool, so that a short arrow is not hidden inside it.
      const force = norm(tool.force);
      const skin = force > 0 && tool.shape !== "plane" ? Math.min(this.reach, 0.2 * size) : 0;
      this.arrow.set(add(tool.proxy, scaled(tool.force, skin / (force || 1))), tool.force, arrowScale, thickness);
    } else this.arrow.group.visible = false;
    if (show.torques) this.torque.set(tool.proxy, tool.torque, arrowScale / (0.2 * size), 0.8 * thickness);
    else this.torque.group.visible = false;
  }

  private coil(from: Vec3, to: Vec3, radius: number): void {
    const along = sub(to, from);
    const length = norm(along) || 1;
    const unit = scaled(along, 1 / length);
    const side = Math.abs(unit[2]) < 0.9 ? ([0, 0, 1] as Vec3) : ([1, 0, 0] as Vec3);
    const first = sub(side, scaled(unit, dot(side, unit)));
    const a = scaled(first, radius / norm(first));
    const b: Vec3 = [unit[1] * a[2] - unit[2] * a[1], unit[2] * a[0] - unit[0] * a[2], unit[0] * a[1] - unit[1] * a[0]];
    for (let k = 0; k < SPRING_POINTS; k++) {
      const t = k / (SPRING_POINTS - 1);
      // Straight at both ends, a coil between them.
      const wide = Math.min(1, 8 * Math.min(t, 1 - t));
      const [c, s] = [Math.cos(2 * Math.PI * COILS * t) * wide, Math.sin(2 * Math.PI * COILS * t) * wide];
      for (let i = 0; i < 3; i++) this.springAt[3 * k + i] = from[i] + along[i] * t + a[i] * c + b[i] * s;
    }
    this.spring.geometry.getAttribute("position").needsUpdate = true;
  }

  dispose(): void {
    this.shape.geometry.dispose();
    this.shape.material.dispose();
    this.ghost.material.dispose();
    this.spring.geometry.dispose();
    this.spring.material.dispose();
    this.arrow.dispose();
    this.torque.dispose();
    this.group.removeFromParent();
  }
}
