/** The event log, newest first, with a filter. */

import { clock } from "../units";
import type { Happening, World } from "../world";
import { byId, el } from "./dom";

const SHOWN = 200;

export class EventLog {
  private readonly list = byId<HTMLOListElement>("events");
  private readonly filter = byId<HTMLSelectElement>("event-filter");
  private seen = -1;

  /** `onPick`: goes to the tick of an event, where that can be done. */
  constructor(private readonly onPick: ((tick: number) => void) | null) {
    this.filter.addEventListener("change", () => (this.seen = -1));
  }

  update(world: World): void {
    const wanted = this.filter.value;
    if (this.seen === world.eventVersion) return;
    this.seen = world.eventVersion;
    const fits = ({ about, serious }: Happening) => wanted === "all" || (wanted === "serious" ? serious : about === wanted);
    const events = world.events.filter(fits).slice(-SHOWN).reverse();
    const rows = events.map(({ tick, text, serious }) => {
      const time = `${clock(world.seconds(tick))}`;
      const when = this.onPick === null
        ? el("time", {}, time)
        : el("button", { type: "button", title: "Go there", onclick: () => this.onPick?.(tick) }, time);
      return el("li", serious ? { class: "serious" } : {}, when, el("span", {}, text));
    });
    this.list.replaceChildren(...(rows.length > 0 ? rows : [el("li", { class: "none" }, "Nothing so far.")]));
  }
}
