/*
 * A device loop with palpate.h: what a driver's servo thread does, behind a stub SDK and a stub bus.
 *
 *   cc -std=c99 -Wall -Wextra -Werror device_loop.c -o device_loop -lm && ./device_loop
 *
 * Replace sdk_* by OpenHaptics (hdGetDoublev, hdSetDoublev), DHD (dhdGetPosition, dhdSetForce) or CHAI3D, and
 * bus_* by zenoh-c or zenoh-pico: put the bytes of a pose under the pose's key with an id as its attachment, and
 * keep the newest bytes that arrive under the force's key, with theirs. Here the bus is a wall at z = 0.
 */
#include "palpate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PERIOD_NS 1000000u
#define FORCE_MAX_N 3.3
#define ID_BYTES 24

/* ---- stub SDK: a point that a hand moves up and down through z = 0, and motors that remember */

static double sdk_z;
static double sdk_motors[3];

static void sdk_get_position(uint64_t now_ns, double position[3]) {
  position[0] = 0.0;
  position[1] = 0.0;
  position[2] = sdk_z = 0.005 * cos(6.283185307179586 * (double)now_ns * 1e-9);
}

static void sdk_set_force(const double force[3]) { memcpy(sdk_motors, force, sizeof sdk_motors); }

/* ---- stub bus: answers every pose with the force of a wall, until it is cut */

static uint8_t bus_force[PALPATE_TOOL_FORCE_MAX_BYTES];
static size_t bus_force_size;
static uint8_t bus_force_id[ID_BYTES]; /* of the client whose pose it answers */
static uint64_t bus_forces;
static bool bus_cut;

static int bus_put_pose(const uint8_t *bytes, size_t size, const uint8_t id[ID_BYTES]) {
  palpate_tool_pose pose;
  palpate_tool_force force;
  int fault = palpate_tool_pose_decode(&pose, bytes, size);
  if (fault != PALPATE_OK || bus_cut) return fault;
  memset(&force, 0, sizeof force);
  force.tick = pose.seq;
  force.pose_seq = pose.seq;
  force.proxy_orientation[3] = 1.0;
  if (pose.position[2] < 0.0) force.force[2] = -1000.0 * pose.position[2];
  memcpy(bus_force_id, id, ID_BYTES);
  bus_forces++;
  return palpate_tool_force_encode(&force, bus_force, sizeof bus_force, &bus_force_size);
}

/* ---- the loop */

typedef struct device_loop {
  uint8_t id[ID_BYTES]; /* random: another client may hold the tool */
  uint64_t seq;
  uint64_t seen; /* forces taken from the bus */
  /* A driver must not keep the last force: this fades it when no other comes. */
  palpate_watchdog dog;
  double force[3];
} device_loop;

/* One servo period; gives a palpate_fault. The motors are always set, at worst to zero. */
static int device_loop_step(device_loop *loop, uint64_t now_ns) {
  double felt[3];
  uint8_t bytes[PALPATE_TOOL_POSE_MAX_BYTES];
  size_t size = 0;
  palpate_tool_pose pose;
  int fault, c;

  memset(&pose, 0, sizeof pose);
  pose.seq = ++loop->seq;
  pose.t_client_ns = now_ns;
  sdk_get_position(now_ns, pose.position);
  pose.orientation[3] = 1.0;
  fault = palpate_tool_pose_encode(&pose, bytes, sizeof bytes, &size);
  if (fault == PALPATE_OK) fault = bus_put_pose(bytes, size, loop->id);

  if (bus_forces != loop->seen) {
    palpate_tool_force force;
    int read = palpate_tool_force_decode(&force, bus_force, bus_force_size);
    uint32_t off = PALPATE_FORCE_FLAGS_STALE | PALPATE_FORCE_FLAGS_FAULT;
    loop->seen = bus_forces;
    if (read == PALPATE_OK && memcmp(bus_force_id, loop->id, ID_BYTES) != 0) {
      /* The force of another hand. */
    } else if (read == PALPATE_OK) {
      double size_n = sqrt(force.force[0] * force.force[0] + force.force[1] * force.force[1] +
                           force.force[2] * force.force[2]);
      double share = size_n > FORCE_MAX_N ? FORCE_MAX_N / size_n : 1.0;
      for (c = 0; c < 3; c++) loop->force[c] = (force.flags & off) != 0 ? 0.0 : share * force.force[c];
      palpate_watchdog_heard(&loop->dog, now_ns);
    } else {
      fault = read;
    }
  }
  for (c = 0; c < 3; c++) felt[c] = palpate_watchdog_gain(&loop->dog, now_ns) * loop->force[c];
  sdk_set_force(felt);
  return fault;
}

int main(void) {
  device_loop loop;
  uint64_t k;
  double peak = 0.0;
  uint64_t on = 0;
  memset(&loop, 0, sizeof loop);
  memcpy(loop.id, "24 bytes, better random", ID_BYTES);
  palpate_watchdog_init(&loop.dog, false);
  for (k = 1; k <= 1000; k++) {
    int fault;
    /* In the middle of a press the bus is cut. */
    if (k == 500) bus_cut = true;
    fault = device_loop_step(&loop, k * PERIOD_NS);
    if (fault != PALPATE_OK) {
      fprintf(stderr, "fault %d at period %lu\n", fault, (unsigned long)k);
      return 1;
    }
    if (sdk_motors[2] > peak) peak = sdk_motors[2];
    if (k >= 500 && sdk_motors[2] != 0.0) on = k - 499;
  }
  printf("peak %.2f N, motors off %lu ms after the last force\n", peak, (unsigned long)on);
  return peak > 3.2 && peak <= FORCE_MAX_N + 1e-9 && on <= 60 ? 0 : 2;
}
