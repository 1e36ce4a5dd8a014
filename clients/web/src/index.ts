export { DecodeError, EncodeError, type DecodeFault } from "./errors";
export * from "./messages";
export { decode, decodeNamed, encode, encodingSchema, toJson, type MessageType, type Named } from "./wire";
