/** What the last picture showed, as whole numbers: whether the next one would differ. */

export class Shown {
  private last: number[] = [];

  /** Takes the figures of the next picture; true if one differs, rounded, from the last. */
  changed(figures: Iterable<number>): boolean {
    const { last } = this;
    let [count, different] = [0, false];
    for (const figure of figures) {
      // Plus zero: minus zero, which small figures below zero round to, is another for `Object.is`. NaN is not.
      const rounded = Math.round(figure) + 0;
      different ||= !Object.is(rounded, last[count]);
      last[count] = rounded;
      count += 1;
    }
    different ||= count !== last.length;
    last.length = count;
    return different;
  }
}
