/** What the last picture showed, as whole numbers. */

export class Shown {
  private last: number[] = [];

  /** Takes the figures of the next picture; true if one differs, rounded, from the last. */
  changed(figures: Iterable<number>): boolean {
    const { last } = this;
    let [count, different] = [0, false];
    for (const figure of figures) {
      const rounded = Math.round(figure);
      // `Object.is`: what is not a number equals itself, and is drawn once.
      different ||= !Object.is(rounded, last[count]);
      last[count] = rounded;
      count += 1;
    }
    different ||= count !== last.length;
    last.length = count;
    return different;
  }
}
