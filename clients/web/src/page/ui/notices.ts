/** Short messages over the picture: what was refused, saved, found. They go by themselves, and stay while they hold. */

import { byId, el } from "./dom";

const SHOWN_MS = 9000;
const MOST = 4;

export class Notices {
  private readonly area = byId("notices");
  private readonly lasting = new Map<string, HTMLElement>();

  tell(text: string, bad = false): void {
    for (const old of this.area.querySelectorAll("p:not([data-lasting])")) if (old.textContent === text) old.remove();
    const notice = el("p", bad ? { class: "bad" } : {}, text);
    this.area.append(notice);
    // From when it is seen: a page in the background, or one that draws slowly, is given the time as well.
    requestAnimationFrame(() => setTimeout(() => notice.remove(), SHOWN_MS));
    while (this.area.querySelectorAll("p:not([data-lasting])").length > MOST) this.area.querySelector("p:not([data-lasting])")?.remove();
  }

  /** Shows a message under a name until it is taken back with `null`. */
  keep(name: string, text: string | null): void {
    const known = this.lasting.get(name);
    if (text === null) {
      known?.remove();
      this.lasting.delete(name);
    } else if (known === undefined) {
      const notice = el("p", { class: "bad", "data-lasting": name }, text);
      this.lasting.set(name, notice);
      this.area.prepend(notice);
    } else if (known.textContent !== text) known.textContent = text;
  }
}
