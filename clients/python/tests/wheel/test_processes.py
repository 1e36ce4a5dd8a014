"""More processes: fork and spawn after import, pickles between them."""

import multiprocessing
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import pytest

import palpate as pp

from .conftest import rigid, soft


WORK = """
import multiprocessing, sys, warnings
import numpy as np
import palpate as pp

def work(scene):
    batch = pp.Batch(scene, n=4, workers=2)
    for x in np.linspace(0.06, 0.02, 40):
        batch.pose("ball")[:, 0] = x
        batch.step()
    hashes = batch.hash()
    assert (hashes == hashes[0]).all()
    # Threads of their own, too.
    return int(hashes[0]), scene.surface("drop").closest(np.zeros((600, 3)), workers=2)["u"].tolist()

if __name__ == "__main__":
    # Python 3.12 and later warn of a fork in a process with threads; none of ours run then.
    warnings.simplefilter("ignore", DeprecationWarning)
    scene = pp.Scene({scene!r})
    here = work(scene)
    with multiprocessing.get_context({method!r}).Pool(2) as pool:
        there = pool.map_async(work, [scene] * 3).get(60)
    assert there == [here] * 3
    print("equal", len(there))
"""


@pytest.mark.parametrize("method", ["spawn", "fork", "forkserver"])
def test_other_processes_compute_the_same(method: str, tmp_path: Path) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    script = tmp_path / "work.py"
    script.write_text(WORK.replace("{scene!r}", repr(soft())).replace("{method!r}", repr(method)), "utf-8")
    run = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120, cwd=tmp_path)
    assert run.stdout.strip() == "equal 3", run.stdout + run.stderr


def link_in_child(connection: Any, endpoint: str) -> None:
    try:
        connection.send(pp.connect(endpoint, timeout=10.0).tools())
    except BaseException as error:  # noqa: BLE001 (sent, not swallowed)
        connection.send(repr(error))


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_a_link_in_a_forked_child_says_what_to_do(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(rigid())
    daemon.tools()  # Zenoh runs in this process
    context = multiprocessing.get_context("fork")
    mine, theirs = context.Pipe()
    child = context.Process(target=link_in_child, args=(theirs, daemon.endpoint))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        child.start()
    try:
        assert mine.poll(60), "the child hangs"
        answer = mine.recv()
        assert "spawn" in answer, answer
    finally:
        child.kill()
        child.join()
    assert daemon.tools() == ["probe"], "the parent's link is as it was"
