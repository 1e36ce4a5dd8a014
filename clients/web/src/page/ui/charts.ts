/** Force, depth, energy and tick time over one time axis. */

import uPlot from "uplot";
import { digits } from "../units";
import { byId, el, setText } from "./dom";
import type { Theme } from "./theme";
import type { Panel, Tracks } from "./tracks";

type Name = keyof Tracks;

const CHARTS: readonly { readonly name: Name; readonly title: string; readonly unit: string; readonly least: number }[] = [
  { name: "force", title: "Force", unit: "N", least: 0.1 },
  { name: "depth", title: "Depth", unit: "mm", least: 0.1 },
  { name: "energy", title: "Energy", unit: "mJ", least: 0.01 },
  { name: "loop", title: "Tick time", unit: "ms", least: 0.1 },
];

/** Charts change more slowly than pictures: nobody reads sixty numbers a second. */
const PERIOD_MS = 80;
const SYNC = "palpate";

class Chart {
  readonly root: HTMLElement;
  private readonly values = el("span", { class: "values" });
  private readonly plot = el("div", { class: "plot" });
  private chart: uPlot | null = null;
  private shape = "";
  private data: Panel = { time: [], lines: [] };

  constructor(private readonly about: (typeof CHARTS)[number], private readonly tall: () => number, private readonly last: boolean, private readonly owner: Charts) {
    this.root = el("div", { class: "chart", "data-chart": about.name },
      el("div", { class: "head" }, el("h2", {}, about.title, " "), el("span", { class: "unit" }, about.unit), this.values), this.plot);
  }

  private height(): number {
    return this.tall() + (this.last ? 18 : 0);
  }

  set(panel: Panel, range: readonly [number, number], theme: Theme): void {
    this.data = panel;
    const width = this.plot.clientWidth;
    if (width < 40) return;
    const shape = `${panel.lines.map(({ label }) => label).join()} ${panel.band !== undefined} ${theme.light} ${width} ${this.height()}`;
    if (shape !== this.shape) {
      this.shape = shape;
      this.chart?.destroy();
      this.chart = new uPlot(this.options(panel, width, theme), this.table(), this.plot);
      this.values.replaceChildren(...panel.lines.map(({ label, colour }) => {
        const value = el("span", { "data-line": label });
        value.style.setProperty("--c", theme.colour(colour));
        return value;
      }));
    }
    const { chart } = this;
    if (chart === null) return;
    chart.batch(() => {
      chart.setData(this.table(), false);
      chart.setScale("x", { min: range[0], max: range[1] });
      chart.setScale("y", this.heights(range) as { min: number; max: number });
    });
    this.tell(chart.cursor.idx ?? null);
  }

  private table(): uPlot.AlignedData {
    const { time, lines, band } = this.data;
    const edges = band === undefined ? [] : [band.high, band.low];
    return [time, ...lines.map(({ values }) => values), ...edges] as uPlot.AlignedData;
  }

  /** Zero is always seen, and noise does not fill the height. */
  private heights([from, to]: readonly [number, number]): { min: number; max: number } {
    let [min, max] = [0, this.about.least];
    const { time, lines, band } = this.data;
    for (const values of [...lines.map((line) => line.values), ...(band === undefined ? [] : [band.high])]) {
      for (let k = 0; k < time.length; k++) {
        const value = values[k];
        if (time[k] < from || time[k] > to || value === null || !Number.isFinite(value)) continue;
        if (value < min) min = value;
        if (value > max) max = value;
      }
    }
    const room = 0.07 * (max - min);
    return { min: min < 0 ? min - room : 0, max: max + room };
  }

  private options({ lines, band }: Panel, width: number, theme: Theme): uPlot.Options {
    const axis = { stroke: theme.colour("muted"), grid: { stroke: theme.colour("line"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    return {
      width, height: this.height(), legend: { show: false }, padding: [4, 6, 0, 0],
      scales: { x: { time: false }, y: { auto: false } },
      axes: [
        // The time is written once, below the last of them.
        { ...axis, size: this.last ? 18 : 3, gap: 2, space: 60, values: (_, ticks) => ticks.map((tick) => (this.last ? `${Number(tick.toFixed(6))} s` : "")) },
        { ...axis, size: 42, gap: 3, space: 22, values: (_, ticks) => ticks.map((tick) => String(Number(tick.toPrecision(6)))) },
      ],
      bands: band === undefined ? [] : [{ series: [lines.length + 1, lines.length + 2], fill: `${theme.colour(band.colour)}55` }],
      series: [{}, ...lines.map(({ label, colour, thin }): uPlot.Series => ({
        label, stroke: theme.colour(colour), width: thin === true ? 1 : 1.8, points: { show: false }, spanGaps: true,
      })), ...(band === undefined ? [] : [{ width: 0, points: { show: false } }, { width: 0, points: { show: false } }])],
      cursor: { sync: { key: SYNC, setSeries: false }, drag: { x: this.owner.onZoom !== null, y: false, setScale: false }, points: { size: 6 } },
      hooks: {
        setCursor: [(chart) => this.tell(chart.cursor.idx ?? null)],
        draw: [(chart) => this.drawMark(chart, theme)],
        setSelect: [(chart) => {
          const { left, width: wide } = chart.select;
          if (wide > 4) this.owner.onZoom?.(chart.posToVal(left, "x"), chart.posToVal(left + wide, "x"));
          chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
        ready: [(chart) => {
          chart.over.addEventListener("click", () => {
            const at = chart.cursor.left ?? -1;
            if (at >= 0) this.owner.onPick?.(chart.posToVal(at, "x"));
          });
          chart.over.addEventListener("dblclick", () => this.owner.onZoom?.(0, 0));
        }],
      },
    };
  }

  private drawMark(chart: uPlot, theme: Theme): void {
    const { mark } = this.owner;
    if (mark === null) return;
    const x = chart.valToPos(mark, "x", true);
    const { left, top, width, height } = chart.bbox;
    if (x < left || x > left + width) return;
    chart.ctx.save();
    chart.ctx.strokeStyle = theme.colour("accent");
    chart.ctx.lineWidth = 1.5 * devicePixelRatio;
    chart.ctx.beginPath();
    chart.ctx.moveTo(x, top);
    chart.ctx.lineTo(x, top + height);
    chart.ctx.stroke();
    chart.ctx.restore();
  }

  /** Values under the pointer, or at the playhead, or the newest. */
  private tell(index: number | null): void {
    const { time, lines } = this.data;
    let at = index ?? time.length - 1;
    if (index === null && this.owner.mark !== null) {
      while (at > 0 && time[at] > this.owner.mark + 1e-9) at -= 1;
    }
    lines.forEach(({ label, values }, k) => {
      const element = this.values.children[k];
      const value = values[at];
      if (element !== undefined) setText(element, `${lines.length > 1 ? `${label} ` : ""}${value === null || value === undefined ? "–" : digits(value, 3)}`);
    });
  }
}

export class Charts {
  /** A place in time was clicked, s. */
  onPick: ((seconds: number) => void) | null = null;
  /** A stretch of time was chosen, s; 0, 0: all. */
  onZoom: ((from: number, to: number) => void) | null = null;
  /** The playhead, s. */
  mark: number | null = null;
  private readonly charts: readonly Chart[];
  private last = 0;

  constructor() {
    // What the panel leaves after the readout and some lines of events, so that nothing needs scrolling on a usual screen.
    const tall = () => (innerWidth <= 820 ? 92 : Math.round(Math.min(Math.max((innerHeight - 538) / 4, 58), 150)));
    this.charts = CHARTS.map((about, k) => new Chart(about, tall, k === CHARTS.length - 1, this));
    byId("charts").append(...this.charts.map(({ root }) => root));
  }

  /** True if it is time to draw again. */
  due(now: number): boolean {
    if (now - this.last < PERIOD_MS) return false;
    this.last = now;
    return true;
  }

  set(tracks: Tracks, range: readonly [number, number], theme: Theme): void {
    this.charts.forEach((chart, k) => chart.set(tracks[CHARTS[k].name], range, theme));
  }

}
