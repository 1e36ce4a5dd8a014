/*
 * Reads forces, each after its length in two bytes (low first), and prints what they would do to a hand, N, a line a
 * millisecond, with the watchdog of palpate.h.
 */
#define _POSIX_C_SOURCE 200809L
#include "palpate.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static uint64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

int main(void) {
  static uint8_t bytes[4096];
  size_t have = 0;
  double newest = 0.0;
  palpate_watchdog dog;
  palpate_watchdog_init(&dog, false);
  for (;;) {
    struct pollfd input = {STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 1) > 0) {
      ssize_t count = read(STDIN_FILENO, bytes + have, sizeof bytes - have);
      if (count <= 0) return 0;
      have += (size_t)count;
      while (have >= 2 && have >= 2u + bytes[0] + 256u * bytes[1]) {
        size_t size = bytes[0] + 256u * bytes[1];
        palpate_tool_force force;
        if (palpate_tool_force_decode(&force, bytes + 2, size) != PALPATE_OK) return 1;
        newest = sqrt(force.force[0] * force.force[0] + force.force[1] * force.force[1] + force.force[2] * force.force[2]);
        palpate_watchdog_heard(&dog, now_ns());
        have -= 2 + size;
        memmove(bytes, bytes + 2 + size, have);
      }
    }
    if (printf("%g\n", palpate_watchdog_gain(&dog, now_ns()) * newest) < 0 || fflush(stdout) != 0) return 0;
  }
}
