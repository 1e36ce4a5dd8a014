"""Batches: each copy has the daemon's bits, on any number of threads; interruptions, views, variation."""

import gc
import os
import signal
import threading
import time
from typing import Any

import numpy as np
import pytest

import palpate as pp

from .conftest import press


def test_each_copy_has_the_bits_of_the_daemon(soft_scene: pp.Scene, pressed: Any) -> None:
    path, _ = pressed
    recording = pp.open(path)
    batch = pp.Batch(soft_scene, n=5, workers=3)
    pose, force = batch.pose("ball"), batch.force("ball")
    for k, place in enumerate(press(400)):
        pose[:, :3] = place
        batch.step()
        if k % 50 == 49:
            np.testing.assert_array_equal(batch.hash(), np.full(5, recording.hash[k]))
            np.testing.assert_array_equal(force, np.tile(recording.ticks["ball"].force[k], (5, 1)))
    np.testing.assert_array_equal(batch.tick(), np.full(5, 400))


def test_threads_do_not_change_bits(soft_scene: pp.Scene) -> None:
    hashes = []
    for workers in (1, 2, 7):
        batch = pp.Batch(soft_scene, n=16, workers=workers)
        batch.pose("ball")[:, 0] = 0.06 - np.linspace(0.0, 0.004, 16)
        batch.step(30)
        batch.pose("ball")[:, 0] -= 0.004
        batch.step(30)
        hashes.append(batch.hash())
    np.testing.assert_array_equal(hashes[0], hashes[1])
    np.testing.assert_array_equal(hashes[0], hashes[2])
    assert len(set(hashes[0].tolist())) == 16


def test_views_are_live_and_outlive_the_batch(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=3)
    names = ("force", "torque", "contact_force", "contact_torque", "depth", "proxy", "energy", "dissipated")
    names += ("error_n", "flags")
    views = {name: getattr(batch, name)("ball") for name in names}
    shapes = [view.shape for view in views.values()]
    assert shapes == [(3, 3), (3, 3), (3, 3), (3, 3), (3,), (3, 7), (3,), (3,), (3,), (3,)]
    nets = batch.net("drop")
    rest = nets.copy()
    for place in press(150):
        batch.pose("ball")[1, :3] = place
        batch.step()
    assert views["depth"][1] > 0.0 and views["depth"][0] == 0.0
    assert views["error_n"][1] > 0.0 and views["error_n"][0] == 0.0
    assert np.abs(nets[1] - rest[1]).max() > 1e-4
    np.testing.assert_array_equal(nets[0], rest[0])
    contacts = batch.contacts()
    assert set(contacts["copy"]) == {1}
    np.testing.assert_allclose(contacts["force"].sum(axis=0), views["contact_force"][1], rtol=1e-9)
    with pytest.raises(ValueError, match="read-only"):
        views["force"][0, 0] = 1.0
    pose = batch.pose("ball")
    with pytest.raises(ValueError, match="resize|own"):
        pose.resize((1, 1), refcheck=False)
    last = views["force"].copy()
    del batch
    gc.collect()
    np.testing.assert_array_equal(views["force"], last)
    pose[:] = 1.0  # writes to memory that is still there


def test_bad_poses_are_told_with_tool_and_copy_and_nothing_is_stepped(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=4)
    before = batch.hash()
    batch.pose("ball")[2, 1] = np.nan
    with pytest.raises(ValueError, match=r"pose\(\"ball\"\)\[2, 1\] is NaN"):
        batch.step()
    batch.pose("ball")[2, 1] = 0.0
    batch.pose("ball")[3, 3:] = 0.5, 0.5, 0.5, 0.6
    with pytest.raises(ValueError, match=r"pose\(\"ball\"\)\[3\]: .*unit quaternion"):
        batch.step()
    batch.pose("ball")[3, 3:] = 0.5
    batch.velocity("ball")[1, 5] = np.inf
    with pytest.raises(ValueError, match=r"velocity\(\"ball\"\)\[1, 5\] is inf"):
        batch.step()
    np.testing.assert_array_equal(batch.hash(), before)
    for arguments in ((0,), (3, 0)):
        with pytest.raises(ValueError, match="at least one"):
            pp.Batch(soft_scene, *arguments)
    with pytest.raises(KeyError, match="ball"):
        batch.pose("pen")


def test_varied_copies_are_scenes_of_their_own(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=4)
    young = np.array([1e4, 2e4, 2e4, 8e4])
    batch.vary("body/drop/material/young_pa", young)
    for place in press(200):
        batch.pose("ball")[:, :3] = place
        batch.step()
    hashes = batch.hash()
    assert hashes[1] == hashes[2] and len(set(hashes.tolist())) == 3
    for k in (0, 3):
        scene = soft_scene.varied({"body/drop/material/young_pa": young[k]})
        assert scene.simulate().run({"ball": press(200)}).hash[-1] == hashes[k]
    force = np.linalg.norm(batch.force("ball"), axis=1)
    assert force[0] < force[1] < force[3]
    # A second value leaves the first; a bad one changes nothing.
    stiffness = [100, 200, 300, 400]
    batch.vary("tool/ball/coupling/stiffness_n_m", stiffness)
    for place in press(200):
        batch.pose("ball")[:, :3] = place
        batch.step()
    before = batch.hash()
    for k in range(4):
        values = {"body/drop/material/young_pa": young[k], "tool/ball/coupling/stiffness_n_m": stiffness[k]}
        assert soft_scene.varied(values).simulate().run({"ball": press(200)}).hash[-1] == before[k]
    assert len(set(before.tolist())) == 4
    with pytest.raises(pp.SceneError, match="young_pa"):
        batch.vary("body/drop/material/young_pa", [1e4, -1.0, 1e4, 1e4])
    with pytest.raises(ValueError, match="3 values for 4 copies"):
        batch.vary("body/drop/material/young_pa", [1e4] * 3)
    with pytest.raises(ValueError, match="number of control points"):
        batch.vary("body/drop/surface/net", [[12, 12]] * 4)
    np.testing.assert_array_equal(batch.hash(), before)


def test_chosen_copies_begin_anew(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=5)
    start = batch.hash()
    batch.step(7)
    batch.reset(np.array([True, False, False, True, False]))
    np.testing.assert_array_equal(batch.tick(), [0, 7, 7, 0, 7])
    batch.reset([1])
    batch.reset(slice(2, 3))
    np.testing.assert_array_equal(batch.tick(), [0, 0, 0, 0, 7])
    batch.reset()
    np.testing.assert_array_equal(batch.hash(), start)
    with pytest.raises(IndexError):
        batch.reset([9])


def test_a_batch_stepped_from_two_threads_is_an_error_not_a_crash(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=8)
    busy, begun = [], threading.Event()

    def long() -> None:
        begun.set()
        batch.step(500)

    thread = threading.Thread(target=long)
    thread.start()
    begun.wait()
    while thread.is_alive() and not busy:
        try:
            batch.step(0)
        except pp.BusyError as error:
            busy.append(error)
    thread.join()
    assert busy
    np.testing.assert_array_equal(batch.tick(), np.full(8, 500))


def test_the_gil_is_free_while_a_batch_steps(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=8)
    thread = threading.Thread(target=batch.step, args=(300,))
    thread.start()
    count = 0
    while thread.is_alive():
        count += 1
    assert count > 100, "this thread ran beside it"


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_a_batch_with_all_copies_at_one_tick(soft_scene: pp.Scene) -> None:
    batch = pp.Batch(soft_scene, n=4)
    begun = time.monotonic()
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        batch.step(10_000_000)
    print(f"Ctrl-C was answered {time.monotonic() - begun - 0.3:.3f} s after it was sent")
    ticks = batch.tick()
    assert 0 < ticks[0] < 10_000_000 and (ticks == ticks[0]).all()
    batch.step(3)
    np.testing.assert_array_equal(batch.tick(), ticks + 3)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_a_long_step(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        sim.step(ticks=1_000_000_000)
    assert 0 < sim.tick < 1_000_000_000
