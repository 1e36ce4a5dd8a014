/** What the tests of the page look at, for Node. */

export * from "./surface/basis";
export * from "./surface/tessellate";
export * from "./mcap/source";
export * from "./mcap/file";
export * from "./mcap/recording";
export * from "./mcap/overview";
export * from "./geometry";
export * from "./history";
export * from "./units";
export * from "./world";
export * from "./words";
export * from "./save";
export * from "./step";
export * from "./inside";
export * from "./sources/frames";
export { Fading } from "./sources/fading";
export { Live } from "./sources/live";
export { Playback } from "./sources/playback";
export { Hand, PERIOD_MS } from "./touch/hand";
export { liveTracks, recordedTracks } from "./ui/tracks";
