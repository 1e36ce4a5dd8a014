/** What can be wrong with bytes that came. */
export type DecodeFault =
  /** Another type or version than expected, or one that is not known here. */
  | "wrong-schema"
  /** The bytes end before the message does. */
  | "truncated"
  /** There are bytes after the end. */
  | "trailing-bytes"
  /** More bytes than any such message has. */
  | "oversized"
  /** A choice whose number is not known. For the kind of an event: a newer daemon; skip that event. */
  | "unknown-case"
  /** A value that its type cannot have: a number too large, a bool of 2, text that is not UTF-8. */
  | "malformed";

/** Bytes that are not the message expected. */
export class DecodeError extends Error {
  override readonly name = "DecodeError";
  /** Name of the type, once known. */
  type = "";
  /** Field in which reading stopped, for example `contacts.force`. */
  field = "";

  constructor(
    readonly fault: DecodeFault,
    readonly reason: string,
  ) {
    super(reason);
  }

  /** Notes the field that was being read; called from the innermost outwards. */
  inside(field: string): void {
    this.field = this.field === "" ? field : `${field}.${this.field}`;
  }

  /** Notes the type and words the message. */
  of(type: string): this {
    this.type = type;
    this.message = `not a ${type}: ${this.reason}` + (this.field === "" ? "" : ` (in ${this.field})`);
    return this;
  }
}

/** A message with a value that its type cannot have. */
export class EncodeError extends Error {
  override readonly name = "EncodeError";
}
