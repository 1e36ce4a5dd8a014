/** The keyboard: every control has a key, and the hand can be moved with it. */

import { scaled } from "./geometry";
import type { Settings, ColourBy } from "./settings";
import type { App } from "./app";

const COLOURS: readonly ColourBy[] = ["displacement", "indentation", "curvature", "stiffness", "body", "none"];
const THEMES: readonly Settings["theme"][] = ["system", "light", "dark"];

const after = <T>(all: readonly T[], now: T): T => all[(all.indexOf(now) + 1) % all.length];

/** A key is the focused field's, where that is one to type or choose in. */
function isTaken(event: KeyboardEvent): boolean {
  const target = event.target as HTMLElement | null;
  if (document.querySelector("dialog[open]") !== null) return event.key !== "?";
  // The button of a dialog that has just closed keeps the focus for a moment.
  if (target === null || target.closest?.("dialog:not([open])")) return false;
  if (target.matches("select, textarea, input:not([type=range]):not([type=checkbox])")) return true;
  if (target.matches("input[type=range]")) return /^(Arrow|Page|Home|End)/.test(event.key);
  // Space and enter press the button that has the focus.
  return target.matches("button, input[type=checkbox]") && (event.key === " " || event.key === "Enter");
}

export function bindKeys(app: App): void {
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented || isTaken(event) || event.ctrlKey || event.metaKey) return;
    if (handle(app, event)) event.preventDefault();
  });
}

function handle(app: App, event: KeyboardEvent): boolean {
  if (moveHand(app, event)) return true;
  return (app.playback !== null ? recordingKey(app, event) : liveKey(app, event)) || viewKey(app, event);
}

function moveHand(app: App, event: KeyboardEvent): boolean {
  const { hand, stage } = app;
  if (hand === null || stage === null || hand.state !== "holding") return false;
  const { right, up, away } = stage.axes();
  const step = (event.shiftKey ? 0.004 : 0.015) * app.size;
  switch (event.key) {
    case "ArrowLeft": hand.move(scaled(right, -step)); return true;
    case "ArrowRight": hand.move(scaled(right, step)); return true;
    case "ArrowUp": hand.move(scaled(up, step)); return true;
    case "ArrowDown": hand.move(scaled(up, -step)); return true;
    case "PageUp": hand.move(scaled(away, step)); return true;
    case "PageDown": hand.move(scaled(away, -step)); return true;
    case "g": case "G": hand.grip = !hand.grip; return true;
    case "Escape": hand.letGo(); return true;
    default: return false;
  }
}

function liveKey(app: App, { key }: KeyboardEvent): boolean {
  const deck = app.liveDeck;
  if (deck === null) return false;
  switch (key) {
    case " ": deck.pause(); return true;
    case ".": deck.step(); return true;
    case "r": case "R": deck.record(); return true;
    case "k": case "K": deck.snapshot(); return true;
    case "Backspace": deck.reset(); return true;
    case "t": case "T": app.takeOrLetGo(); return true;
    default: return false;
  }
}

function recordingKey(app: App, event: KeyboardEvent): boolean {
  const { playback, playbackDeck: deck } = app;
  if (playback === null || deck === null) return false;
  const tenth = Math.max(1, Math.round(0.1 / playback.recording.dt));
  switch (event.key) {
    case " ": playback.toggle(); return true;
    case ",": deck.stepBy(-1); return true;
    case ".": deck.stepBy(1); return true;
    case "<": deck.stepBy(-tenth); return true;
    case ">": deck.stepBy(tenth); return true;
    case "Home": deck.go(playback.first); return true;
    case "End": deck.go(playback.last); return true;
    case "l": case "L": deck.toggleLoop(); return true;
    case "+": case "-":
      if (!event.altKey) return false;
      deck.faster(event.key === "+" ? 1 : -1);
      return true;
    default: return false;
  }
}

function viewKey(app: App, { key }: KeyboardEvent): boolean {
  const { settings, stage } = app;
  switch (key) {
    case "f": case "F": app.fit(); return true;
    case "0": app.lookFrom("iso"); return true;
    case "1": app.lookFrom("front"); return true;
    case "2": app.lookFrom("side"); return true;
    case "3": app.lookFrom("top"); return true;
    case "+": case "=": stage?.zoom(0.85); return true;
    case "-": stage?.zoom(1 / 0.85); return true;
    case "ArrowLeft": stage?.orbit(-0.12, 0); return true;
    case "ArrowRight": stage?.orbit(0.12, 0); return true;
    case "ArrowUp": stage?.orbit(0, 0.1); return true;
    case "ArrowDown": stage?.orbit(0, -0.1); return true;
    case "[": app.chooseNext(-1); return true;
    case "]": app.chooseNext(1); return true;
    case "v": case "V": app.look.toggle(); return true;
    case "n": case "N": settings.set((s) => (s.layers.net = !s.layers.net)); return true;
    case "c": case "C": settings.set((s) => (s.colourBy = after(COLOURS, s.colourBy))); return true;
    case "d": case "D": settings.set((s) => (s.theme = after(THEMES, s.theme))); return true;
    case "u": case "U": settings.set((s) => (s.sound = !s.sound)); return true;
    case "p": case "P": app.savePicture(); return true;
    case "b": case "B": settings.set((s) => (s.layers.lattice = !s.layers.lattice)); return true;
    case "o": case "O": app.saveNets(); return true;
    case "e": case "E": app.saveStep(); return true;
    case "?": app.showHelp(); return true;
    default: return false;
  }
}
