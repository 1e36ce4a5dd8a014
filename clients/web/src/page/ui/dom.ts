/** Elements without a framework. */

/** The element of `index.html` with this id. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (element === null) throw new Error(`the page has no #${id}`);
  return element as T;
}

type Attributes = Readonly<Record<string, string | boolean | ((event: Event) => void)>>;

/** An element with attributes, listeners (`onclick`) and children. */
export function el<K extends keyof HTMLElementTagNameMap>(name: K, attributes: Attributes = {}, ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key.replace(/^on/, ""), value);
    else if (typeof value === "boolean") element.toggleAttribute(key, value);
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

/** Writes text only where it changes: layout is computed anew otherwise. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

const SVG = "http://www.w3.org/2000/svg";

/** A line icon of 24 × 24. */
export function icon(path: string, filled = false): SVGElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const shape = document.createElementNS(SVG, "path");
  shape.setAttribute("d", path);
  if (filled) shape.setAttribute("class", "fill");
  svg.append(shape);
  return svg;
}

export function svg(name: string, attributes: Readonly<Record<string, string>>): SVGElement {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

export const ICONS = {
  play: "M7 5l12 7-12 7z",
  pause: "M8 5v14M16 5v14",
  step: "M6 5l9 7-9 7zM18 5v14",
  back: "M18 5l-9 7 9 7zM6 5v14",
  reset: "M4 12a8 8 0 108-8M4 4v5h5",
  record: "M12 6a6 6 0 100 12 6 6 0 000-12z",
  snapshot: "M12 8v5l3 2M4 12a8 8 0 108-8 8 8 0 00-7 4M4 4v4h4",
  picture: "M4 7h4l2-2h4l2 2h4v12H4zM12 10a3 3 0 100 6 3 3 0 000-6z",
  save: "M12 4v11M7 11l5 5 5-5M4 20h16",
  saveExact: "M4 13C8 3 14 13 20 4M12 9v8M8 13l4 4 4-4M4 21h16",
  loop: "M17 3l4 4-4 4M21 7H7a4 4 0 00-4 4M7 21l-4-4 4-4M3 17h14a4 4 0 004-4",
} as const;
