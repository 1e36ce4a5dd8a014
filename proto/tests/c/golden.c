/* Decodes and encodes the golden messages with palpate.h, and runs its watchdog: golden DIRECTORY. */

#include "palpate.h"

#include <stdio.h>
#include <stdlib.h>

static int messages = 0;

static void fail(const char *file, const char *what) {
  fprintf(stderr, "%s: %s\n", file, what);
  exit(1);
}

static size_t read_file(const char *directory, const char *name, uint8_t *bytes, size_t room) {
  char path[1024];
  FILE *file;
  size_t size;
  if (snprintf(path, sizeof path, "%s/%s.bin", directory, name) >= (int)sizeof path) fail(name, "long path");
  file = fopen(path, "rb");
  if (file == NULL) fail(path, "is not there");
  size = fread(bytes, 1, room, file);
  fclose(file);
  return size;
}

/*
 * The message comes back byte for byte; cut anywhere it is truncated; with a byte more it has trailing bytes; with less
 * room it has none. Each attempt has memory of its own size, so that a checker of memory sees a byte too many.
 */
#define CHECK(TYPE, FILE_NAME)                                                                                         \
  do {                                                                                                                 \
    uint8_t golden[4096], back[4096];                                                                                  \
    size_t size, written;                                                                                              \
    palpate_##TYPE message;                                                                                            \
    size = read_file(directory, FILE_NAME, golden, sizeof golden - 1);                                                 \
    if (palpate_##TYPE##_decode(&message, golden, size) != PALPATE_OK) fail(FILE_NAME, "does not decode");             \
    if (palpate_##TYPE##_encode(&message, back, sizeof back, &written) != PALPATE_OK) fail(FILE_NAME, "no encoding");  \
    if (written != size || memcmp(golden, back, size) != 0) fail(FILE_NAME, "has other bytes");                        \
    for (size_t cut = 0; cut < size; cut++) {                                                                          \
      uint8_t *part = (uint8_t *)malloc(cut > 0 ? cut : 1);                                                            \
      if (part == NULL) fail(FILE_NAME, "no memory");                                                                  \
      memcpy(part, golden, cut);                                                                                       \
      if (palpate_##TYPE##_decode(&message, part, cut) != PALPATE_TRUNCATED) fail(FILE_NAME, "cut, is not truncated"); \
      free(part);                                                                                                      \
    }                                                                                                                  \
    golden[size] = 0;                                                                                                  \
    if (palpate_##TYPE##_decode(&message, golden, size + 1) == PALPATE_OK) fail(FILE_NAME, "took a byte more");        \
    if (palpate_##TYPE##_decode(&message, golden, size) != PALPATE_OK) fail(FILE_NAME, "does not decode again");       \
    if (palpate_##TYPE##_encode(&message, back, size - 1, &written) != PALPATE_NO_ROOM) fail(FILE_NAME, "had room");   \
    messages++;                                                                                                        \
  } while (0)

static void check_values(const char *directory) {
  uint8_t bytes[4096];
  char key[64];
  size_t size;
  palpate_tool_force force;
  palpate_contact_set set;
  palpate_contact contact;
  palpate_control_net net;
  palpate_reader items;
  palpate_sim_event event;
  int contacts = 0;
  double last = 0.0;

  size = read_file(directory, "tool_force", bytes, sizeof bytes);
  if (palpate_tool_force_decode(&force, bytes, size) != PALPATE_OK) fail("tool_force", "does not decode");
  if (force.tick != 70000 || force.pose_seq != 300 || force.t_server_ns != 9876543210u) fail("tool_force", "numbers");
  if (force.force[0] != -1.5 || force.torque[2] != 0.003 || force.depth != 0.002) fail("tool_force", "force");
  if (force.flags != (PALPATE_FORCE_FLAGS_SATURATED | PALPATE_FORCE_FLAGS_RAMPING)) fail("tool_force", "flags");

  size = read_file(directory, "contact_set", bytes, sizeof bytes);
  if (palpate_contact_set_decode(&set, bytes, size) != PALPATE_OK) fail("contact_set", "does not decode");
  items = palpate_items(&set.contacts);
  while (items.next != items.end) {
    palpate_contact_read(&items, &contact);
    if (items.fault != PALPATE_OK) fail("contact_set", "an item");
    contacts++;
  }
  if (contacts != 2 || contact.u != 0.5 || contact.tool.size != 5 || memcmp(contact.tool.data, "thumb", 5) != 0)
    fail("contact_set", "contacts");

  size = read_file(directory, "control_net", bytes, sizeof bytes);
  if (palpate_control_net_decode(&net, bytes, size) != PALPATE_OK) fail("control_net", "does not decode");
  if (net.points.count != 6 || !net.has_weights || net.weights.count != 6) fail("control_net", "counts");
  items = palpate_items(&net.points);
  while (items.next != items.end) last = palpate_read_f64(&items);
  if (last != 5.1) fail("control_net", "points");

  size = read_file(directory, "sim_event_overrun", bytes, sizeof bytes);
  if (palpate_sim_event_decode(&event, bytes, size) != PALPATE_OK) fail("sim_event_overrun", "does not decode");
  if (event.kind.number != PALPATE_EVENT_KIND_OVERRUN || event.kind.as.overrun.count != 400) fail("overrun", "count");
  size = read_file(directory, "sim_event_reset", bytes, sizeof bytes);
  bytes[size - 1] = 127;
  if (palpate_sim_event_decode(&event, bytes, size) != PALPATE_UNKNOWN_CASE) fail("sim_event", "an unknown kind");

  /* A count that the bytes cannot hold, a number of 65 bits, a bool of 2. */
  memset(bytes, 0xff, sizeof bytes);
  bytes[9] = 1;
  if (palpate_tool_force_decode(&force, bytes, 200) != PALPATE_MALFORMED &&
      palpate_tool_force_decode(&force, bytes, 200) != PALPATE_TRUNCATED)
    fail("tool_force", "took rubbish");
  bytes[9] = 2;
  if (palpate_tool_force_decode(&force, bytes, 200) != PALPATE_MALFORMED) fail("tool_force", "took 65 bits");
  bytes[0] = 0;
  memset(bytes + 1, 0xff, 8);
  bytes[9] = 0x7f;
  if (palpate_contact_set_decode(&set, bytes, 100) == PALPATE_OK) fail("contact_set", "took a hostile count");

  if (palpate_tool_pose_key(key, sizeof key, "default", "ball") != 30 ||
      strcmp(key, "palpate/default/tool/ball/pose") != 0)
    fail("tool_pose", key);
  if (palpate_loop_status_key(key, 10, "default") != 22 || key[0] != '\0') fail("loop_status", "a short key");
  if (strcmp(PALPATE_TOOL_POSE_SCHEMA, "postcard;palpate.ToolPose.v1") != 0) fail("tool_pose", "schema");
}

/* A line of golden/watchdog.csv. */
typedef struct line {
  int run, deadband;
  uint64_t time_ns;
  int comes;
  double gain;
  uint64_t silence_ns;
} line;

static void check_watchdog(void) {
  static const line lines[] = {
#include "watchdog.inc"
  };
  palpate_watchdog dog;
  int run = -1;
  palpate_watchdog_init(&dog, false);
  if (palpate_watchdog_gain(&dog, 7) != 0.0 || palpate_watchdog_silence_ns(&dog, 7) != UINT64_MAX)
    fail("watchdog", "before the first force");
  for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
    const line *at = &lines[k];
    double off;
    if (at->run != run) palpate_watchdog_init(&dog, at->deadband != 0);
    run = at->run;
    if (at->comes != 0) palpate_watchdog_heard(&dog, at->time_ns);
    off = palpate_watchdog_gain(&dog, at->time_ns) - at->gain;
    if (off > 1e-12 || off < -1e-12 || palpate_watchdog_silence_ns(&dog, at->time_ns) != at->silence_ns) {
      fprintf(stderr, "watchdog: run %d at %lu ns is off by %g\n", run, (unsigned long)at->time_ns, off);
      exit(1);
    }
  }
}

int main(int count, char **arguments) {
  const char *directory = count > 1 ? arguments[1] : ".";
  /* A CHECK for each golden file, which the test writes from what is there. */
#include "checks.inc"
  check_values(directory);
  check_watchdog();
  printf("%d messages\n", messages);
  return 0;
}
