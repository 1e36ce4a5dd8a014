/** How the scene is shown: what the panel sets, what a browser remembers. */

export type ColourBy = "none" | "displacement" | "indentation" | "curvature" | "stiffness" | "body" | "difference";
export type Layer = "surface" | "lines" | "net" | "lattice" | "contacts" | "tools" | "hands" | "forces" | "torques" | "labels" | "grid" | "shadows";
export type Axis = "off" | "x" | "y" | "z";

export interface Settings {
  theme: "system" | "light" | "dark";
  colourBy: ColourBy;
  map: "ember" | "viridis" | "cividis";
  lockRange: boolean;
  layers: Record<Layer, boolean>;
  clip: Axis;
  /** Place of the clip plane in the scene, 0 to 1. */
  clipAt: number;
  clipFlip: boolean;
  sound: boolean;
  /** Seconds of a live chart. */
  span: number;
}

const DEFAULTS: Settings = {
  theme: "system",
  colourBy: "displacement",
  map: "ember",
  lockRange: false,
  layers: {
    surface: true, lines: true, net: false, lattice: false, contacts: true, tools: true, hands: true,
    forces: true, torques: false, labels: true, grid: true, shadows: true,
  },
  clip: "off",
  clipAt: 0.5,
  clipFlip: false,
  sound: false,
  span: 10,
};

const KEY = "palpate.page.1";

function copy(settings: Settings): Settings {
  return { ...settings, layers: { ...settings.layers } };
}

/** What was set before. A clip plane or a difference is of one session: these start as usual. */
function remembered(): Settings {
  const settings = copy(DEFAULTS);
  try {
    const stored = JSON.parse(localStorage.getItem(KEY) ?? "{}") as Partial<Settings>;
    if (["system", "light", "dark"].includes(stored.theme ?? "")) settings.theme = stored.theme!;
    if (["ember", "viridis", "cividis"].includes(stored.map ?? "")) settings.map = stored.map!;
    if ([5, 10, 30, 60].includes(stored.span ?? 0)) settings.span = stored.span!;
    for (const layer of Object.keys(settings.layers) as Layer[]) {
      const value = stored.layers?.[layer];
      if (typeof value === "boolean") settings.layers[layer] = value;
    }
  } catch {
    // No storage (a page from disk, a private window): the defaults.
  }
  return settings;
}

/** Settings with those who want to know of a change. */
export class SettingsStore {
  readonly value: Settings = remembered();
  version = 0;
  private readonly listeners: (() => void)[] = [];

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  set(change: (settings: Settings) => void): void {
    change(this.value);
    this.version += 1;
    try {
      localStorage.setItem(KEY, JSON.stringify(this.value));
    } catch {
      // As above.
    }
    for (const listener of this.listeners) listener();
  }
}
