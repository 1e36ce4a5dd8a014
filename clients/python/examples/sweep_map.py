#!/usr/bin/env python3
"""Makes the runs of a sweep on one thread and on the workers of several executors; prints what share of them it gets.

python3 sweep_map.py [SWEEP.toml] [--workers N] [--chunk N] [--quick]

The table is the same from all of them, to the last bit. Dask is measured where ``dask[distributed]`` is installed.
"""

import argparse
import contextlib
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import palpate as pp

SWEEP = """
scene = "builtin:rigid-teardrop"
for_s = 2.0
seeds = { from = 1, count = 10 }

[vary]
"tool.ball.coupling.stiffness_n_m" = { from = 200.0, to = 2000.0, count = 10, scale = "log" }
"tool.ball.device.force_max_n" = { from = 2.0, to = 10.0, count = 5 }

[[motion]]
name = "press"
hands.ball = { motion = "press", device = "touch", depth_m = 0.004 }
"""


@contextlib.contextmanager
def dask(workers: int) -> "Iterator[Callable[..., Any]]":
    """The map of so many processes of Dask."""
    from dask.distributed import Client, LocalCluster

    with tempfile.TemporaryDirectory() as folder:
        cluster = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None, local_directory=folder)
        with cluster, Client(cluster) as client:
            yield client.map


@contextlib.contextmanager
def of_pool(pool: Any) -> "Iterator[Callable[..., Any]]":
    """The map of an executor."""
    with pool:
        yield pool.map


def bytes_of(table: pp.SweepTable) -> bytes:
    """The table as a file."""
    with tempfile.TemporaryDirectory() as folder:
        table.write(Path(folder) / "table.csv")
        return (Path(folder) / "table.csv").read_bytes()


def main() -> None:
    parser = argparse.ArgumentParser(description="A sweep on several executors.")
    parser.add_argument("sweep", nargs="?", help="sweep file; without one, 500 runs of the rigid teardrop")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--chunk", type=int, default=1, help="runs of a task")
    parser.add_argument("--rounds", type=int, default=3, help="of which the best counts")
    parser.add_argument("--quick", action="store_true", help="few runs: to see that it works, not to measure")
    args = parser.parse_args()
    sweep: str = args.sweep or (SWEEP.replace("count = 10 }", "count = 1 }") if args.quick else SWEEP)
    rounds = 1 if args.quick else args.rounds

    makers: "dict[str, Callable[[], Any]]" = {
        "one thread": lambda: of_pool(ThreadPoolExecutor(1)),
        "threads": lambda: of_pool(ThreadPoolExecutor(args.workers)),
        "processes": lambda: of_pool(ProcessPoolExecutor(args.workers, get_context("spawn"))),
        "dask": lambda: dask(args.workers),
    }
    tables: "dict[str, bytes]" = {}
    alone_s = 0.0
    for name, make in makers.items():
        try:
            with make() as map:
                # Workers are there, and have the sweep.
                tables[name] = bytes_of(pp.sweep(sweep, map, chunk=args.chunk, cache=False))
                taken = []
                for _ in range(rounds):
                    begun = time.perf_counter()
                    runs = pp.sweep(sweep, map, chunk=args.chunk, cache=False).runs
                    taken.append(time.perf_counter() - begun)
        except ImportError as error:
            print(f"{name}: not measured, {error}")
            continue
        alone_s = alone_s or min(taken)
        workers = 1 if name == "one thread" else args.workers
        print(f"{name:>10}: {runs} runs, {runs / min(taken):.0f}/s, {alone_s / min(taken) / workers:.2f} of {workers} workers")
    print(f"same table from all: {len(set(tables.values())) == 1}")


if __name__ == "__main__":
    main()
