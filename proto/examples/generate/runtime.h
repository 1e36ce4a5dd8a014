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
