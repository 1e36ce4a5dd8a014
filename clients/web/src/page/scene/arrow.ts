/** An arrow of any length: a shaft that stretches and a head that does not. */

import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshPhongMaterial, Quaternion, Vector3, type ColorRepresentation } from "three";
import { norm, type Vec3 } from "../geometry";

const UP = new Vector3(0, 1, 0);
const SHAFT = new CylinderGeometry(1, 1, 1, 16).translate(0, 0.5, 0);
const HEAD = new ConeGeometry(1, 1, 24).translate(0, 0.5, 0);

export class Arrow {
  readonly group = new Group();
  private readonly material: MeshPhongMaterial;
  private readonly shaft: Mesh;
  private readonly head: Mesh;
  /** Place of the point, for a label. */
  readonly tip = new Vector3();

  constructor(colour: ColorRepresentation, private readonly heads = 1) {
    this.material = new MeshPhongMaterial({ color: colour, emissive: colour, emissiveIntensity: 0.45, specular: 0x222222 });
    this.shaft = new Mesh(SHAFT, this.material);
    this.head = new Mesh(HEAD, this.material);
    this.group.add(this.shaft, this.head);
    if (heads === 2) this.group.add(new Mesh(HEAD, this.material));
    this.group.visible = false;
  }

  setColour(colour: ColorRepresentation): void {
    this.material.color.set(colour);
    this.material.emissive.set(colour);
  }

  /** From `start` along `vector` times `scale`; unseen where that is next to nothing. */
  set(start: Vec3, vector: Vec3, scale: number, thickness: number): void {
    const length = norm(vector) * scale;
    this.group.visible = length > 0.4 * thickness && Number.isFinite(length);
    if (!this.group.visible) return;
    const head = Math.min(5 * thickness, 0.6 * length);
    const body = length - head;
    this.group.position.set(...start);
    this.group.quaternion.copy(new Quaternion().setFromUnitVectors(UP, new Vector3(...vector).normalize()));
    this.shaft.scale.set(thickness, Math.max(body, 1e-9), thickness);
    for (let k = 0; k < this.heads; k++) {
      const part = this.group.children[1 + k];
      part.scale.set(2.3 * thickness, head, 2.3 * thickness);
      part.position.y = body - 0.7 * k * head;
    }
    this.tip.copy(new Vector3(0, length, 0)).applyQuaternion(this.group.quaternion).add(this.group.position);
  }

  dispose(): void {
    this.material.dispose();
    this.group.removeFromParent();
  }
}
