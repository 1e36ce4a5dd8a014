/** Rows of numbers by tick, the newest few thousand: what a chart of a running loop shows. */

const MOST = 4096;

/** Half a second at the usual rate. */
const OVERTAKEN_TICKS = 500;

/** Columns: what they hold is the writer's and the chart's affair. */
export const COLUMNS = 7;

export class History {
  /** Ticks, growing. */
  ticks: number[] = [];
  readonly columns: number[][] = Array.from({ length: COLUMNS }, () => []);
  version = 0;

  /**
   * Appends a row; the same tick again replaces the last row. Messages overtake each other by some ticks: such a row is
   * left out. Much earlier ticks are another run, which starts anew.
   */
  push(tick: number, ...values: number[]): void {
    const last = this.ticks[this.ticks.length - 1];
    if (last !== undefined && tick < last) {
      if (last - tick < OVERTAKEN_TICKS) return;
      this.clear();
    }
    if (tick === last) {
      this.columns.forEach((column, c) => (column[column.length - 1] = values[c] ?? 0));
    } else {
      this.ticks.push(tick);
      this.columns.forEach((column, c) => column.push(values[c] ?? 0));
    }
    // A quarter at a time, so that a row costs no move of all others.
    if (this.ticks.length > MOST * 1.25) {
      const old = this.ticks.length - MOST;
      this.ticks.splice(0, old);
      for (const column of this.columns) column.splice(0, old);
    }
    this.version += 1;
  }

  clear(): void {
    this.ticks = [];
    for (const column of this.columns) column.length = 0;
    this.version += 1;
  }
}
