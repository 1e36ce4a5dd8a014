/** Keys and mouse, in a dialog. */

import { byId, el } from "./dom";

type Rows = readonly (readonly [string, string])[];

const MOUSE: Rows = [
  ["drag a tool", "move it: the loop answers with a force"],
  ["wheel meanwhile", "push it along the view (second finger up and down)"],
  ["Shift meanwhile", "grip what it touches"],
  ["Ctrl meanwhile", "turn the tool"],
  ["drag elsewhere", "turn the view (one finger)"],
  ["right drag", "move the view (two fingers)"],
  ["wheel", "zoom (pinch)"],
];

const LIVE: Rows = [
  ["Space", "pause, resume"], [".", "one tick, while paused"], ["R", "record, stop"], ["Backspace", "reset the scene"], ["K", "keep the last seconds (snapshot)"],
  ["T", "take the chosen tool, let go"], ["[ ]", "choose the tool before, after"], ["arrows", "while held: move it; else turn the view"],
  ["PgUp PgDn", "while held: push away, pull"], ["G", "while held: grip on, off"], ["Esc", "let go"],
];

const RECORDED: Rows = [
  ["Space", "play, pause"], [", .", "a tick back, on"], ["< >", "a tenth of a second back, on"], ["Home End", "beginning, end"], ["Alt - +", "slower, faster"], ["L", "play again at the end"],
  ["[ ]", "choose the tool before, after"],
];

const VIEW: Rows = [
  ["F", "fit to the scene"], ["0 1 2 3", "oblique, front, side, top"], ["+ -", "zoom"], ["V", "view panel"], ["N", "control nets"], ["B", "cells inside bodies"], ["C", "next colouring"],
  ["D", "light, dark, as the system"], ["U", "sound"], ["P", "save the picture (PNG)"], ["O", "save the surfaces (OBJ)"], ["E", "save the surfaces (STEP)"], ["?", "this help"],
];

/** `keys`: what stands at the left is keys, not words. */
function list(title: string, rows: Rows, keys = true): HTMLElement {
  const entries = el("dl");
  for (const [left, text] of rows) {
    const names = keys ? left.split(" ").map((key) => el("kbd", {}, key)) : [el("span", {}, left)];
    entries.append(el("dt", {}, ...names.flatMap((name, k) => (k > 0 ? [" ", name] : [name]))), el("dd", {}, text));
  }
  return el("section", {}, el("h3", {}, title), entries);
}

export class Help {
  private readonly dialog = byId<HTMLDialogElement>("help");

  constructor(recorded: () => boolean, version: () => string) {
    byId("help-open").addEventListener("click", () => this.open(recorded(), version()));
    this.dialog.addEventListener("click", (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
  }

  open(recorded: boolean, version: string): void {
    if (this.dialog.open) return this.dialog.close();
    this.dialog.replaceChildren(
      el("button", { class: "close", type: "button", onclick: () => this.dialog.close() }, "Close"),
      el("h2", { id: "help-title" }, "Keys and mouse"),
      el("div", { class: "columns" },
        el("div", {}, list("Mouse and fingers", recorded ? MOUSE.slice(4) : MOUSE, false), list("Picture", VIEW)),
        el("div", {}, list(recorded ? "Recording" : "Loop and tools", recorded ? RECORDED : LIVE))),
      el("p", { class: "why" }, version === "" ? "" : `Palpate ${version}`),
    );
    this.dialog.showModal();
  }
}
