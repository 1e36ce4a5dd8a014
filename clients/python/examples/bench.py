#!/usr/bin/env python3
"""Figures of the Python package on this machine: what it adds to the Rust crates that it wraps.

python3 bench.py [--quick] [--hour FILE.mcap] [--only step,batch,vary,closest,hour]

The Rust figures come from the same module: a run of many ticks inside one call, and closest points on one thread.
``--hour`` opens a recording of an hour; without it one is made from a minute of a recording, by the daemon, when
``--make-hour FILE`` says so (some minutes).
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import palpate as pp
from press_and_plot import SCENE

RIGID = {
    "name": "rigid",
    "body": [{"id": "ball", "surface": {"builtin": "sphere", "size": 0.02}}],
    "tool": [{"id": "probe", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"position": [0.0, 0.0, 0.04]}}],
}


def best(rounds: int, measure: Callable[[], float]) -> float:
    """The least of several measurements: the machine's other work only adds."""
    return min(measure() for _ in range(rounds))


def spent(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def step(quick: bool) -> None:
    """Cost of a step in Python beside that of the Rust step."""
    # Short and many: other work on the machine spoils long ones.
    ticks, rounds = (100, 3) if quick else (200, 150)
    for scene in (pp.Scene(RIGID), pp.Scene(SCENE)):
        tool = scene.tools[0]
        pose = scene.start(tool)
        sim, rust = scene.simulate(), scene.simulate()
        poses = {tool: pose}
        places = np.tile(pose.array(), (ticks, 1))

        def python(sim: pp.Simulation = sim, poses: "dict[str, pp.Pose]" = poses) -> None:
            for _ in range(ticks):
                sim.step(poses)

        def reading(sim: pp.Simulation = sim, poses: "dict[str, pp.Pose]" = poses, tool: str = tool) -> None:
            for _ in range(ticks):
                sim.step(poses).force[tool]

        sim.step(poses, 50), rust.step(poses, 50)
        inside = best(rounds, lambda rust=rust: spent(lambda: rust.step(ticks=ticks))) / ticks  # type: ignore[misc]
        outside = best(rounds, lambda: spent(python)) / ticks
        read = best(rounds, lambda: spent(reading)) / ticks
        traced = best(rounds, lambda rust=rust: spent(lambda: rust.run({tool: places}))) / ticks  # type: ignore[misc]
        print(
            f"step, {scene.name}: Rust {inside * 1e6:.2f} us, Python {outside * 1e6:.2f} us (+{(outside - inside) * 1e6:.2f}), "
            f"with force {read * 1e6:.2f} us (+{(read - inside) * 1e6:.2f}), run() {traced * 1e6:.2f} us"
        )


def batch(quick: bool) -> None:
    """Rate of a batch beside the Rust rate of one core times the cores."""
    cores = os.cpu_count() or 1
    n, ticks, rounds = (8, 20, 1) if quick else (64, 20, 40)
    for scene in (pp.Scene(RIGID), pp.Scene(SCENE)):
        single, many = scene.simulate(), pp.Batch(scene, n)
        tool = scene.tools[0]
        single.step({tool: scene.start(tool)}, 50)
        many.step(50)
        one = n * ticks / best(rounds, lambda single=single: spent(lambda: single.step(ticks=n * ticks)))  # type: ignore[misc]
        all = n * ticks / best(rounds, lambda many=many: spent(lambda: many.step(ticks)))  # type: ignore[misc]
        alone = pp.Batch(scene, n, workers=1)
        alone.step(50)
        serial = n * ticks / best(rounds, lambda alone=alone: spent(lambda: alone.step(ticks)))  # type: ignore[misc]
        print(
            f"batch, {scene.name}: Rust one core {one:.0f} ticks/s; batch of {n} with 1 worker {serial:.0f} "
            f"({serial / one:.2f}), with {many.workers} workers {all:.0f} ({all / one / cores:.2f} of {cores} cores)"
        )


def vary(quick: bool) -> None:
    """Copies that differ: how long they take to make, and their rate beside that of one of them alone times the cores."""
    cores = os.cpu_count() or 1
    n, rounds = (4, 1) if quick else (64, 7)
    teardrop = Path(__file__).resolve().parents[3] / "scenes" / "teardrop.toml"
    for scene in (pp.Scene.load(teardrop), pp.Scene(SCENE)):
        many, single = pp.Batch(scene, n), scene.simulate()
        stiffness, young = np.geomspace(200.0, 2000.0, n), np.geomspace(1e4, 4e4, n)
        coupled = best(rounds, lambda many=many, stiffness=stiffness: spent(  # type: ignore[misc]
            lambda: many.vary("tool/ball/coupling/stiffness_n_m", stiffness)))  # fmt: skip
        bodies = spent(lambda: many.vary("body/drop/material/young_pa", young))

        def pressed(step: "Callable[[float], object]") -> None:
            for x in np.linspace(0.05, 0.03, 5):
                step(float(x))

        def press_all(x: float, many: pp.Batch = many) -> None:
            many.pose("ball")[:, :3] = (x, 0.003, 0.045)
            many.step(10)

        def press_one(x: float, single: pp.Simulation = single) -> None:
            single.step({"ball": (x, 0.003, 0.045)}, 10)

        taken: "dict[str, list[float]]" = {"all": [], "one": []}
        for _ in range(rounds):
            many.reset(), single.reset()
            taken["all"].append(spent(lambda: pressed(press_all)))
            taken["one"].append(spent(lambda: pressed(press_one)))
        all, one = min(taken["all"]), min(taken["one"])
        print(
            f"vary, {scene.name}: {n} couplings {coupled / n * 1e3:.2f} ms a copy, {n} bodies {bodies / n * 1e3:.2f} ms a copy; "
            f"50 ticks of all {all:.3f} s, of one {one:.4f} s ({n * one / all / cores:.2f} of {cores} cores)"
        )


def closest(quick: bool) -> None:
    """Closest points on arrays; one thread has what the Rust loop has to do, plus the result's rows."""
    count = 5_000 if quick else 100_000
    drop = pp.Surface.builtin("teardrop")
    queries = np.random.default_rng(1).normal(size=(count, 3)) * 0.05
    drop.closest(queries[:100])
    rounds = 1 if quick else 7
    rust = best(rounds, lambda: spent(lambda: drop._closest_sum(queries)))
    one = best(rounds, lambda: spent(lambda: drop.closest(queries, workers=1, curvature=False)))
    curved = best(rounds, lambda: spent(lambda: drop.closest(queries, workers=1)))
    all = best(rounds, lambda: spent(lambda: drop.closest(queries)))
    print(
        f"closest, {count} points: Rust loop {rust / count * 1e6:.2f} us a point, array {one / count * 1e6:.2f} us "
        f"({rust / one:.3f} of the Rust speed), with curvature {curved / count * 1e6:.2f} us, all cores {all / count * 1e6:.2f} us"
    )


HOUR = """
import resource, sys, time
import palpate as pp
base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
begun = time.perf_counter()
recording = pp.open(sys.argv[1])
opened = time.perf_counter()
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
force = recording.ticks[recording.tools[0]].force
print(f"{opened - begun:.3f} s, {(peak - base) / 1024:.1f} MB more than {base / 1024:.0f} MB after import; "
      f"{len(force)} forces in {time.perf_counter() - opened:.2f} s, "
      f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB at most")
"""


def hour(path: Path) -> None:
    """Opening a long recording and reading the forces of one tool, in a process of its own."""
    done = subprocess.run([sys.executable, "-c", HOUR, str(path)], capture_output=True, text=True, check=True)
    print(f"recording, {path.stat().st_size / 1e6:.0f} MB: opened in {done.stdout.strip()}")


def make_hour(path: Path, seconds: float) -> None:
    """An hour of one tool in lockstep, as fast as the daemon records."""
    ticks = round(seconds * 1000)
    with pp.serve(RIGID, clock="lockstep", record=path) as daemon, daemon.tool("probe") as probe:
        probe.run(lambda t, force: (0.0, 0.0, 0.0305 - 1e-3 * np.sin(5.0 * t)), rate=1000.0, seconds=ticks * 1e-3)


def main() -> None:
    parser = argparse.ArgumentParser(description="Figures of the Python package.")
    parser.add_argument("--quick", action="store_true", help="small counts: to see that it runs, not to measure")
    parser.add_argument("--only", default="step,batch,vary,closest,hour")
    parser.add_argument("--hour", type=Path, help="a recording to open and read")
    parser.add_argument("--make-hour", type=Path, metavar="FILE", help="make such a recording first")
    parser.add_argument("--seconds", type=float, default=3600.0, help="of simulated time, with --make-hour")
    args = parser.parse_args()
    wanted = args.only.split(",")
    print(f"{pp.build_id()}, {os.cpu_count()} cores, Python {sys.version.split()[0]}, NumPy {np.__version__}")
    for name, measure in (("step", step), ("batch", batch), ("vary", vary), ("closest", closest)):
        if name in wanted:
            measure(args.quick)
    if args.make_hour is not None:
        print(f"made {args.make_hour} in {spent(lambda: make_hour(args.make_hour, args.seconds)):.0f} s")
    path = args.hour or args.make_hour
    if "hour" in wanted and path is not None:
        hour(path)
    else:
        print("recording: give --hour FILE, or --make-hour FILE; wrote nothing")


if __name__ == "__main__":
    main()
