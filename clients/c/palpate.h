/*
 * Bus messages of Palpate for C99 and C++: plain structs, their bytes, and the keys they travel on.
 * Nothing is allocated. SI units; quaternions are x y z w; world frame; times are nanoseconds.
 * docs/wire.md of the project says what each message is for.
 *
 * For each message: NAME_decode fills a struct from bytes, whose texts and lists point into them;
 * NAME_encode writes bytes; NAME_key writes the key expression. All but keys give a palpate_fault.
 *
 * Generated from proto/src/messages.rs by `cargo run -p palpate-proto --example generate`; do not
 * edit.
 */
#ifndef PALPATE_H
#define PALPATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* What can be wrong with bytes or with room for them. */
enum palpate_fault {
  PALPATE_OK = 0,
  /* The bytes end before the message does. */
  PALPATE_TRUNCATED,
  /* There are bytes after the end. */
  PALPATE_TRAILING_BYTES,
  /* More bytes than any such message has. */
  PALPATE_OVERSIZED,
  /* A choice whose number is not known. For the kind of an event: a newer daemon; skip that event. */
  PALPATE_UNKNOWN_CASE,
  /* A value that its type cannot have: a number too large, a bool of 2. */
  PALPATE_MALFORMED,
  /* The buffer to write into is too small. */
  PALPATE_NO_ROOM
};

/* Bytes not yet read; stops at the first fault. */
typedef struct palpate_reader {
  const uint8_t *next;
  const uint8_t *end;
  int fault;
} palpate_reader;

/* Room not yet written; stops at the first fault. */
typedef struct palpate_writer {
  uint8_t *next;
  uint8_t *end;
  int fault;
} palpate_writer;

/* UTF-8 within the bytes that were decoded, without a zero at its end. Not checked to be UTF-8. */
typedef struct palpate_text {
  const char *data;
  size_t size;
} palpate_text;

/*
 * Items within the bytes that were decoded, as they are on the wire. Read them one after another:
 *
 *   palpate_reader items = palpate_items(&set.contacts);
 *   while (items.next != items.end) palpate_contact_read(&items, &contact);
 */
typedef struct palpate_list {
  const uint8_t *bytes;
  size_t size;
  uint64_t count;
} palpate_list;

/* Reads the items of a list, which were checked when the message was decoded. */
static inline palpate_reader palpate_items(const palpate_list *list) {
  palpate_reader items;
  items.next = list->bytes;
  items.end = list->size > 0 ? list->bytes + list->size : list->bytes;
  items.fault = PALPATE_OK;
  return items;
}

static inline size_t palpate_left(const palpate_reader *reader) {
  return reader->next == reader->end ? 0 : (size_t)(reader->end - reader->next);
}

static inline uint8_t palpate_read_u8(palpate_reader *reader) {
  if (reader->fault != PALPATE_OK) return 0;
  if (reader->next == reader->end) {
    reader->fault = PALPATE_TRUNCATED;
    return 0;
  }
  return *reader->next++;
}

/* An unsigned number of at most `bits` bits: seven bits a byte, low ones first. */
static inline uint64_t palpate_read_varint(palpate_reader *reader, unsigned bits) {
  uint64_t value = 0;
  for (unsigned shift = 0; shift < bits; shift += 7) {
    const uint8_t byte = palpate_read_u8(reader);
    if (reader->fault != PALPATE_OK) return 0;
    if (bits - shift < 7 && (byte & 0x7fu) >> (bits - shift) != 0) break;
    value |= (uint64_t)(byte & 0x7fu) << shift;
    if (byte < 0x80u) return value;
  }
  reader->fault = PALPATE_MALFORMED;
  return 0;
}

static inline bool palpate_read_bool(palpate_reader *reader) {
  const uint8_t byte = palpate_read_u8(reader);
  if (byte > 1) reader->fault = PALPATE_MALFORMED;
  return byte == 1;
}

/* Eight bytes, IEEE 754, little-endian. */
static inline double palpate_read_f64(palpate_reader *reader) {
  double value;
  uint64_t word = 0;
  for (unsigned k = 0; k < 8; k++) word |= (uint64_t)palpate_read_u8(reader) << (8 * k);
  memcpy(&value, &word, sizeof value);
  return value;
}

/* How many items follow, each of at least `item` bytes. */
static inline uint64_t palpate_read_count(palpate_reader *reader, size_t item) {
  const uint64_t count = palpate_read_varint(reader, 64);
  if (reader->fault != PALPATE_OK) return 0;
  if (count > palpate_left(reader) / item) {
    reader->fault = PALPATE_TRUNCATED;
    return 0;
  }
  return count;
}

static inline palpate_text palpate_read_text(palpate_reader *reader) {
  palpate_text text;
  text.size = (size_t)palpate_read_count(reader, 1);
  text.data = (const char *)reader->next;
  if (text.size > 0) reader->next += text.size;
  return text;
}

static inline uint32_t palpate_read_case(palpate_reader *reader, uint32_t cases) {
  const uint32_t number = (uint32_t)palpate_read_varint(reader, 32);
  if (reader->fault == PALPATE_OK && number >= cases) reader->fault = PALPATE_UNKNOWN_CASE;
  return number;
}

/* What is wrong with a message after all of it was read. */
static inline int palpate_read_end(const palpate_reader *reader) {
  if (reader->fault != PALPATE_OK) return reader->fault;
  return reader->next == reader->end ? PALPATE_OK : PALPATE_TRAILING_BYTES;
}

static inline void palpate_write_u8(palpate_writer *writer, uint8_t value) {
  if (writer->next == writer->end) writer->fault = PALPATE_NO_ROOM;
  else *writer->next++ = value;
}

static inline void palpate_write_varint(palpate_writer *writer, uint64_t value) {
  for (; value >= 0x80u; value >>= 7) palpate_write_u8(writer, (uint8_t)(value | 0x80u));
  palpate_write_u8(writer, (uint8_t)value);
}

static inline void palpate_write_f64(palpate_writer *writer, double value) {
  uint64_t word;
  memcpy(&word, &value, sizeof word);
  for (unsigned k = 0; k < 8; k++) palpate_write_u8(writer, (uint8_t)(word >> (8 * k)));
}

static inline void palpate_write_bytes(palpate_writer *writer, const void *bytes, size_t size) {
  const uint8_t *from = (const uint8_t *)bytes;
  for (size_t k = 0; k < size; k++) palpate_write_u8(writer, from[k]);
}

static inline void palpate_write_text(palpate_writer *writer, palpate_text text) {
  palpate_write_varint(writer, text.size);
  palpate_write_bytes(writer, text.data, text.size);
}

static inline void palpate_write_list(palpate_writer *writer, palpate_list list) {
  palpate_write_varint(writer, list.count);
  palpate_write_bytes(writer, list.bytes, list.size);
}

/*
 * Joins parts of a key. Returns the length without the zero at its end; when that is not below
 * `room`, nothing but an empty text was written.
 */
static inline size_t palpate_join(char *out, size_t room, const char *const *parts, size_t count) {
  size_t length = 0;
  for (size_t k = 0; k < count; k++) length += strlen(parts[k]);
  if (length >= room) {
    if (room > 0) out[0] = '\0';
    return length;
  }
  for (size_t k = 0; k < count; k++) {
    const size_t size = strlen(parts[k]);
    memcpy(out, parts[k], size);
    out += size;
  }
  *out = '\0';
  return length;
}

/*
 * When a force is too old to act: a daemon that dies, is stopped or is cut off cannot send zero.
 *
 *   palpate_watchdog dog;
 *   palpate_watchdog_init(&dog, false);
 *   palpate_watchdog_heard(&dog, now_ns);         each time a force comes
 *   share = palpate_watchdog_gain(&dog, now_ns);  each servo period: of the newest force and torque
 *
 * The share is 1 while forces come, 0 within 60 ms of the last one (110 with a deadband), and rises to 1
 * over 100 ms when they come again. Times are of one clock that does not jump, such as CLOCK_MONOTONIC.
 */
typedef struct palpate_watchdog {
  uint64_t limit_ns;
  bool any;
  uint64_t last_ns;
  double gain;        /* when the last one came */
  uint64_t since_ns;  /* when forces began to come, at first or again, and the gain then */
  double from;
} palpate_watchdog;

/* Nothing has come yet. `deadband`: the device asked for one, so the daemon may leave forces out. */
static inline void palpate_watchdog_init(palpate_watchdog *dog, bool deadband) {
  memset(dog, 0, sizeof *dog);
  dog->limit_ns = deadband ? 100000000u : 50000000u;
}

/* How long ago the last force came, ns; UINT64_MAX before the first. */
static inline uint64_t palpate_watchdog_silence_ns(const palpate_watchdog *dog, uint64_t now_ns) {
  if (!dog->any) return UINT64_MAX;
  return now_ns > dog->last_ns ? now_ns - dog->last_ns : 0;
}

/* The share of the newest force and torque that may act now, 0 to 1; 0 before the first. */
static inline double palpate_watchdog_gain(const palpate_watchdog *dog, uint64_t now_ns) {
  const uint64_t age_ns = palpate_watchdog_silence_ns(dog, now_ns);
  const uint64_t held_ns = age_ns < dog->limit_ns ? age_ns : dog->limit_ns;
  /*
   * It rises for as long as forces have been coming: those that waited while this process or the link
   * stood still come all at once, and may be as old as that.
   */
  const double most = dog->from + (double)(dog->last_ns - dog->since_ns) / 1e8;
  double gain = dog->gain + (double)held_ns / 1e8;
  if (!dog->any) return 0.0;
  if (gain > most) gain = most;
  if (gain > 1.0) gain = 1.0;
  gain -= (double)(age_ns - held_ns) / 1e7;
  return gain > 0.0 ? gain : 0.0;
}

/* A force came. */
static inline void palpate_watchdog_heard(palpate_watchdog *dog, uint64_t now_ns) {
  const double gain = dog->any ? palpate_watchdog_gain(dog, now_ns) : 1.0;
  if (!dog->any || palpate_watchdog_silence_ns(dog, now_ns) > dog->limit_ns) {
    dog->since_ns = now_ns;
    dog->from = gain;
  }
  if (!dog->any || now_ns > dog->last_ns) dog->last_ns = now_ns;
  dog->gain = gain;
  dog->any = true;
}

/* Pose and velocity of a tool, sent by whoever holds it. World frame. */
typedef struct palpate_tool_pose {
  /* Counts the poses of this client from 1; must grow. */
  uint64_t seq;
  /* Sender's clock, ns; echoed in ToolForce so that the sender can measure its round trip. */
  uint64_t t_client_ns;
  /* Reference point of the tool, m. */
  double position[3];
  /* Unit quaternion x y z w. */
  double orientation[4];
  /* m/s. */
  double linear_velocity[3];
  /* rad/s. */
  double angular_velocity[3];
  /* Bit 0: grab. While it is set, the tool holds on to what it touches. */
  uint32_t buttons;
  /* Reserved, 0. */
  uint32_t flags;
} palpate_tool_pose;

static inline void palpate_tool_pose_read(palpate_reader *reader, palpate_tool_pose *out) {
  out->seq = palpate_read_varint(reader, 64);
  out->t_client_ns = palpate_read_varint(reader, 64);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->position[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    out->orientation[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->linear_velocity[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->angular_velocity[k0] = palpate_read_f64(reader);
  }
  out->buttons = (uint32_t)palpate_read_varint(reader, 32);
  out->flags = (uint32_t)palpate_read_varint(reader, 32);
}

static inline void palpate_tool_pose_write(palpate_writer *writer, const palpate_tool_pose *in) {
  palpate_write_varint(writer, in->seq);
  palpate_write_varint(writer, in->t_client_ns);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->position[k0]);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    palpate_write_f64(writer, in->orientation[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->linear_velocity[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->angular_velocity[k0]);
  }
  palpate_write_varint(writer, in->buttons);
  palpate_write_varint(writer, in->flags);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_TOOL_POSE_SCHEMA "postcard;palpate.ToolPose.v1"
/* Greatest size, bytes. */
#define PALPATE_TOOL_POSE_MAX_BYTES 134

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_tool_pose_decode(palpate_tool_pose *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_TOOL_POSE_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_tool_pose_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_tool_pose_encode(const palpate_tool_pose *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_tool_pose_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_TOOL_POSE_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_tool_pose_key(char *out, size_t room, const char *instance, const char *tool) {
  const char *const parts[] = {"palpate/", instance, "/tool/", tool, "/pose"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* Bits of buttons of ToolPose. */
/* While it is set, the tool holds on to what it touches. */
#define PALPATE_GRAB 1u

/* Bits of flags of ToolForce. */
/* The newest pose is older than the stale limit; the force ramps to zero. */
#define PALPATE_FORCE_FLAGS_STALE 1u
/* The force was limited to what the device can bear. */
#define PALPATE_FORCE_FLAGS_SATURATED 2u
/* The simulation is paused. */
#define PALPATE_FORCE_FLAGS_PAUSED 4u
/* The last pose was refused (a jump, or not finite). */
#define PALPATE_FORCE_FLAGS_REFUSED 8u
/* The force is being ramped up or down. */
#define PALPATE_FORCE_FLAGS_RAMPING 16u
/* The tick met a fault; the force is safe, not right. */
#define PALPATE_FORCE_FLAGS_FAULT 32u
/* The tool holds on to what it grabbed. */
#define PALPATE_FORCE_FLAGS_GRABBING 64u
/* A damper was added to keep the loop from making energy. */
#define PALPATE_FORCE_FLAGS_DAMPED 128u
/*
 * No force: the tool was seated inside a body, and its contact force was not small once since then.
 */
#define PALPATE_FORCE_FLAGS_WITHHELD 256u
/*
 * The force is less accurate than the scene asks for: the step of a body that the tool presses fell
 * back to another matrix or was shortened, quality is lowered, or the force may be off by more than
 * 5 % and 0.02 N.
 */
#define PALPATE_FORCE_FLAGS_DEGRADED 512u

/* The force a hand should feel: wrench on the tool, world axes, at the tool's reference point. */
typedef struct palpate_tool_force {
  /* Tick that made it. */
  uint64_t tick;
  /* seq of the pose that took effect (0: none yet). */
  uint64_t pose_seq;
  /* t_client_ns of that pose. */
  uint64_t t_client_ns;
  /* Server's clock when published, ns. */
  uint64_t t_server_ns;
  /* N. */
  double force[3];
  /* N·m. */
  double torque[3];
  /* Where the surface holds the tool back, m. */
  double proxy_position[3];
  /* x y z w. */
  double proxy_orientation[4];
  /* Penetration of the device's tool into the surface, m; 0 without contact. */
  double depth;
  /* Contact regions. */
  uint16_t contact_count;
  /* ForceFlags. */
  uint32_t flags;
} palpate_tool_force;

static inline void palpate_tool_force_read(palpate_reader *reader, palpate_tool_force *out) {
  out->tick = palpate_read_varint(reader, 64);
  out->pose_seq = palpate_read_varint(reader, 64);
  out->t_client_ns = palpate_read_varint(reader, 64);
  out->t_server_ns = palpate_read_varint(reader, 64);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->force[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->torque[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->proxy_position[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    out->proxy_orientation[k0] = palpate_read_f64(reader);
  }
  out->depth = palpate_read_f64(reader);
  out->contact_count = (uint16_t)palpate_read_varint(reader, 16);
  out->flags = (uint32_t)palpate_read_varint(reader, 32);
}

static inline void palpate_tool_force_write(palpate_writer *writer, const palpate_tool_force *in) {
  palpate_write_varint(writer, in->tick);
  palpate_write_varint(writer, in->pose_seq);
  palpate_write_varint(writer, in->t_client_ns);
  palpate_write_varint(writer, in->t_server_ns);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->force[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->torque[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->proxy_position[k0]);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    palpate_write_f64(writer, in->proxy_orientation[k0]);
  }
  palpate_write_f64(writer, in->depth);
  palpate_write_varint(writer, in->contact_count);
  palpate_write_varint(writer, in->flags);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_TOOL_FORCE_SCHEMA "postcard;palpate.ToolForce.v1"
/* Greatest size, bytes. */
#define PALPATE_TOOL_FORCE_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_tool_force_decode(palpate_tool_force *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_TOOL_FORCE_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_tool_force_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_tool_force_encode(const palpate_tool_force *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_tool_force_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_TOOL_FORCE_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_tool_force_key(char *out, size_t room, const char *instance, const char *tool) {
  const char *const parts[] = {"palpate/", instance, "/tool/", tool, "/force"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* ToolForce, and how far it may be off. Sent while somebody subscribes. */
typedef struct palpate_tool_force_v2 {
  /* Tick that made it. */
  uint64_t tick;
  /* seq of the pose that took effect (0: none yet). */
  uint64_t pose_seq;
  /* t_client_ns of that pose. */
  uint64_t t_client_ns;
  /* Server's clock when published, ns. */
  uint64_t t_server_ns;
  /* N. */
  double force[3];
  /* N·m. */
  double torque[3];
  /* Where the surface holds the tool back, m. */
  double proxy_position[3];
  /* x y z w. */
  double proxy_orientation[4];
  /* Penetration of the device's tool into the surface, m; 0 without contact. */
  double depth;
  /* Contact regions. */
  uint16_t contact_count;
  /* ForceFlags. */
  uint32_t flags;
  /*
   * How far the force may be from the one that the exact step of the same length would give from
   * the same state, N: an estimate, 0 on rigid bodies.
   */
  double error_n;
  /* Reserved for the force on a jaw, N or N·m; 0. */
  double jaw_force;
} palpate_tool_force_v2;

static inline void palpate_tool_force_v2_read(palpate_reader *reader, palpate_tool_force_v2 *out) {
  out->tick = palpate_read_varint(reader, 64);
  out->pose_seq = palpate_read_varint(reader, 64);
  out->t_client_ns = palpate_read_varint(reader, 64);
  out->t_server_ns = palpate_read_varint(reader, 64);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->force[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->torque[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->proxy_position[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    out->proxy_orientation[k0] = palpate_read_f64(reader);
  }
  out->depth = palpate_read_f64(reader);
  out->contact_count = (uint16_t)palpate_read_varint(reader, 16);
  out->flags = (uint32_t)palpate_read_varint(reader, 32);
  out->error_n = palpate_read_f64(reader);
  out->jaw_force = palpate_read_f64(reader);
}

static inline void palpate_tool_force_v2_write(palpate_writer *writer, const palpate_tool_force_v2 *in) {
  palpate_write_varint(writer, in->tick);
  palpate_write_varint(writer, in->pose_seq);
  palpate_write_varint(writer, in->t_client_ns);
  palpate_write_varint(writer, in->t_server_ns);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->force[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->torque[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->proxy_position[k0]);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    palpate_write_f64(writer, in->proxy_orientation[k0]);
  }
  palpate_write_f64(writer, in->depth);
  palpate_write_varint(writer, in->contact_count);
  palpate_write_varint(writer, in->flags);
  palpate_write_f64(writer, in->error_n);
  palpate_write_f64(writer, in->jaw_force);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_TOOL_FORCE_V2_SCHEMA "postcard;palpate.ToolForce.v2"
/* Greatest size, bytes. */
#define PALPATE_TOOL_FORCE_V2_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_tool_force_v2_decode(palpate_tool_force_v2 *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_TOOL_FORCE_V2_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_tool_force_v2_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_tool_force_v2_encode(const palpate_tool_force_v2 *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_tool_force_v2_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_TOOL_FORCE_V2_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_tool_force_v2_key(char *out, size_t room, const char *instance, const char *tool) {
  const char *const parts[] = {"palpate/", instance, "/tool/", tool, "/force_v2"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/*
 * What all contacts do to a tool, before anything is limited for the device: what a sensor between
 * tool and body would read. World axes, at the tool's reference point. Sent while somebody
 * subscribes.
 */
typedef struct palpate_tool_contact {
  /* Tick that made it. */
  uint64_t tick;
  /* seq of the pose that took effect (0: none yet). */
  uint64_t pose_seq;
  /* t_client_ns of that pose. */
  uint64_t t_client_ns;
  /* N. */
  double force[3];
  /* N·m. */
  double torque[3];
  /*
   * Net work done by the device on the loop since the start, J; what is below zero, the loop has
   * made.
   */
  double energy_j;
  /* Part of it that the passivity controller took away, J. */
  double dissipated_j;
  /* Greatest force that the loop gives this tool's device, N. */
  double force_limit;
} palpate_tool_contact;

static inline void palpate_tool_contact_read(palpate_reader *reader, palpate_tool_contact *out) {
  out->tick = palpate_read_varint(reader, 64);
  out->pose_seq = palpate_read_varint(reader, 64);
  out->t_client_ns = palpate_read_varint(reader, 64);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->force[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->torque[k0] = palpate_read_f64(reader);
  }
  out->energy_j = palpate_read_f64(reader);
  out->dissipated_j = palpate_read_f64(reader);
  out->force_limit = palpate_read_f64(reader);
}

static inline void palpate_tool_contact_write(palpate_writer *writer, const palpate_tool_contact *in) {
  palpate_write_varint(writer, in->tick);
  palpate_write_varint(writer, in->pose_seq);
  palpate_write_varint(writer, in->t_client_ns);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->force[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->torque[k0]);
  }
  palpate_write_f64(writer, in->energy_j);
  palpate_write_f64(writer, in->dissipated_j);
  palpate_write_f64(writer, in->force_limit);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_TOOL_CONTACT_SCHEMA "postcard;palpate.ToolContact.v1"
/* Greatest size, bytes. */
#define PALPATE_TOOL_CONTACT_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_tool_contact_decode(palpate_tool_contact *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_TOOL_CONTACT_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_tool_contact_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_tool_contact_encode(const palpate_tool_contact *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_tool_contact_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_TOOL_CONTACT_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_tool_contact_key(char *out, size_t room, const char *instance, const char *tool) {
  const char *const parts[] = {"palpate/", instance, "/tool/", tool, "/contact"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* What the device that holds a tool can do, as its client describes it. Zero where unknown. */
typedef struct palpate_device_info {
  /* Its name, at most 64 bytes, without control characters. */
  palpate_text name;
  /*
   * Directions in which it can push, 0 to 3. None, and none to turn: it has no motors, as a mouse.
   */
  uint8_t dof_force;
  /* Axes about which it can turn, 0 to 3. */
  uint8_t dof_torque;
  /* Box in which its tool can go, m. */
  double workspace[3];
  /* Greatest force, N. */
  double force_max;
  /* Greatest force that it can hold for long, N; at most force_max. */
  double force_continuous;
  /* Greatest torque, N·m. */
  double torque_max;
  /* Mass that the hand feels at its tool, kg. */
  double mass;
  /* Its own viscous damping, N·s/m. */
  double damping;
  /* Its own Coulomb friction, N. */
  double coulomb_friction;
  /* Step of its position sensor at the tool, m. */
  double encoder_resolution;
  /* Rate of its own loop, Hz. */
  double rate_hz;
  /* Delay between it and the daemon, one way, s. */
  double delay_s;
  /*
   * Relative change of the force below which a hand feels none (Weber fraction), 0 to 0.99; the
   * daemon then leaves such forces out. 0: every force is sent.
   */
  double deadband;
} palpate_device_info;

static inline void palpate_device_info_read(palpate_reader *reader, palpate_device_info *out) {
  out->name = palpate_read_text(reader);
  out->dof_force = palpate_read_u8(reader);
  out->dof_torque = palpate_read_u8(reader);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->workspace[k0] = palpate_read_f64(reader);
  }
  out->force_max = palpate_read_f64(reader);
  out->force_continuous = palpate_read_f64(reader);
  out->torque_max = palpate_read_f64(reader);
  out->mass = palpate_read_f64(reader);
  out->damping = palpate_read_f64(reader);
  out->coulomb_friction = palpate_read_f64(reader);
  out->encoder_resolution = palpate_read_f64(reader);
  out->rate_hz = palpate_read_f64(reader);
  out->delay_s = palpate_read_f64(reader);
  out->deadband = palpate_read_f64(reader);
}

static inline void palpate_device_info_write(palpate_writer *writer, const palpate_device_info *in) {
  palpate_write_text(writer, in->name);
  palpate_write_u8(writer, in->dof_force);
  palpate_write_u8(writer, in->dof_torque);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->workspace[k0]);
  }
  palpate_write_f64(writer, in->force_max);
  palpate_write_f64(writer, in->force_continuous);
  palpate_write_f64(writer, in->torque_max);
  palpate_write_f64(writer, in->mass);
  palpate_write_f64(writer, in->damping);
  palpate_write_f64(writer, in->coulomb_friction);
  palpate_write_f64(writer, in->encoder_resolution);
  palpate_write_f64(writer, in->rate_hz);
  palpate_write_f64(writer, in->delay_s);
  palpate_write_f64(writer, in->deadband);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_DEVICE_INFO_SCHEMA "postcard;palpate.DeviceInfo.v1"
/* Greatest size, bytes. */
#define PALPATE_DEVICE_INFO_MAX_BYTES 180

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_device_info_decode(palpate_device_info *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_DEVICE_INFO_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_device_info_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_device_info_encode(const palpate_device_info *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_device_info_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_DEVICE_INFO_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_device_info_key(char *out, size_t room, const char *instance, const char *tool) {
  const char *const parts[] = {"palpate/", instance, "/tool/", tool, "/device"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* Full control net of a body, u-major. The next one replaces a lost one. */
typedef struct palpate_control_net {
  /* Tick it belongs to. */
  uint64_t tick;
  /* Grows with every change of the net. */
  uint64_t revision;
  /* Body id. */
  palpate_text body;
  /* Degree in u. */
  uint8_t degree_u;
  /* Degree in v. */
  uint8_t degree_v;
  /* Rows (u). */
  uint16_t count_u;
  /* Columns (v). */
  uint16_t count_v;
  /* u-major: point (i, j) is number i * count_v + j, m. */
  palpate_list points;
  /* Weights of a rational surface, same order. */
  bool has_weights;
  palpate_list weights;
} palpate_control_net;

static inline void palpate_control_net_read(palpate_reader *reader, palpate_control_net *out) {
  out->tick = palpate_read_varint(reader, 64);
  out->revision = palpate_read_varint(reader, 64);
  out->body = palpate_read_text(reader);
  out->degree_u = palpate_read_u8(reader);
  out->degree_v = palpate_read_u8(reader);
  out->count_u = (uint16_t)palpate_read_varint(reader, 16);
  out->count_v = (uint16_t)palpate_read_varint(reader, 16);
  out->points.count = palpate_read_count(reader, 24);
  out->points.bytes = reader->next;
  if (out->points.count > 0) reader->next += (size_t)out->points.count * 24;
  out->points.size = out->points.count > 0 ? (size_t)(reader->next - out->points.bytes) : 0;
  out->has_weights = palpate_read_bool(reader);
  if (out->has_weights) {
    out->weights.count = palpate_read_count(reader, 8);
    out->weights.bytes = reader->next;
    if (out->weights.count > 0) reader->next += (size_t)out->weights.count * 8;
    out->weights.size = out->weights.count > 0 ? (size_t)(reader->next - out->weights.bytes) : 0;
  }
}

static inline void palpate_control_net_write(palpate_writer *writer, const palpate_control_net *in) {
  palpate_write_varint(writer, in->tick);
  palpate_write_varint(writer, in->revision);
  palpate_write_text(writer, in->body);
  palpate_write_u8(writer, in->degree_u);
  palpate_write_u8(writer, in->degree_v);
  palpate_write_varint(writer, in->count_u);
  palpate_write_varint(writer, in->count_v);
  palpate_write_list(writer, in->points);
  palpate_write_u8(writer, in->has_weights ? 1 : 0);
  if (in->has_weights) {
    palpate_write_list(writer, in->weights);
  }
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_CONTROL_NET_SCHEMA "postcard;palpate.ControlNet.v1"
/* Greatest size, bytes. */
#define PALPATE_CONTROL_NET_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_control_net_decode(palpate_control_net *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_CONTROL_NET_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_control_net_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_control_net_encode(const palpate_control_net *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_control_net_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_CONTROL_NET_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_control_net_key(char *out, size_t room, const char *instance, const char *body) {
  const char *const parts[] = {"palpate/", instance, "/body/", body, "/net"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* One contact of a tool with a body, or of two bodies. */
typedef struct palpate_contact {
  /*
   * Tool id; between two bodies, the id of the other body (the same one, when a body touches
   * itself).
   */
  palpate_text tool;
  /* Body id. */
  palpate_text body;
  /* Surface parameter. */
  double u;
  /* Surface parameter. */
  double v;
  /* Point on the body's surface, m. */
  double point[3];
  /* Outward unit normal of the body. */
  double normal[3];
  /* Penetration depth of the device's tool, m; between bodies, what the contact solve left. */
  double depth;
  /* This contact's share of the force on the tool (or other body), N. */
  double force[3];
} palpate_contact;

static inline void palpate_contact_read(palpate_reader *reader, palpate_contact *out) {
  out->tool = palpate_read_text(reader);
  out->body = palpate_read_text(reader);
  out->u = palpate_read_f64(reader);
  out->v = palpate_read_f64(reader);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->point[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->normal[k0] = palpate_read_f64(reader);
  }
  out->depth = palpate_read_f64(reader);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->force[k0] = palpate_read_f64(reader);
  }
}

static inline void palpate_contact_write(palpate_writer *writer, const palpate_contact *in) {
  palpate_write_text(writer, in->tool);
  palpate_write_text(writer, in->body);
  palpate_write_f64(writer, in->u);
  palpate_write_f64(writer, in->v);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->point[k0]);
  }
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->normal[k0]);
  }
  palpate_write_f64(writer, in->depth);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->force[k0]);
  }
}

/* Contacts that carry force in a tick, the deepest: 16, or 2 per tool if that is more. */
typedef struct palpate_contact_set {
  /* Tick. */
  uint64_t tick;
  /* Deepest first. */
  palpate_list contacts;
} palpate_contact_set;

static inline void palpate_contact_set_read(palpate_reader *reader, palpate_contact_set *out) {
  out->tick = palpate_read_varint(reader, 64);
  out->contacts.count = palpate_read_count(reader, 98);
  out->contacts.bytes = reader->next;
  for (uint64_t k0 = 0; k0 < out->contacts.count && reader->fault == PALPATE_OK; k0++) {
    palpate_contact item0;
    palpate_contact_read(reader, &item0);
  }
  out->contacts.size = out->contacts.count > 0 ? (size_t)(reader->next - out->contacts.bytes) : 0;
}

static inline void palpate_contact_set_write(palpate_writer *writer, const palpate_contact_set *in) {
  palpate_write_varint(writer, in->tick);
  palpate_write_list(writer, in->contacts);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_CONTACT_SET_SCHEMA "postcard;palpate.ContactSet.v1"
/* Greatest size, bytes. */
#define PALPATE_CONTACT_SET_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_contact_set_decode(palpate_contact_set *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_CONTACT_SET_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_contact_set_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_contact_set_encode(const palpate_contact_set *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_contact_set_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_CONTACT_SET_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_contact_set_key(char *out, size_t room, const char *instance) {
  const char *const parts[] = {"palpate/", instance, "/contact"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* A duration over the last status period. */
typedef struct palpate_quantiles {
  /* Median, ns. */
  uint64_t p50_ns;
  /* 99th percentile, ns. */
  uint64_t p99_ns;
  /* Maximum, ns. */
  uint64_t max_ns;
} palpate_quantiles;

static inline void palpate_quantiles_read(palpate_reader *reader, palpate_quantiles *out) {
  out->p50_ns = palpate_read_varint(reader, 64);
  out->p99_ns = palpate_read_varint(reader, 64);
  out->max_ns = palpate_read_varint(reader, 64);
}

static inline void palpate_quantiles_write(palpate_writer *writer, const palpate_quantiles *in) {
  palpate_write_varint(writer, in->p50_ns);
  palpate_write_varint(writer, in->p99_ns);
  palpate_write_varint(writer, in->max_ns);
}

/* What the loop does. */
enum {
  /* Ticking. */
  PALPATE_LOOP_STATE_RUNNING = 0,
  /* Paused by rpc. */
  PALPATE_LOOP_STATE_PAUSED = 1,
  /* Ramping forces down before the end. */
  PALPATE_LOOP_STATE_STOPPING = 2
};

typedef uint32_t palpate_loop_state;

static inline void palpate_loop_state_read(palpate_reader *reader, palpate_loop_state *out) {
  *out = palpate_read_case(reader, 3);
}

static inline void palpate_loop_state_write(palpate_writer *writer, const palpate_loop_state *in) {
  palpate_write_varint(writer, *in);
}

/* Counters of one tool's link. */
typedef struct palpate_tool_link {
  /* Tool id. */
  palpate_text tool;
  /* Poses received and accepted by the wire. */
  uint64_t received;
  /* Poses that a newer one replaced before a tick could use them. */
  uint64_t superseded;
  /* Another type or version in the encoding's schema. */
  uint64_t wrong_version;
  /* Not the bytes of a pose: truncated, or with bytes after its end. */
  uint64_t malformed;
  /* More bytes than a pose can have. */
  uint64_t oversized;
  /* A value that is NaN or infinite. */
  uint64_t not_finite;
  /* A quaternion whose length is not 1 within 1e-6. */
  uint64_t bad_quaternion;
  /* The number of the newest pose once more. */
  uint64_t duplicated;
  /* A number below that of the newest pose. */
  uint64_t out_of_order;
  /* Refused by the loop as a jump. */
  uint64_t jumps;
  /* Ticks whose newest pose was stale. */
  uint64_t stale_ticks;
  /* Net work done by the hand on the tool so far, J. */
  double energy_j;
  /* Forces sent to whoever moves it. */
  uint64_t forces_sent;
  /*
   * Forces that were not sent while somebody moved it, because a newer one was there: the daemon is
   * short of time.
   */
  uint64_t forces_overtaken;
  /* Forces that were sent and did not arrive, as far as its clients say what they receive. */
  uint64_t forces_lost;
} palpate_tool_link;

static inline void palpate_tool_link_read(palpate_reader *reader, palpate_tool_link *out) {
  out->tool = palpate_read_text(reader);
  out->received = palpate_read_varint(reader, 64);
  out->superseded = palpate_read_varint(reader, 64);
  out->wrong_version = palpate_read_varint(reader, 64);
  out->malformed = palpate_read_varint(reader, 64);
  out->oversized = palpate_read_varint(reader, 64);
  out->not_finite = palpate_read_varint(reader, 64);
  out->bad_quaternion = palpate_read_varint(reader, 64);
  out->duplicated = palpate_read_varint(reader, 64);
  out->out_of_order = palpate_read_varint(reader, 64);
  out->jumps = palpate_read_varint(reader, 64);
  out->stale_ticks = palpate_read_varint(reader, 64);
  out->energy_j = palpate_read_f64(reader);
  out->forces_sent = palpate_read_varint(reader, 64);
  out->forces_overtaken = palpate_read_varint(reader, 64);
  out->forces_lost = palpate_read_varint(reader, 64);
}

static inline void palpate_tool_link_write(palpate_writer *writer, const palpate_tool_link *in) {
  palpate_write_text(writer, in->tool);
  palpate_write_varint(writer, in->received);
  palpate_write_varint(writer, in->superseded);
  palpate_write_varint(writer, in->wrong_version);
  palpate_write_varint(writer, in->malformed);
  palpate_write_varint(writer, in->oversized);
  palpate_write_varint(writer, in->not_finite);
  palpate_write_varint(writer, in->bad_quaternion);
  palpate_write_varint(writer, in->duplicated);
  palpate_write_varint(writer, in->out_of_order);
  palpate_write_varint(writer, in->jumps);
  palpate_write_varint(writer, in->stale_ticks);
  palpate_write_f64(writer, in->energy_j);
  palpate_write_varint(writer, in->forces_sent);
  palpate_write_varint(writer, in->forces_overtaken);
  palpate_write_varint(writer, in->forces_lost);
}

/* What is being recorded. */
enum {
  /* Nothing. */
  PALPATE_RECORDER_STATE_OFF = 0,
  /* A file is being written. */
  PALPATE_RECORDER_STATE_RECORDING = 1,
  /* The last seconds are kept in memory; no file. */
  PALPATE_RECORDER_STATE_RING = 2,
  /* The disk refused; what was flushed stays readable. */
  PALPATE_RECORDER_STATE_FAILED = 3
};

typedef uint32_t palpate_recorder_state;

static inline void palpate_recorder_state_read(palpate_reader *reader, palpate_recorder_state *out) {
  *out = palpate_read_case(reader, 4);
}

static inline void palpate_recorder_state_write(palpate_writer *writer, const palpate_recorder_state *in) {
  palpate_write_varint(writer, *in);
}

/* Health of the loop, ten times a second. */
typedef struct palpate_loop_status {
  /* Newest tick. */
  uint64_t tick;
  /* What the loop does. */
  palpate_loop_state state;
  /* Nominal rate, Hz. */
  double rate_hz;
  /* Ticks that began more than 100 µs after their deadline. */
  uint64_t late_ticks;
  /* Deadlines dropped because a tick overran them. */
  uint64_t skipped_ticks;
  /* Time between tick starts. */
  palpate_quantiles period;
  /* Time in a tick. */
  palpate_quantiles step;
  /* One per tool. */
  palpate_list tools;
  /* What is being recorded. */
  palpate_recorder_state recorder;
  /* Bytes written by the recorder. */
  uint64_t recorder_bytes;
  /* Records lost because the recorder could not keep up. */
  uint64_t recorder_drops;
  /*
   * 0 is full quality; 1: bodies iterate once a step; 2: also fewer sweeps over contacts; 3: also
   * nets ten times rarer.
   */
  uint8_t quality_level;
  /* Tool whose poses the deadlines of ticks follow; empty: none. */
  palpate_text followed_tool;
  /* How far deadlines have moved from the fixed grid of the first tick, s. */
  double shift_s;
  /* Time from the arrival of a pose to the tick that took it; of each tick the longest. */
  palpate_quantiles wait;
} palpate_loop_status;

static inline void palpate_loop_status_read(palpate_reader *reader, palpate_loop_status *out) {
  out->tick = palpate_read_varint(reader, 64);
  palpate_loop_state_read(reader, &out->state);
  out->rate_hz = palpate_read_f64(reader);
  out->late_ticks = palpate_read_varint(reader, 64);
  out->skipped_ticks = palpate_read_varint(reader, 64);
  palpate_quantiles_read(reader, &out->period);
  palpate_quantiles_read(reader, &out->step);
  out->tools.count = palpate_read_count(reader, 23);
  out->tools.bytes = reader->next;
  for (uint64_t k0 = 0; k0 < out->tools.count && reader->fault == PALPATE_OK; k0++) {
    palpate_tool_link item0;
    palpate_tool_link_read(reader, &item0);
  }
  out->tools.size = out->tools.count > 0 ? (size_t)(reader->next - out->tools.bytes) : 0;
  palpate_recorder_state_read(reader, &out->recorder);
  out->recorder_bytes = palpate_read_varint(reader, 64);
  out->recorder_drops = palpate_read_varint(reader, 64);
  out->quality_level = palpate_read_u8(reader);
  out->followed_tool = palpate_read_text(reader);
  out->shift_s = palpate_read_f64(reader);
  palpate_quantiles_read(reader, &out->wait);
}

static inline void palpate_loop_status_write(palpate_writer *writer, const palpate_loop_status *in) {
  palpate_write_varint(writer, in->tick);
  palpate_loop_state_write(writer, &in->state);
  palpate_write_f64(writer, in->rate_hz);
  palpate_write_varint(writer, in->late_ticks);
  palpate_write_varint(writer, in->skipped_ticks);
  palpate_quantiles_write(writer, &in->period);
  palpate_quantiles_write(writer, &in->step);
  palpate_write_list(writer, in->tools);
  palpate_recorder_state_write(writer, &in->recorder);
  palpate_write_varint(writer, in->recorder_bytes);
  palpate_write_varint(writer, in->recorder_drops);
  palpate_write_u8(writer, in->quality_level);
  palpate_write_text(writer, in->followed_tool);
  palpate_write_f64(writer, in->shift_s);
  palpate_quantiles_write(writer, &in->wait);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_LOOP_STATUS_SCHEMA "postcard;palpate.LoopStatus.v4"
/* Greatest size, bytes. */
#define PALPATE_LOOP_STATUS_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_loop_status_decode(palpate_loop_status *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_LOOP_STATUS_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_loop_status_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_loop_status_encode(const palpate_loop_status *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_loop_status_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_LOOP_STATUS_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_loop_status_key(char *out, size_t room, const char *instance) {
  const char *const parts[] = {"palpate/", instance, "/status"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* What happened. */
enum {
  /* State set back to the scene's start. */
  PALPATE_EVENT_KIND_RESET = 0,
  /* Loop paused. */
  PALPATE_EVENT_KIND_PAUSED = 1,
  /* Loop resumed. */
  PALPATE_EVENT_KIND_RESUMED = 2,
  /* A tool sends poses. */
  PALPATE_EVENT_KIND_TOOL_JOINED = 3,
  /* No pose of a tool came for so long that the last one is stale. */
  PALPATE_EVENT_KIND_TOOL_LOST = 4,
  /* A pose was refused. */
  PALPATE_EVENT_KIND_POSE_REFUSED = 5,
  /* A tick met a fault. */
  PALPATE_EVENT_KIND_FAULT = 6,
  /* A recording began. */
  PALPATE_EVENT_KIND_RECORD_STARTED = 7,
  /* A recording ended. */
  PALPATE_EVENT_KIND_RECORD_STOPPED = 8,
  /* The daemon is going down. */
  PALPATE_EVENT_KIND_STOPPING = 9,
  /*
   * Ticks took longer than their period, or were woken too late: at most one such event a second
   * for each stage.
   */
  PALPATE_EVENT_KIND_OVERRUN = 10,
  /* The loop does less, or again more, to keep its rate. */
  PALPATE_EVENT_KIND_QUALITY_CHANGED = 11,
  /* A device said what it can do. */
  PALPATE_EVENT_KIND_DEVICE_TOLD = 12,
  /* A recording could not go on; the loop does, and what was flushed stays readable. */
  PALPATE_EVENT_KIND_RECORD_FAILED = 13,
  /* Another scene runs from this tick on: bodies were merged or moved. Ask for the scene anew. */
  PALPATE_EVENT_KIND_SCENE_CHANGED = 14,
  /*
   * A tool was seated inside a body: it gives no force until its contact force has been small once.
   */
  PALPATE_EVENT_KIND_FORCE_WITHHELD = 15,
  /* A tool's force is less accurate than the scene asks for, from now on. */
  PALPATE_EVENT_KIND_FORCE_DEGRADED = 16,
  /* A tool's force is as accurate as the scene asks for again. */
  PALPATE_EVENT_KIND_FORCE_RESTORED = 17
};

typedef struct palpate_event_kind {
  /* Number of the case; `as` has the fields of that one. */
  uint32_t number;
  union {
    struct {
      /* Tool id. */
      palpate_text tool;
    } tool_joined;
    struct {
      /* Tool id. */
      palpate_text tool;
    } tool_lost;
    struct {
      /* Tool id. */
      palpate_text tool;
      /* Why. */
      palpate_text reason;
    } pose_refused;
    struct {
      /* What and where. */
      palpate_text reason;
    } fault;
    struct {
      /* Path. */
      palpate_text path;
    } record_started;
    struct {
      /* Path. */
      palpate_text path;
    } record_stopped;
    struct {
      /*
       * Stage that took most of their time: latch, render, deform, hash, emit; wake: the system
       * came late.
       */
      palpate_text stage;
      /* How many since the last such event. */
      uint64_t count;
      /* The longest of them, ns. */
      uint64_t worst_ns;
    } overrun;
    struct {
      /* As quality_level of LoopStatus. */
      uint8_t level;
      /* Why. */
      palpate_text reason;
    } quality_changed;
    struct {
      /* Tool id. */
      palpate_text tool;
      /* Name of the device. */
      palpate_text name;
    } device_told;
    struct {
      /* Path. */
      palpate_text path;
      /* Words of the system. */
      palpate_text reason;
    } record_failed;
    struct {
      /* What became of which bodies. */
      palpate_text what;
    } scene_changed;
    struct {
      /* Tool id. */
      palpate_text tool;
    } force_withheld;
    struct {
      /* Tool id. */
      palpate_text tool;
      /* What is done instead. */
      palpate_text reason;
    } force_degraded;
    struct {
      /* Tool id. */
      palpate_text tool;
      /* In how many ticks it was not. */
      uint64_t ticks;
    } force_restored;
  } as;
} palpate_event_kind;

static inline void palpate_event_kind_read(palpate_reader *reader, palpate_event_kind *out) {
  out->number = palpate_read_case(reader, 18);
  switch (out->number) {
    case PALPATE_EVENT_KIND_TOOL_JOINED:
      out->as.tool_joined.tool = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_TOOL_LOST:
      out->as.tool_lost.tool = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_POSE_REFUSED:
      out->as.pose_refused.tool = palpate_read_text(reader);
      out->as.pose_refused.reason = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_FAULT:
      out->as.fault.reason = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_RECORD_STARTED:
      out->as.record_started.path = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_RECORD_STOPPED:
      out->as.record_stopped.path = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_OVERRUN:
      out->as.overrun.stage = palpate_read_text(reader);
      out->as.overrun.count = palpate_read_varint(reader, 64);
      out->as.overrun.worst_ns = palpate_read_varint(reader, 64);
      break;
    case PALPATE_EVENT_KIND_QUALITY_CHANGED:
      out->as.quality_changed.level = palpate_read_u8(reader);
      out->as.quality_changed.reason = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_DEVICE_TOLD:
      out->as.device_told.tool = palpate_read_text(reader);
      out->as.device_told.name = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_RECORD_FAILED:
      out->as.record_failed.path = palpate_read_text(reader);
      out->as.record_failed.reason = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_SCENE_CHANGED:
      out->as.scene_changed.what = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_FORCE_WITHHELD:
      out->as.force_withheld.tool = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_FORCE_DEGRADED:
      out->as.force_degraded.tool = palpate_read_text(reader);
      out->as.force_degraded.reason = palpate_read_text(reader);
      break;
    case PALPATE_EVENT_KIND_FORCE_RESTORED:
      out->as.force_restored.tool = palpate_read_text(reader);
      out->as.force_restored.ticks = palpate_read_varint(reader, 64);
      break;
    default:
      break;
  }
}

static inline void palpate_event_kind_write(palpate_writer *writer, const palpate_event_kind *in) {
  palpate_write_varint(writer, in->number);
  switch (in->number) {
    case PALPATE_EVENT_KIND_TOOL_JOINED:
      palpate_write_text(writer, in->as.tool_joined.tool);
      break;
    case PALPATE_EVENT_KIND_TOOL_LOST:
      palpate_write_text(writer, in->as.tool_lost.tool);
      break;
    case PALPATE_EVENT_KIND_POSE_REFUSED:
      palpate_write_text(writer, in->as.pose_refused.tool);
      palpate_write_text(writer, in->as.pose_refused.reason);
      break;
    case PALPATE_EVENT_KIND_FAULT:
      palpate_write_text(writer, in->as.fault.reason);
      break;
    case PALPATE_EVENT_KIND_RECORD_STARTED:
      palpate_write_text(writer, in->as.record_started.path);
      break;
    case PALPATE_EVENT_KIND_RECORD_STOPPED:
      palpate_write_text(writer, in->as.record_stopped.path);
      break;
    case PALPATE_EVENT_KIND_OVERRUN:
      palpate_write_text(writer, in->as.overrun.stage);
      palpate_write_varint(writer, in->as.overrun.count);
      palpate_write_varint(writer, in->as.overrun.worst_ns);
      break;
    case PALPATE_EVENT_KIND_QUALITY_CHANGED:
      palpate_write_u8(writer, in->as.quality_changed.level);
      palpate_write_text(writer, in->as.quality_changed.reason);
      break;
    case PALPATE_EVENT_KIND_DEVICE_TOLD:
      palpate_write_text(writer, in->as.device_told.tool);
      palpate_write_text(writer, in->as.device_told.name);
      break;
    case PALPATE_EVENT_KIND_RECORD_FAILED:
      palpate_write_text(writer, in->as.record_failed.path);
      palpate_write_text(writer, in->as.record_failed.reason);
      break;
    case PALPATE_EVENT_KIND_SCENE_CHANGED:
      palpate_write_text(writer, in->as.scene_changed.what);
      break;
    case PALPATE_EVENT_KIND_FORCE_WITHHELD:
      palpate_write_text(writer, in->as.force_withheld.tool);
      break;
    case PALPATE_EVENT_KIND_FORCE_DEGRADED:
      palpate_write_text(writer, in->as.force_degraded.tool);
      palpate_write_text(writer, in->as.force_degraded.reason);
      break;
    case PALPATE_EVENT_KIND_FORCE_RESTORED:
      palpate_write_text(writer, in->as.force_restored.tool);
      palpate_write_varint(writer, in->as.force_restored.ticks);
      break;
    default:
      break;
  }
}

/* An event, numbered so that a loss is seen. */
typedef struct palpate_sim_event {
  /* Tick. */
  uint64_t tick;
  /* Counts events from 1. */
  uint64_t seq;
  /* Server clock, ns since the Unix epoch. */
  uint64_t t_ns;
  /* What. */
  palpate_event_kind kind;
} palpate_sim_event;

static inline void palpate_sim_event_read(palpate_reader *reader, palpate_sim_event *out) {
  out->tick = palpate_read_varint(reader, 64);
  out->seq = palpate_read_varint(reader, 64);
  out->t_ns = palpate_read_varint(reader, 64);
  palpate_event_kind_read(reader, &out->kind);
}

static inline void palpate_sim_event_write(palpate_writer *writer, const palpate_sim_event *in) {
  palpate_write_varint(writer, in->tick);
  palpate_write_varint(writer, in->seq);
  palpate_write_varint(writer, in->t_ns);
  palpate_event_kind_write(writer, &in->kind);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_SIM_EVENT_SCHEMA "postcard;palpate.SimEvent.v1"
/* Greatest size, bytes. */
#define PALPATE_SIM_EVENT_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_sim_event_decode(palpate_sim_event *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_SIM_EVENT_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_sim_event_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_sim_event_encode(const palpate_sim_event *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_sim_event_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_SIM_EVENT_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_sim_event_key(char *out, size_t room, const char *instance) {
  const char *const parts[] = {"palpate/", instance, "/event"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

/* A body as the loop simulates it. */
typedef struct palpate_body_snapshot {
  /* Id. */
  palpate_text id;
  /* Model name: rigid, lattice. */
  palpate_text model;
  /* Degree, u then v. */
  uint8_t degree[2];
  /* Periodic, u then v. */
  bool periodic[2];
  /* Knots in u and in v, in the convention of palpate.surface.v1. */
  palpate_list knots[2];
  /* Net size, u then v. */
  uint16_t count[2];
  /* Net now, u-major, m. */
  palpate_list points;
  /* Net at rest, u-major, m. */
  palpate_list rest_points;
  /* Weights, if rational. */
  bool has_weights;
  palpate_list weights;
  /* Revision of points. */
  uint64_t revision;
} palpate_body_snapshot;

static inline void palpate_body_snapshot_read(palpate_reader *reader, palpate_body_snapshot *out) {
  out->id = palpate_read_text(reader);
  out->model = palpate_read_text(reader);
  for (size_t k0 = 0; k0 < 2; k0++) {
    out->degree[k0] = palpate_read_u8(reader);
  }
  for (size_t k0 = 0; k0 < 2; k0++) {
    out->periodic[k0] = palpate_read_bool(reader);
  }
  for (size_t k0 = 0; k0 < 2; k0++) {
    out->knots[k0].count = palpate_read_count(reader, 8);
    out->knots[k0].bytes = reader->next;
    if (out->knots[k0].count > 0) reader->next += (size_t)out->knots[k0].count * 8;
    out->knots[k0].size = out->knots[k0].count > 0 ? (size_t)(reader->next - out->knots[k0].bytes) : 0;
  }
  for (size_t k0 = 0; k0 < 2; k0++) {
    out->count[k0] = (uint16_t)palpate_read_varint(reader, 16);
  }
  out->points.count = palpate_read_count(reader, 24);
  out->points.bytes = reader->next;
  if (out->points.count > 0) reader->next += (size_t)out->points.count * 24;
  out->points.size = out->points.count > 0 ? (size_t)(reader->next - out->points.bytes) : 0;
  out->rest_points.count = palpate_read_count(reader, 24);
  out->rest_points.bytes = reader->next;
  if (out->rest_points.count > 0) reader->next += (size_t)out->rest_points.count * 24;
  out->rest_points.size = out->rest_points.count > 0 ? (size_t)(reader->next - out->rest_points.bytes) : 0;
  out->has_weights = palpate_read_bool(reader);
  if (out->has_weights) {
    out->weights.count = palpate_read_count(reader, 8);
    out->weights.bytes = reader->next;
    if (out->weights.count > 0) reader->next += (size_t)out->weights.count * 8;
    out->weights.size = out->weights.count > 0 ? (size_t)(reader->next - out->weights.bytes) : 0;
  }
  out->revision = palpate_read_varint(reader, 64);
}

static inline void palpate_body_snapshot_write(palpate_writer *writer, const palpate_body_snapshot *in) {
  palpate_write_text(writer, in->id);
  palpate_write_text(writer, in->model);
  for (size_t k0 = 0; k0 < 2; k0++) {
    palpate_write_u8(writer, in->degree[k0]);
  }
  for (size_t k0 = 0; k0 < 2; k0++) {
    palpate_write_u8(writer, in->periodic[k0] ? 1 : 0);
  }
  for (size_t k0 = 0; k0 < 2; k0++) {
    palpate_write_list(writer, in->knots[k0]);
  }
  for (size_t k0 = 0; k0 < 2; k0++) {
    palpate_write_varint(writer, in->count[k0]);
  }
  palpate_write_list(writer, in->points);
  palpate_write_list(writer, in->rest_points);
  palpate_write_u8(writer, in->has_weights ? 1 : 0);
  if (in->has_weights) {
    palpate_write_list(writer, in->weights);
  }
  palpate_write_varint(writer, in->revision);
}

/* A tool of the scene. */
typedef struct palpate_tool_snapshot {
  /* Id. */
  palpate_text id;
  /* point, sphere, plane, implicit, mesh or surface. */
  palpate_text shape;
  /* Radius of a sphere, else 0, m. */
  double radius;
  /* Stiffness of the virtual coupling, N/m (infinite: the tool is rigid). */
  double stiffness;
  /* Damping of the virtual coupling, N·s/m. */
  double damping;
  /* Greatest force, N. */
  double force_max;
  /* Proxy position now, m. */
  double position[3];
  /* x y z w. */
  double orientation[4];
} palpate_tool_snapshot;

static inline void palpate_tool_snapshot_read(palpate_reader *reader, palpate_tool_snapshot *out) {
  out->id = palpate_read_text(reader);
  out->shape = palpate_read_text(reader);
  out->radius = palpate_read_f64(reader);
  out->stiffness = palpate_read_f64(reader);
  out->damping = palpate_read_f64(reader);
  out->force_max = palpate_read_f64(reader);
  for (size_t k0 = 0; k0 < 3; k0++) {
    out->position[k0] = palpate_read_f64(reader);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    out->orientation[k0] = palpate_read_f64(reader);
  }
}

static inline void palpate_tool_snapshot_write(palpate_writer *writer, const palpate_tool_snapshot *in) {
  palpate_write_text(writer, in->id);
  palpate_write_text(writer, in->shape);
  palpate_write_f64(writer, in->radius);
  palpate_write_f64(writer, in->stiffness);
  palpate_write_f64(writer, in->damping);
  palpate_write_f64(writer, in->force_max);
  for (size_t k0 = 0; k0 < 3; k0++) {
    palpate_write_f64(writer, in->position[k0]);
  }
  for (size_t k0 = 0; k0 < 4; k0++) {
    palpate_write_f64(writer, in->orientation[k0]);
  }
}

/* Everything a late joiner needs. */
typedef struct palpate_scene_snapshot {
  /* Tick. */
  uint64_t tick;
  /* SHA-256 of the scene file. */
  uint8_t scene_hash[32];
  /* Scene name. */
  palpate_text scene_name;
  /* Length of a tick, ns. */
  uint64_t dt_ns;
  /* True when a tick waits for every tool's next pose. */
  bool lockstep;
  /* Bodies. */
  palpate_list bodies;
  /* Tools. */
  palpate_list tools;
} palpate_scene_snapshot;

static inline void palpate_scene_snapshot_read(palpate_reader *reader, palpate_scene_snapshot *out) {
  out->tick = palpate_read_varint(reader, 64);
  for (size_t k0 = 0; k0 < 32; k0++) {
    out->scene_hash[k0] = palpate_read_u8(reader);
  }
  out->scene_name = palpate_read_text(reader);
  out->dt_ns = palpate_read_varint(reader, 64);
  out->lockstep = palpate_read_bool(reader);
  out->bodies.count = palpate_read_count(reader, 14);
  out->bodies.bytes = reader->next;
  for (uint64_t k0 = 0; k0 < out->bodies.count && reader->fault == PALPATE_OK; k0++) {
    palpate_body_snapshot item0;
    palpate_body_snapshot_read(reader, &item0);
  }
  out->bodies.size = out->bodies.count > 0 ? (size_t)(reader->next - out->bodies.bytes) : 0;
  out->tools.count = palpate_read_count(reader, 90);
  out->tools.bytes = reader->next;
  for (uint64_t k0 = 0; k0 < out->tools.count && reader->fault == PALPATE_OK; k0++) {
    palpate_tool_snapshot item0;
    palpate_tool_snapshot_read(reader, &item0);
  }
  out->tools.size = out->tools.count > 0 ? (size_t)(reader->next - out->tools.bytes) : 0;
}

static inline void palpate_scene_snapshot_write(palpate_writer *writer, const palpate_scene_snapshot *in) {
  palpate_write_varint(writer, in->tick);
  for (size_t k0 = 0; k0 < 32; k0++) {
    palpate_write_u8(writer, in->scene_hash[k0]);
  }
  palpate_write_text(writer, in->scene_name);
  palpate_write_varint(writer, in->dt_ns);
  palpate_write_u8(writer, in->lockstep ? 1 : 0);
  palpate_write_list(writer, in->bodies);
  palpate_write_list(writer, in->tools);
}

/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_SCENE_SNAPSHOT_SCHEMA "postcard;palpate.SceneSnapshot.v1"
/* Greatest size, bytes. */
#define PALPATE_SCENE_SNAPSHOT_MAX_BYTES 16777216

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_scene_snapshot_decode(palpate_scene_snapshot *out, const uint8_t *bytes, size_t size) {
  palpate_reader reader;
  if (size > PALPATE_SCENE_SNAPSHOT_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_scene_snapshot_read(&reader, out);
  return palpate_read_end(&reader);
}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_scene_snapshot_encode(const palpate_scene_snapshot *in, uint8_t *bytes, size_t room, size_t *size) {
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_scene_snapshot_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_SCENE_SNAPSHOT_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}

/* Key of the message; see palpate_join. An id may be "*" to subscribe to all. */
static inline size_t palpate_scene_snapshot_key(char *out, size_t room, const char *instance) {
  const char *const parts[] = {"palpate/", instance, "/scene"};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}

#endif
