/** Tools to choose from, and what the chosen one feels. */

import { norm } from "../geometry";
import { newtons, withUnit } from "../units";
import { flagWords } from "../words";
import type { Tool, World } from "../world";
import { byId, el, setText } from "./dom";

export interface ToolActions {
  /** Shows another tool; with others kept if `more`. */
  choose(tool: string, more: boolean): void;
  take(tool: string): void;
  letGo(): void;
}

export class ToolList {
  private readonly area = byId("tools");
  private buttons = new Map<string, { button: HTMLButtonElement; value: HTMLElement }>();
  private built = -1;

  constructor(private readonly actions: ToolActions) {}

  update(world: World, chosen: ReadonlySet<string>): void {
    if (this.built !== world.sceneVersion) {
      this.built = world.sceneVersion;
      this.buttons = new Map();
      this.area.replaceChildren(...world.tools.map((tool) => this.make(tool)));
      this.area.hidden = world.tools.length === 0;
    }
    for (const tool of world.tools) {
      const parts = this.buttons.get(tool.id);
      if (parts === undefined) continue;
      setText(parts.value, newtons(norm(tool.force)));
      parts.button.setAttribute("aria-pressed", String(chosen.has(tool.id)));
      parts.button.classList.toggle("held", tool.holder !== null);
      parts.button.title = `${tool.shape}${tool.holder === null ? "" : `, held by ${tool.holder}`}. Shift: chart several`;
    }
  }

  private make(tool: Tool): HTMLButtonElement {
    const value = el("span", { class: "n" });
    const button = el("button", {
      type: "button", "data-tool": tool.id, "aria-pressed": "false",
      onclick: (event) => this.actions.choose(tool.id, (event as MouseEvent).shiftKey || (event as MouseEvent).ctrlKey),
    }, tool.id, value);
    this.buttons.set(tool.id, { button, value });
    return button;
  }
}

export class Readout {
  private readonly size = el("b", { "data-value": "force" });
  private readonly name = el("span", { class: "name" });
  private readonly gauge = el("i");
  private readonly values = new Map<string, HTMLElement>();
  private readonly words = el("p", { class: "words" });
  private readonly take = el("button", { type: "button", id: "take" }, "Take with keys (T)");
  private readonly who = el("span", { class: "who" });
  private tool = "";
  private held = false;

  constructor(actions: ToolActions) {
    const list = el("dl");
    for (const [name, label] of [["fx", "x"], ["depth", "depth"], ["fy", "y"], ["energy", "energy"], ["fz", "z"], ["contacts", "contacts"]]) {
      const value = el("dd");
      this.values.set(name, value);
      list.append(el("dt", {}, label), value);
    }
    this.take.addEventListener("click", () => (this.held ? actions.letGo() : actions.take(this.tool)));
    byId("readout").append(
      el("div", { class: "big" }, this.size, el("span", { class: "unit" }, "N"), this.words, this.name),
      el("div", { class: "gauge" }, this.gauge),
      list,
      el("div", { class: "actions", id: "actions" }, this.take, this.who),
    );
  }

  /** `live`: whether it is known who holds it; `may`: whether tools can be taken here at all. */
  update(tool: Tool | undefined, live: boolean, may: boolean, held: boolean): void {
    byId("readout").hidden = tool === undefined;
    if (tool === undefined) return;
    this.tool = tool.id;
    this.held = held;
    const force = norm(tool.force);
    setText(this.size, Number.isFinite(force) ? force.toFixed(2) : "–");
    setText(this.name, `on ${tool.id}`);
    this.gauge.style.transform = `scaleX(${Math.min(force / (tool.forceMax > 0 && Number.isFinite(tool.forceMax) ? tool.forceMax : 10), 1) || 0})`;
    this.gauge.parentElement?.setAttribute("title", tool.forceMax > 0 && Number.isFinite(tool.forceMax) ? `of at most ${tool.forceMax} N` : "of 10 N");
    this.put("fx", newtons(tool.force[0]));
    this.put("fy", newtons(tool.force[1]));
    this.put("fz", newtons(tool.force[2]));
    this.put("depth", withUnit(tool.depth, "m"));
    this.put("energy", withUnit(tool.energy, "J"));
    this.put("contacts", String(tool.contacts));
    const free = live && !held && tool.holder === null;
    setText(this.words, flagWords(tool.flags, free).join(", "));
    this.take.hidden = !may;
    setText(this.take, held ? "Let go (Esc)" : "Take with keys (T)");
    setText(this.who, held ? "you hold it" : tool.holder !== null ? `held by ${tool.holder}` : free ? "nobody holds it" : "");
  }

  private put(name: string, text: string): void {
    const value = this.values.get(name);
    if (value !== undefined) setText(value, text);
  }
}
