/** What lies over the picture: axes, labels at arrows, legend, size of the grid. */

import { norm, type Vec3 } from "../geometry";
import { gradientOf } from "../scene/colour";
import type { Stage } from "../scene/stage";
import type { WorldView } from "../scene/view";
import type { Settings } from "../settings";
import { digits, newtons, niceAbove, withUnit } from "../units";
import { byId, el, setText, svg } from "./dom";

const AXES: readonly (readonly [string, Vec3])[] = [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]];
const MOST_LABELS = 12;

export class Gizmo {
  private readonly root = byId("gizmo");
  private readonly parts = AXES.map(([name, axis]) => {
    const line = svg("line", { x1: "0", y1: "0", stroke: `var(--${name})` });
    const text = svg("text", { fill: `var(--${name})` });
    text.textContent = name;
    const group = svg("g", {});
    group.append(line, text);
    return { axis, line, text, group };
  });

  update(stage: Stage): void {
    const { right, up, away } = stage.axes();
    const along = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const sorted = this.parts.map((part) => ({ ...part, depth: along(part.axis, away) })).sort((a, b) => b.depth - a.depth);
    for (const { axis, line, text, group } of sorted) {
      const [x, y] = [along(axis, right), -along(axis, up)];
      line.setAttribute("x2", String(30 * x));
      line.setAttribute("y2", String(30 * y));
      text.setAttribute("x", String(41 * x));
      text.setAttribute("y", String(41 * y));
      this.root.append(group);
    }
  }
}

interface Label {
  readonly text: string;
  readonly kind: string;
  readonly place: Vec3;
}

/** Text at places of the world. */
export class Labels {
  private readonly area = byId("labels");
  private readonly spans: HTMLSpanElement[] = [];

  update(stage: Stage, views: readonly WorldView[], titles: readonly Label[], settings: Settings): void {
    const labels: Label[] = [...titles];
    if (settings.layers.labels && settings.layers.forces) {
      for (const { tools, group } of views) {
        const strong = tools.filter(({ tool, arrow }) => arrow.group.visible && norm(tool.force) > 0.005);
        for (const { tool, arrow } of strong.slice(0, MOST_LABELS)) {
          const { x, y, z } = arrow.tip.clone().add(group.position);
          labels.push({ text: newtons(norm(tool.force)), kind: "force", place: [x, y, z] });
        }
      }
    }
    while (this.spans.length < labels.length) {
      const span = el("span");
      this.spans.push(span);
      this.area.append(span);
    }
    this.spans.forEach((span, k) => {
      const label = labels[k];
      const at = label === undefined ? null : stage.project(label.place);
      const { clientWidth, clientHeight } = this.area;
      const seen = at !== null && at.x > -20 && at.y > -10 && at.x < clientWidth + 20 && at.y < clientHeight + 30;
      span.hidden = !seen;
      if (!seen || label === undefined) return;
      setText(span, label.text);
      span.className = label.kind;
      // A label stays on the picture, with some room for its own width.
      const x = Math.min(Math.max(at.x + 8, 4), clientWidth - 66);
      const y = Math.min(Math.max(at.y - 24, 2), clientHeight - 26);
      span.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    });
  }
}

export class Legend {
  private readonly root = byId("legend");
  private readonly title = el("div");
  private readonly map = el("div", { class: "map" });
  private readonly low = el("span");
  private readonly middle = el("span");
  private readonly high = el("span");
  private readonly scale = el("div", {}, this.title, this.map, el("div", { class: "ends" }, this.low, this.middle, this.high));
  private readonly arrow = el("div", { class: "arrow" });
  private readonly ground = byId("ground");

  constructor() {
    this.root.append(this.scale, this.arrow);
  }

  update(view: WorldView, stage: Stage, settings: Settings): void {
    const { scale } = view;
    this.scale.hidden = scale === null;
    if (scale !== null) {
      // One prefix for the whole scale.
      const step = niceAbove(Math.max(Math.abs(scale.from), scale.to));
      const [factor, unit] = scale.unit === "Pa" ? (step >= 1e6 ? [1e-6, "MPa"] : step >= 1e3 ? [1e-3, "kPa"] : [1, "Pa"])
        : scale.unit !== "m" ? [1, scale.unit] : step >= 0.5 ? [1, "m"] : step > 5e-5 ? [1e3, "mm"] : [1e6, "µm"];
      setText(this.title, `${scale.label}, ${unit}`);
      this.map.style.backgroundImage = gradientOf(scale.map);
      setText(this.low, digits(scale.from * factor, 2));
      setText(this.middle, digits(((scale.from + scale.to) / 2) * factor, 2));
      setText(this.high, digits(scale.to * factor, 2));
    }
    const strongest = view.tools.some(({ arrow }) => arrow.group.visible);
    this.arrow.hidden = !settings.layers.forces || !strongest;
    setText(this.arrow, `Force, 1 N = ${withUnit(view.arrowScale, "m")}`);
    this.root.hidden = this.scale.hidden && this.arrow.hidden;
    this.ground.hidden = !settings.layers.grid || view.bodies.length === 0;
    setText(this.ground, `grid ${withUnit(stage.cell, "m").replace(/\.0+ /, " ")}`);
  }
}
