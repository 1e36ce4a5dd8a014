/** Contact points with their normals. */

import {
  BufferAttribute, BufferGeometry, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, MeshBasicMaterial,
  Sphere, SphereGeometry, Vector3,
} from "three";
import type { Contact } from "../../index";

const MOST = 256;

export class ContactsView {
  readonly group = new Group();
  private readonly dots = new InstancedMesh(new SphereGeometry(1, 14, 10), new MeshBasicMaterial(), MOST);
  private readonly at = new Float32Array(6 * MOST);
  private readonly normals: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor() {
    const lines = new BufferGeometry();
    lines.setAttribute("position", new BufferAttribute(this.at, 3));
    lines.boundingSphere = new Sphere(new Vector3(), 1e3);
    this.normals = new LineSegments(lines, new LineBasicMaterial());
    this.dots.frustumCulled = false;
    this.group.add(this.dots, this.normals);
  }

  setLook(colour: string): void {
    this.dots.material.color.set(colour);
    this.normals.material.color.set(colour);
  }

  update(contacts: readonly Contact[], size: number): void {
    const whole = contacts.filter(({ point, normal }) => [...point, ...normal].every(Number.isFinite)).slice(0, MOST);
    const place = new Matrix4();
    const [radius, length] = [0.006 * size, 0.07 * size];
    whole.forEach(({ point, normal }, k) => {
      place.makeScale(radius, radius, radius).setPosition(...point);
      this.dots.setMatrixAt(k, place);
      for (let c = 0; c < 3; c++) {
        this.at[6 * k + c] = point[c];
        this.at[6 * k + 3 + c] = point[c] + length * normal[c];
      }
    });
    this.dots.count = whole.length;
    this.dots.instanceMatrix.needsUpdate = true;
    this.normals.geometry.setDrawRange(0, 2 * whole.length);
    this.normals.geometry.getAttribute("position").needsUpdate = true;
  }
}
