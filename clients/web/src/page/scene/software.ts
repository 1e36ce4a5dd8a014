/** Whether the browser draws WebGL on the processor. */

/** How such renderers name themselves: Chromium's, Mesa's, and those of Windows and macOS. */
const BY_PROCESSOR = /swiftshader|llvmpipe|softpipe|basic render|software/i;

/**
 * True if pictures are drawn by the processor, which the page then shares with whatever else runs there: often the
 * daemon itself. Asked of a canvas of its own, because antialiasing must be chosen before the picture's canvas is used.
 */
export function drawsInSoftware(): boolean {
  const probe = document.createElement("canvas").getContext("webgl2", { antialias: false, depth: false });
  if (probe === null) return false;
  const names = probe.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = probe.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER);
  // Browsers keep only a few contexts.
  probe.getExtension("WEBGL_lose_context")?.loseContext();
  return typeof name === "string" && BY_PROCESSOR.test(name);
}
