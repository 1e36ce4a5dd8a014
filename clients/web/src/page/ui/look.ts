/** The view panel: colours, layers, cut. */

import type { Axis, ColourBy, Layer, Settings, SettingsStore } from "../settings";
import { byId, el } from "./dom";

const LAYERS: readonly (readonly [Layer, string])[] = [
  ["surface", "surfaces"], ["lines", "lines"], ["net", "nets"], ["lattice", "cells"], ["contacts", "contacts"], ["tools", "tools"], ["hands", "hands"],
  ["forces", "forces"], ["torques", "torques"], ["labels", "numbers"], ["grid", "ground"], ["shadows", "shadows"],
];

const VIEWS = { iso: [0.85, -1, 0.55], front: [0, -1, 0.02], side: [1, 0, 0.02], top: [0, -0.02, 1] } as const;
export type ViewName = keyof typeof VIEWS;

export const directionOf = (name: ViewName): readonly [number, number, number] => VIEWS[name];

export class LookPanel {
  private readonly panel = byId("look");
  private readonly toggleButton = byId("look-toggle");
  onToggle: () => void = () => {};
  private readonly boxes = new Map<Layer, HTMLInputElement>();

  constructor(private readonly settings: SettingsStore, fit: () => void, look: (name: ViewName) => void) {
    byId("fit").addEventListener("click", fit);
    for (const button of this.panel.querySelectorAll<HTMLElement>("[data-view]")) {
      button.addEventListener("click", () => look(button.dataset["view"] as ViewName));
    }
    this.toggleButton.addEventListener("click", () => this.toggle());
    const bind = <T extends HTMLElement>(id: string, event: string, change: (settings: Settings, element: T) => void) => {
      const element = byId<T>(id);
      element.addEventListener(event, () => settings.set((value) => change(value, element)));
    };
    bind<HTMLSelectElement>("colour-by", "change", (s, { value }) => (s.colourBy = value as ColourBy));
    bind<HTMLSelectElement>("map", "change", (s, { value }) => (s.map = value as Settings["map"]));
    bind<HTMLSelectElement>("clip", "change", (s, { value }) => (s.clip = value as Axis));
    bind<HTMLInputElement>("clip-at", "input", (s, { value }) => (s.clipAt = Number(value)));
    bind<HTMLInputElement>("clip-flip", "change", (s, { checked }) => (s.clipFlip = checked));
    bind<HTMLInputElement>("lock-range", "change", (s, { checked }) => (s.lockRange = checked));
    const layers = byId("layers");
    for (const [layer, label] of LAYERS) {
      const box = el("input", { type: "checkbox", "data-layer": layer });
      box.addEventListener("change", () => settings.set((s) => (s.layers[layer] = box.checked)));
      this.boxes.set(layer, box);
      layers.append(el("label", { class: "check" }, box, label));
    }
    settings.onChange(() => this.show());
    // On a narrow screen the picture is worth more than the panel.
    if (innerWidth < 1000) this.toggle(false);
    this.show();
  }

  /** Pixels of the picture that the panel covers, where there is room beside it. */
  get width(): number {
    return this.panel.hidden || this.panel.parentElement!.clientWidth < 640 ? 0 : this.panel.offsetWidth + 12;
  }

  toggle(open = this.panel.hidden): void {
    this.panel.hidden = !open;
    this.onToggle();
    this.toggleButton.setAttribute("aria-expanded", String(open));
  }

  /** `difference` makes sense with two recordings. */
  offerDifference(on: boolean): void {
    const option = byId<HTMLSelectElement>("colour-by").querySelector<HTMLOptionElement>("option[value=difference]");
    if (option !== null) option.hidden = option.disabled = !on;
  }

  /** Cells are known of a running loop, materials wherever the server has the scene. */
  offerInside(nodes: boolean, materials: boolean): void {
    const box = this.boxes.get("lattice");
    const option = byId<HTMLSelectElement>("colour-by").querySelector<HTMLOptionElement>("option[value=stiffness]");
    if (box !== undefined && box.disabled === nodes) {
      box.disabled = !nodes;
      const label = box.parentElement;
      if (label !== null) label.title = nodes ? "Nodes and cells inside bodies (B)" : "Nodes are known of a running loop: recordings hold control nets";
    }
    if (option !== null) option.hidden = option.disabled = !materials;
  }

  private show(): void {
    const { value } = this.settings;
    byId<HTMLSelectElement>("colour-by").value = value.colourBy;
    byId<HTMLSelectElement>("map").value = value.map;
    byId<HTMLSelectElement>("clip").value = value.clip;
    byId<HTMLInputElement>("clip-at").value = String(value.clipAt);
    byId<HTMLInputElement>("clip-flip").checked = value.clipFlip;
    byId<HTMLInputElement>("lock-range").checked = value.lockRange;
    for (const id of ["clip-at", "clip-flip"]) byId<HTMLInputElement>(id).disabled = value.clip === "off";
    for (const [layer, box] of this.boxes) box.checked = value.layers[layer];
  }
}
