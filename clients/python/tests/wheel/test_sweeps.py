"""Sweeps on executors: the table is that of ``palpate batch`` byte for byte, whoever makes the runs."""

import functools
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palpate as pp
from palpate import _sweeps

SCENE = """
name = "probed"

[[body]]
id = "ball"
surface = { file = "ball.json" }

[[tool]]
id = "probe"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.0, 0.0, 0.04] }
"""

SWEEP = """
scene = "scene.toml"
for_s = 0.1
seeds = [3, 5]
columns = ["rms_contact_force"]

[vary]
"tool.probe.coupling.stiffness_n_m" = [300.0, 500.0, -1.0]
"tool.probe.device.passivity" = [true, false]

[[motion]]
name = "press, deep"
hands.probe = { motion = "press", device = "touch", hand = "relaxed", depth_m = 0.002 }

[[motion]]
name = "own"
hands.probe = { motion = "own.toml" }
"""

OWN = """
waypoint = [{ time_s = 0.0, position = [0.0, 0.0, 0.04] }, { time_s = 0.1, position = [0.0, 0.0, 0.028] }]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sweep")
    pp.Surface.builtin("sphere", size=0.02).save(folder / "ball.json")
    for name, text in (("scene.toml", SCENE), ("own.toml", OWN), ("sweep.toml", SWEEP)):
        (folder / name).write_text(text, "utf-8")
    return folder


def batch(sweep: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "palpate", "batch", str(sweep), "--no-cache", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def wanted(folder: Path) -> "dict[str, bytes]":
    """What the program writes."""
    files = [folder / f"results.{kind}" for kind in ("csv", "json", "parquet")]
    run = batch(folder / "sweep.toml", *(f"-o{file}" for file in files))
    assert run.returncode == 3, run.stdout + run.stderr
    return {file.suffix: file.read_bytes() for file in files}


def written(table: pp.SweepTable, folder: Path) -> "dict[str, bytes]":
    files = [folder / f"own.{kind}" for kind in ("csv", "json", "parquet")]
    for file in files:
        table.write(file)
    return {file.suffix: file.read_bytes() for file in files}


def test_every_map_gives_the_table_of_the_program(folder: Path, wanted: "dict[str, bytes]", tmp_path: Path) -> None:
    sweep = folder / "sweep.toml"
    table = pp.sweep(sweep, map, cache=False)
    assert written(table, tmp_path) == wanted
    assert (table.runs, table.failed, table.known) == (24, 8, 0)
    assert written(pp.sweep(sweep, cache=False, chunk=5), tmp_path) == wanted
    with ThreadPoolExecutor(3) as pool:
        assert written(pp.sweep(sweep, pool.map, cache=False), tmp_path) == wanted
        assert written(pp.sweep(sweep, functools.partial(submitted, pool), cache=False), tmp_path) == wanted
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        assert written(pp.sweep(sweep, pool.map, cache=False, chunk=2), tmp_path) == wanted
    with get_context("spawn").Pool(2) as workers:
        assert written(pp.sweep(sweep, workers.imap_unordered, cache=False), tmp_path) == wanted


def submitted(pool: Any, work: Any, tasks: "list[Any]") -> "list[Any]":
    return [pool.submit(work, task) for task in tasks]


def test_columns_are_arrays_and_a_pandas_table(folder: Path) -> None:
    table = pp.sweep(folder / "sweep.toml", cache=False, timings=True)
    np.testing.assert_array_equal(table["run"], np.arange(24))
    assert table["tool.probe.coupling.stiffness_n_m"].dtype == np.float64 and table["seed"].dtype == np.int64
    failed = table["tool.probe.coupling.stiffness_n_m"] < 0.0
    assert [error is not None for error in table["error"]] == failed.tolist()
    np.testing.assert_array_equal(np.isnan(table["rms_contact_force"]), failed)
    assert table["wall_s"][~failed].min() > 0.0
    with pytest.raises(KeyError, match="no column 'force'; it has run, motion"):
        table["force"]
    pandas = pytest.importorskip("pandas")
    frame = table.to_pandas()
    assert list(frame) == list(table) and len(frame) == table.runs
    assert isinstance(frame, pandas.DataFrame)


def test_texts_and_dictionaries_are_sweeps(folder: Path) -> None:
    known = pp.sweep(folder / "sweep.toml", cache=False)["key"].tolist()
    assert pp.sweep(SWEEP, directory=folder, cache=False)["key"].tolist() == known
    tool = {"tool.probe.coupling.stiffness_n_m": np.array([300.0, 500.0, -1.0]), "tool.probe.device.passivity": [True, False]}
    motions = [
        {"name": "press, deep", "hands": {"probe": {"motion": "press", "device": "touch", "hand": "relaxed", "depth_m": 0.002}}},
        {"name": "own", "hands": {"probe": {"motion": "own.toml"}}},
    ]
    sweep = {"scene": "scene.toml", "for_s": 0.1, "seeds": [3, 5], "columns": ["rms_contact_force"], "vary": tool}
    assert pp.sweep({**sweep, "motion": motions}, directory=folder, cache=False)["key"].tolist() == known


def test_workers_need_no_files(folder: Path, tmp_path: Path, wanted: "dict[str, bytes]") -> None:
    there = tmp_path / "there"
    shutil.copytree(folder, there)
    gone = SWEEP.replace("[vary]", '[vary]\n"body.ball.surface.file" = ["ball.json", "none.json"]')
    (there / "sweep.toml").write_text(gone, "utf-8")
    here = pp.sweep(there / "sweep.toml", cache=False)

    def elsewhere(work: Any, tasks: "list[Any]") -> "list[Any]":
        shutil.rmtree(there)
        _sweeps._opened.cache_clear()
        return [work(task) for task in tasks]

    apart = pp.sweep(there / "sweep.toml", elsewhere, cache=False)
    for name in here:
        np.testing.assert_array_equal(here[name], apart[name])
    assert any("none.json" in str(error) for error in apart["error"])
    packed = _sweeps._packed(folder / "sweep.toml", "")
    other = (("another", "build"), *packed[1:])
    with pytest.raises(pp.SweepError, match="workers need the build of palpate"):
        _sweeps._make(other, None, [0])


def killed(pids: "Callable[[], list[int]]", work: Any, pool: Any, tasks: "list[Any]") -> "Iterator[Any]":
    """Hands out all tasks, and kills a worker when the first is back."""
    futures = [pool.submit(work, task) for task in tasks]
    yield futures[0].result()
    os.kill(pids()[0], signal.SIGKILL)
    for future in futures[1:]:
        yield future.result()


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_what_a_killed_worker_had_is_made_again(folder: Path, tmp_path: Path, wanted: "dict[str, bytes]") -> None:
    sweep, cache = folder / "sweep.toml", tmp_path / "cache"
    for kept in (False, cache):
        with ProcessPoolExecutor(2, get_context("spawn")) as pool:
            hand_out = lambda work, tasks: killed(lambda: list(pool._processes), work, pool, tasks)  # noqa: E731
            with pytest.raises(pp.SweepError, match="of 24 runs were back: BrokenProcessPool") as caught:
                pp.sweep(sweep, hand_out, cache=kept)
        assert isinstance(caught.value.__cause__, BrokenProcessPool)
        assert ("with a new executor" if kept else "with a cache") in str(caught.value)
    again = pp.sweep(sweep, cache=cache)
    assert again.known >= 1 and written(again, tmp_path) == wanted
    # What failed is tried again; all else is known.
    assert pp.sweep(sweep, cache=cache).known == 16


def test_dask_makes_again_what_a_killed_worker_had(folder: Path, tmp_path: Path, wanted: "dict[str, bytes]") -> None:
    distributed = pytest.importorskip("distributed", reason="pip install 'dask[distributed]'")
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(tmp_path)
    )
    with cluster, distributed.Client(cluster) as client:
        pid = next(iter(client.run(os.getpid).values()))

        def hand_out(work: Any, tasks: "list[Any]") -> "list[Any]":
            futures: "list[Any]" = client.map(work, tasks)
            futures[0].result()
            os.kill(pid, signal.SIGKILL)
            return futures

        assert written(pp.sweep(folder / "sweep.toml", hand_out, cache=False), tmp_path) == wanted
        assert pid not in client.run(os.getpid).values()
        assert written(pp.sweep(folder / "sweep.toml", client.map, cache=False, chunk=3), tmp_path) == wanted


def test_mistakes_are_told_in_the_words_of_the_program(folder: Path, tmp_path: Path) -> None:
    for right, wrong in (("for_s", "for"), ("device.passivity", "device.icy"), ("own.toml", "no.toml")):
        mistaken = SWEEP.replace(right, wrong)
        file = folder / "mistaken.toml"
        file.write_text(mistaken, "utf-8")
        told = batch(file, "-o", str(tmp_path / "x.csv"))
        assert told.returncode == 2
        with pytest.raises(pp.SweepError) as caught:
            pp.sweep(file)
        assert str(caught.value) in told.stderr
    with pytest.raises(FileNotFoundError):
        pp.sweep(folder / "nothing.toml")
    with pytest.raises(pp.SweepError, match=".csv, .json or .parquet"):
        pp.sweep(folder / "sweep.toml", cache=False).write(tmp_path / "results.xls")


def test_maps_that_do_not_map_are_errors(folder: Path, tmp_path: Path) -> None:
    sweep = functools.partial(pp.sweep, folder / "sweep.toml", cache=tmp_path)
    with pytest.raises(TypeError, match="map is a function such as Executor.map, not int"):
        sweep(map=3)
    with ThreadPoolExecutor() as pool, pytest.raises(TypeError, match="not ThreadPoolExecutor: give its method, .map"):
        sweep(map=pool)
    with pytest.raises(ValueError, match="chunk is 0"):
        sweep(chunk=0)
    with pytest.raises(pp.SweepError, match="gave back 23 runs, not the 24"):
        sweep(lambda work, tasks: map(work, tasks[1:]))
    with pytest.raises(pp.SweepError, match="gave back 25 runs, not the 24"):
        sweep(lambda work, tasks: [[(run, False, "")] for run in range(25)])
    for wrong in (lambda work, tasks: None, lambda work, tasks: [3]):
        with pytest.raises(pp.SweepError, match="0 of 24 runs were back: TypeError"):
            sweep(wrong)
    with pytest.raises(pp.SweepError, match="0 of 24 runs were back: OSError: no room") as caught:
        sweep(failing)
    assert isinstance(caught.value.__cause__, OSError)


def failing(work: Any, tasks: "list[Any]") -> None:
    raise OSError("no room")


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_a_sweep(folder: Path, tmp_path: Path) -> None:
    long = SWEEP.replace("[3, 5]", "{ from = 1, count = 10000 }")
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        pp.sweep(long, map, directory=folder, cache=False)
