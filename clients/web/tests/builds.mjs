// Recordings as other builds made them.

/** The recording with its scene under another name, as if a build without scenes had made it. */
export function withoutScene(bytes) {
  const changed = Buffer.from(bytes);
  for (let at = changed.indexOf("scene.snapshot"); at >= 0; at = changed.indexOf("scene.snapshot", at)) {
    changed.write("other.snapshot", at, "latin1");
  }
  return changed;
}
