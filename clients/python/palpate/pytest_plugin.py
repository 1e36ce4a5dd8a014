"""Fixtures for tests of clients: loaded by pytest where this package is installed.

>>> def test_the_ball_pushes_back(palpate_daemon):  # doctest: +SKIP
...     daemon = palpate_daemon("scenes/rigid-teardrop.toml")
...     with daemon.tool("ball") as ball:
...         force = ball.step((0.06, 0.003, 0.045))
"""

import os
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Union

import pytest

if TYPE_CHECKING:
    from ._daemon import Daemon
    from ._recordings import ReplayReport


@pytest.fixture
def palpate_daemon() -> "Iterator[Callable[..., Daemon]]":
    """Starts daemons in lockstep on free ports: ``palpate_daemon(scene, **options of palpate.serve)``.

    They end with the test; one that ended by itself fails it.
    """
    import palpate

    daemons: list[Daemon] = []

    def start(scene: Any, **options: Any) -> "Daemon":
        daemon = palpate.serve(scene, **{"clock": "lockstep", **options})
        daemons.append(daemon)
        return daemon

    yield start
    for daemon in daemons:
        daemon.stop()


@pytest.fixture
def assert_replays() -> "Callable[[Union[str, os.PathLike[str]]], ReplayReport]":
    """Replays a recording: fails with the first tick and value that differ, or where ticks are missing."""
    import palpate

    def check(recording: "Union[str, os.PathLike[str]]") -> "ReplayReport":
        report = palpate.open(recording).replay()
        assert report.complete, f"{recording}: the recording is incomplete: {report.details}"
        assert report.ticks_matched > 0, f"{recording}: no ticks"
        return report

    return check
