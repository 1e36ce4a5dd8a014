/** What the page was opened for: what the server says, and what a saved page carries in itself. */

export interface RecordingLink {
  readonly name: string;
  readonly url: string;
  readonly bytes?: number;
  readonly tools_url?: string | null;
  readonly inside_url?: string | null;
  readonly scene_url?: string | null;
  readonly against?: boolean;
}

export interface Session {
  readonly mode: "live" | "view";
  readonly instance?: string;
  readonly version?: string;
  /** Without one the page may look and not touch. */
  readonly token: string | null;
  readonly recordings?: readonly RecordingLink[];
  readonly instances?: readonly string[];
  /** Addresses of the pages of other instances. */
  readonly pages?: Readonly<Record<string, string>>;
  /** A recording published as if live: its tools move by themselves. */
  readonly played?: boolean;
  /** Addresses where others than the daemon's machine and holders of identities may come in and write. */
  readonly open?: readonly string[];
  readonly lockstep?: boolean;
}

/** Asks the server. `null` where there is none: a page opened from disk. */
export async function fetchSession(): Promise<Session | null> {
  if (!location.protocol.startsWith("http")) return null;
  try {
    const answer = await fetch("session.json", { cache: "no-store" });
    return answer.ok ? ((await answer.json()) as Session) : null;
  } catch {
    return null;
  }
}

/** A recording inside the page, with what else it needs. */
export interface Embedded {
  readonly name: string;
  readonly bytes: Uint8Array;
  readonly scene: Uint8Array | null;
  readonly tools: string | null;
}

function fromBase64(text: string): Uint8Array {
  const binary = atob(text.replace(/\s+/g, ""));
  const bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; k++) bytes[k] = binary.charCodeAt(k);
  return bytes;
}

export function embedded(): Embedded | null {
  const element = document.getElementById("palpate-recording");
  if (element === null) return null;
  const scene = document.getElementById("palpate-scene")?.textContent ?? "";
  return {
    name: element.dataset["name"] ?? "recording",
    bytes: fromBase64(element.textContent ?? ""),
    scene: scene.trim() === "" ? null : fromBase64(scene),
    tools: document.getElementById("palpate-tools")?.textContent ?? null,
  };
}
