"""More processes: fork and spawn after import, pickles between them."""

import multiprocessing
import sys
import warnings
from typing import Any

import numpy as np
import pytest

import palpate as pp

from .conftest import press, rigid


def last_hash(scene: pp.Scene) -> "tuple[int, Any]":
    """Runs in another process: a batch with threads, and closest points."""
    batch = pp.Batch(scene, n=4, workers=2)
    for place in press(20):
        batch.pose("ball")[:, :3] = place
        batch.step()
    hashes = batch.hash()
    assert (hashes == hashes[0]).all()
    return int(hashes[0]), scene.surface("drop").closest(np.zeros((600, 3)), workers=2)["u"]


@pytest.mark.parametrize("method", ["spawn", "fork", "forkserver"])
def test_other_processes_compute_the_same(method: str, soft_scene: pp.Scene) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    here = last_hash(soft_scene)
    with warnings.catch_warnings():
        # Python 3.12 and later warn of fork in a process with threads; those of Zenoh are not used in the child.
        warnings.simplefilter("ignore", DeprecationWarning)
        with multiprocessing.get_context(method).Pool(2) as pool:
            there = pool.map_async(last_hash, [soft_scene] * 3).get(120)
    for hashes, parameters in there:
        assert hashes == here[0]
        np.testing.assert_array_equal(parameters, here[1])


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
