/** Nodes and cells inside a body, as lines between nodes. */

import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial, Sphere, Vector3 } from "three";
import { edgesOf, youngOfNodes, type Inside } from "../inside";
import { paint } from "./colour";

export class LatticeView {
  readonly group = new Group();
  private readonly at: Float32Array;
  private readonly attribute: BufferAttribute;
  private readonly parts: readonly (LineSegments<BufferGeometry, LineBasicMaterial> | Points<BufferGeometry, PointsMaterial>)[];
  private version = -1;

  constructor(readonly inside: Inside, private readonly origin: readonly [number, number, number], size: number) {
    this.at = new Float32Array(inside.nodes.length);
    this.attribute = new BufferAttribute(this.at, 3);
    const young = youngOfNodes(inside);
    const colours = new Float32Array(this.at.length);
    const stiffest = young.reduce((a, b) => Math.max(a, b), 0);
    const softest = young.reduce((a, b) => Math.min(a, b), stiffest);
    // Of one material all is the middle of the map; of several, from the softest to the stiffest.
    if (softest < stiffest) paint(young, softest, stiffest, "viridis", colours);
    else paint(young.fill(0.5), 0, 1, "viridis", colours);
    const geometry = () => {
      const made = new BufferGeometry();
      made.setAttribute("position", this.attribute);
      made.setAttribute("color", new BufferAttribute(colours, 3));
      made.boundingSphere = new Sphere(new Vector3(), 4 * size);
      return made;
    };
    const lines = geometry();
    lines.setIndex(new BufferAttribute(edgesOf(inside), 1));
    this.parts = [
      new LineSegments(lines, new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.6 })),
      new Points(geometry(), new PointsMaterial({ vertexColors: true, size: 3, sizeAttenuation: false })),
    ];
    this.group.add(...this.parts);
    this.place(inside.nodes, 0);
  }

  /** Brings the nodes to where they are; `version` says whether they are others than before. */
  place(nodes: Float32Array, version: number): void {
    if (version === this.version || nodes.length !== this.at.length) return;
    this.version = version;
    for (let k = 0; k < nodes.length; k++) this.at[k] = nodes[k] - this.origin[k % 3];
    this.attribute.needsUpdate = true;
  }

  dispose(): void {
    for (const part of this.parts) {
      part.geometry.dispose();
      part.material.dispose();
    }
    this.group.removeFromParent();
  }
}
