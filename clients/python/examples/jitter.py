#!/usr/bin/env python3
"""Moves a tool at 1 kHz from Python, in real time, and prints how even that is and how much was answered.

Python is no real-time system: a garbage collection or another process delays poses by milliseconds. The daemon holds
the newest pose meanwhile, and its own ticks do not depend on it.
"""

import argparse
import os
from pathlib import Path

import numpy as np

import palpate as pp

SCENE = {
    "body": [{"id": "ball", "surface": {"builtin": "sphere", "size": 0.02}}],
    "tool": [{"id": "probe", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"position": [0.0, 0.0, 0.04]}}],
}


def memory_mb() -> float:
    """Resident memory of this process (Linux)."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") * 1e-6
    except OSError:
        return float("nan")


def main() -> None:
    parser = argparse.ArgumentParser(description="Jitter of a 1 kHz tool in Python.")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--rate", type=float, default=1000.0)
    args = parser.parse_args()
    with pp.serve(SCENE, clock="realtime") as daemon, daemon.tool("probe") as probe:
        probe.run(lambda t, force: (0.0, 0.0, 0.031), rate=args.rate, seconds=0.5)  # warm up
        before, first = memory_mb(), daemon.status()
        report = probe.run(
            lambda t, force: (0.0, 0.0, 0.03 - 1e-3 * np.sin(5.0 * t)), rate=args.rate, seconds=args.seconds
        )
        last, after = daemon.status(), memory_mb()
    late = report.late * 1e6
    ticks = last.tick - first.tick
    (start,), (end,) = first.tools, last.tools
    print(f"{report.poses} poses in {report.seconds:.1f} s; {end.superseded - start.superseded} replaced before a tick used them")
    print(f"sent late: p50 {np.median(late):.0f} us, p99 {np.quantile(late, 0.99):.0f} us, worst {late.max():.0f} us")
    print(f"daemon: {ticks} ticks, {last.late_ticks - first.late_ticks} late, {last.skipped_ticks - first.skipped_ticks} skipped")
    print(f"memory {before:.1f} MB before, {after:.1f} MB after")
    print(f"answered {100.0 * report.forces / max(ticks, 1):.2f} % of ticks ({report.forces} forces)")


if __name__ == "__main__":
    main()
