export { DecodeError, EncodeError, type DecodeFault } from "./errors";
export * from "./events";
export * from "./messages";
export { Watchdog } from "./watchdog";
export { decode, decodeNamed, encode, encodingSchema, keyOf, toJson, type MessageType, type Named } from "./wire";
