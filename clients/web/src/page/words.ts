/** What the loop says, in words for people who did not write it. */

import { ForceFlags, type EventKind, type LoopStatus, type SimEvent } from "../index";
import type { Happening } from "./world";
import { withUnit } from "./units";

const STAGES: Readonly<Record<string, string>> = {
  latch: "reading poses",
  render: "contact",
  deform: "deformation",
  hash: "the state hash",
  emit: "sending",
  wake: "the system woke it late",
};

type Told = Pick<Happening, "about" | "serious" | "text" | "repeated">;

const told = (about: Happening["about"], text: string, serious = false): Told => ({ about, serious, text });

/** Of those that may come again and again: those that follow each other are one line with their number. */
function counted(about: Happening["about"], text: string, many: (count: bigint) => string, serious = false): Told {
  const words = (count: bigint) => (count === 1n ? text : many(count));
  return { ...told(about, text, serious), repeated: { kind: text, count: 1n, worst: 0n, words } };
}

/** A loop that keeps falling behind says so every time: that is one line, with the lowest rate. */
function faultWords(reason: string): Told {
  const words = (count: bigint) => `Fault${count === 1n ? "" : `, ${count} times`}: ${reason}. Forces are safe, not right`;
  const slow = /^the loop runs at (\d{1,9}) of (\d{1,9}) Hz/.exec(reason);
  if (slow === null) return counted("fault", words(1n), words, true);
  const slowest = (count: bigint, worst: bigint) => (count === 1n ? words(1n)
    : `Fault, ${count} times: the loop runs at ${-worst} of ${slow[2]} Hz at its slowest; forces fade until it keeps its rate. Forces are safe, not right`);
  return { ...told("fault", words(1n), true), repeated: { kind: "slow", count: 1n, worst: -BigInt(slow[1]), words: slowest } };
}

/** The reason begins with the way it went. What rises is good news, at whatever level. */
function qualityWords(level: number, reason: string): Told {
  const text = level === 0 ? `Full quality again, ${reason}` : `Quality is at level ${level} (${QUALITY[level] ?? "less work"}), ${reason}`;
  return told("loop", text, level > 0 && !/^raised|in good time/.test(reason));
}

function wordsOf(kind: EventKind): Told {
  switch (kind.type) {
    case "Reset": return told("loop", "Reset to the start of the scene");
    case "Paused": return told("loop", "Paused");
    case "Resumed": return told("loop", "Running again");
    case "ToolJoined": return counted("tool", `${kind.tool} is being moved`, (count) => `${kind.tool} is being moved (${count} times)`);
    case "ToolLost": return counted("tool", `${kind.tool} is not moved any more`, (count) => `${kind.tool} is not moved any more (${count} times)`);
    case "PoseRefused": {
      const words = (count: bigint) => `${count === 1n ? "A pose" : `${count} times a pose`} of ${kind.tool} was refused: ${kind.reason}`;
      return counted("tool", words(1n), words, true);
    }
    case "ForceWithheld": {
      const words = (count: bigint) => `${kind.tool} is inside a body: no force until it is out of it${count === 1n ? "" : ` (${count} times)`}`;
      return counted("tool", words(1n), words);
    }
    case "ForceDegraded": {
      const words = (count: bigint) => `The force of ${kind.tool} is less accurate than asked for${count === 1n ? "" : ` (${count} times)`}: ${kind.reason}`;
      return counted("tool", words(1n), words);
    }
    case "ForceRestored": return counted("tool", `The force of ${kind.tool} is accurate again`, (count) => `The force of ${kind.tool} is accurate again (${count} times)`);
    case "Fault": return faultWords(kind.reason);
    case "RecordStarted": return told("recorder", `Recording to ${kind.path}`);
    case "RecordStopped": return told("recorder", `Recorded ${kind.path}`);
    case "Stopping": return told("loop", "The daemon is going down");
    case "Overrun": {
      const cause = STAGES[kind.stage] ?? kind.stage;
      const words = (count: bigint, worst: bigint) => {
        const ticks = count === 1n ? "1 tick was" : `${count} ticks were`;
        return `${ticks} late, the worst by ${withUnit(Number(worst) * 1e-9, "s")}: ${cause}`;
      };
      const repeated = { kind: `late ${kind.stage}`, count: kind.count, worst: kind.worst_ns, words };
      return { ...told("loop", words(kind.count, kind.worst_ns)), repeated };
    }
    case "QualityChanged": return qualityWords(kind.level, kind.reason);
    case "DeviceTold": return told("tool", `The device of ${kind.tool} is ${kind.name === "" ? "one without a name" : kind.name}`);
    case "RecordFailed": return told("recorder", `Recording ${kind.path} failed: ${kind.reason}`, true);
    case "SceneChanged": return told("scene", `The scene changed: ${kind.what}`);
  }
}

export function happening(event: SimEvent): Happening {
  return { tick: Number(event.tick), seq: Number(event.seq), ...wordsOf(event.kind) };
}

/** An event as recordings hold it, a name and words about it, taken apart again; `null` if it is none that is known. */
function recordedKind(kind: string, detail: string): EventKind | null {
  const [first, ...others] = detail.split(": ");
  const rest = others.join(": ");
  switch (kind) {
    case "reset": return { type: "Reset" };
    case "paused": return { type: "Paused" };
    case "resumed": return { type: "Resumed" };
    case "stopping": return { type: "Stopping" };
    case "tool_joined": return { type: "ToolJoined", tool: detail };
    case "tool_lost": return { type: "ToolLost", tool: detail };
    case "pose_refused": return { type: "PoseRefused", tool: first, reason: rest };
    case "force_withheld": return { type: "ForceWithheld", tool: detail };
    case "force_degraded": return { type: "ForceDegraded", tool: first, reason: rest };
    case "force_restored": return /^\d{1,15} ticks$/.test(rest) ? { type: "ForceRestored", tool: first, ticks: BigInt(rest.split(" ")[0]) } : null;
    case "fault": return { type: "Fault", reason: detail };
    case "record_started": return { type: "RecordStarted", path: detail };
    case "record_stopped": return { type: "RecordStopped", path: detail };
    case "record_failed": return { type: "RecordFailed", path: first, reason: rest };
    case "quality_changed": return /^\d$/.test(first) ? { type: "QualityChanged", level: Number(first), reason: rest } : null;
    case "device_told": return { type: "DeviceTold", tool: first, name: rest };
    case "scene_changed": return { type: "SceneChanged", what: detail };
    case "overrun": {
      const late = /^(.*): (\d{1,18}) ticks, worst (\d{1,18}) ns$/.exec(detail);
      return late === null ? null : { type: "Overrun", stage: late[1], count: BigInt(late[2]), worst_ns: BigInt(late[3]) };
    }
    default: return null;
  }
}

/** An event of a recording, in the words of one that happens now. */
export function recordedHappening(tick: number, kind: string, detail: string, seq: number): Happening {
  const name = kind.replace(/([a-z])([A-Z])/g, "$1_$2").replace(/[ -]/g, "_").toLowerCase();
  const known = recordedKind(name, detail);
  if (known !== null) return { tick, seq, ...wordsOf(known) };
  const text = name.replace(/_/g, " ") + (detail === "" ? "" : `: ${detail}`);
  return { tick, seq, about: "loop", serious: /fault|refused|failed/.test(name), text: text.charAt(0).toUpperCase() + text.slice(1) };
}

/** A tool's states by the flags of its force, the most important first, and what is no news in that state. */
const STATES: readonly (readonly [flag: number, words: string, hides: number])[] = [
  [ForceFlags.FAULT, "fault: the force is safe, not right", 0],
  [ForceFlags.REFUSED, "the last pose was refused", ForceFlags.SATURATED | ForceFlags.RAMPING],
  [ForceFlags.STALE, "no fresh pose", ForceFlags.SATURATED | ForceFlags.RAMPING | ForceFlags.GRABBING],
  [ForceFlags.WITHHELD, "inside a body: no force until it is out of it", 0],
  [ForceFlags.PAUSED, "paused", ForceFlags.SATURATED | ForceFlags.RAMPING],
  [ForceFlags.RAMPING, "force ramping up", ForceFlags.SATURATED],
  [ForceFlags.SATURATED, "at the force limit", 0],
  [ForceFlags.GRABBING, "gripping", 0],
  [ForceFlags.DAMPED, "damped", 0],
  [ForceFlags.DEGRADED, "less accurate than asked for", 0],
];

/** What the flags of a force say. Of a tool that nobody holds (`free`) an old pose is no news, nor what follows from it. */
export function flagWords(flags: number, free = false): string[] {
  const said: string[] = [];
  let left = flags;
  for (const [flag, words, hides] of STATES) {
    if ((left & flag) === 0) continue;
    left &= ~hides;
    if (!(free && flag === ForceFlags.STALE)) said.push(words);
  }
  return said;
}

export const RECORDER: Readonly<Record<LoopStatus["recorder"], string>> = {
  Off: "not recording",
  Recording: "recording",
  Ring: "last seconds kept",
  Failed: "recording failed",
};

/** Quality levels 1 to 3. */
export const QUALITY = ["full quality", "bodies iterate once", "fewer contact sweeps", "nets ten times rarer"] as const;
