/** Light and dark: the colours of the style sheet, for what draws by itself. */

import type { Settings } from "../settings";

export interface Theme {
  readonly light: boolean;
  colour(name: string): string;
}

const system = matchMedia("(prefers-color-scheme: dark)");

export function onSystemTheme(listener: () => void): void {
  system.addEventListener("change", listener);
}

/** Puts the theme on the page and reads its colours. */
export function applyTheme(wanted: Settings["theme"]): Theme {
  const dark = wanted === "dark" || (wanted === "system" && system.matches);
  document.documentElement.dataset["theme"] = dark ? "dark" : "light";
  const style = getComputedStyle(document.documentElement);
  const known = new Map<string, string>();
  return {
    light: !dark,
    colour(name) {
      let value = known.get(name);
      if (value === undefined) known.set(name, (value = style.getPropertyValue(`--${name}`).trim()));
      return value;
    },
  };
}
