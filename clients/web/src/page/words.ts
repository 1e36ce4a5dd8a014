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

/** A loop that keeps falling behind says so every time: that is one line, with the lowest rate. */
function faultWords(reason: string): Told {
  const plain = told("fault", `Fault: ${reason}. Forces are safe, not right`, true);
  const slow = /^the loop runs at (\d{1,9}) of (\d{1,9}) Hz/.exec(reason);
  if (slow === null) return plain;
  const words = (count: bigint, worst: bigint) => (count === 1n ? plain.text
    : `Fault, ${count} times: the loop runs at ${-worst} of ${slow[2]} Hz at its slowest; forces fade until it keeps its rate. Forces are safe, not right`);
  return { ...plain, repeated: { kind: "slow", count: 1n, worst: -BigInt(slow[1]), words } };
}

function wordsOf(kind: EventKind): Told {
  switch (kind.type) {
    case "Reset": return told("loop", "Reset to the start of the scene");
    case "Paused": return told("loop", "Paused");
    case "Resumed": return told("loop", "Running again");
    case "ToolJoined": return told("tool", `${kind.tool} is being moved`);
    case "ToolLost": return told("tool", `${kind.tool} was let go`);
    case "PoseRefused": return told("tool", `A pose of ${kind.tool} was refused: ${kind.reason}`, true);
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
    case "QualityChanged":
      return told("loop", kind.level === 0 ? "Full quality again" : `Quality lowered to level ${kind.level}: ${kind.reason}`, kind.level > 0);
    case "DeviceTold": return told("tool", `${kind.tool} is held by ${kind.name}`);
    case "RecordFailed": return told("recorder", `Recording ${kind.path} failed: ${kind.reason}`, true);
    case "SceneChanged": return told("scene", `The scene changed: ${kind.what}`);
  }
}

export function happening(event: SimEvent): Happening {
  return { tick: Number(event.tick), seq: Number(event.seq), ...wordsOf(event.kind) };
}

const RECORDED: Readonly<Record<string, Happening["about"]>> = {
  tool_joined: "tool", tool_lost: "tool", pose_refused: "tool", device_told: "tool", fault: "fault", scene_changed: "scene",
  record_started: "recorder", record_stopped: "recorder", record_failed: "recorder",
};

/** An event as recordings hold it: a kind and its details as text. */
export function recordedHappening(tick: number, kind: string, detail: string, seq: number): Happening {
  const name = kind.replace(/([a-z])([A-Z])/g, "$1_$2").replace(/[ -]/g, "_").toLowerCase();
  const text = name.replace(/_/g, " ") + (detail === "" ? "" : `: ${detail}`);
  return {
    tick, seq,
    about: RECORDED[name] ?? "loop",
    serious: /fault|refused|failed/.test(name),
    text: text[0].toUpperCase() + text.slice(1),
  };
}

/** What the flags of a force say, the most important first. */
export function flagWords(flags: number): string[] {
  const words: [number, string][] = [
    [ForceFlags.FAULT, "fault: the force is safe, not right"],
    [ForceFlags.REFUSED, "the last pose was refused"],
    [ForceFlags.STALE, "no fresh pose"],
    [ForceFlags.SATURATED, "at the force limit"],
    [ForceFlags.RAMPING, "force ramping"],
    [ForceFlags.GRABBING, "gripping"],
    [ForceFlags.DAMPED, "damped"],
    [ForceFlags.PAUSED, "paused"],
  ];
  return words.filter(([bit]) => (flags & bit) !== 0).map(([, text]) => text);
}

export const RECORDER: Readonly<Record<LoopStatus["recorder"], string>> = {
  Off: "not recording",
  Recording: "recording",
  Ring: "last seconds kept",
  Failed: "recording failed",
};

/** Quality levels 1 to 3. */
export const QUALITY = ["full quality", "bodies iterate once", "fewer contact sweeps", "nets ten times rarer"] as const;
