"""Recordings as arrays, replays, and files that are cut off, foreign or growing."""

import shutil
import time
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palpate as pp

from .conftest import ROOT, press, soft


def test_columns_hold_what_the_client_saw(pressed: Any) -> None:
    path, forces = pressed
    recording = pp.open(path)
    ticks = recording.ticks["ball"]
    assert len(recording) == 400 and recording.whole and recording.cut_short is None
    np.testing.assert_array_equal(ticks.force, forces)
    np.testing.assert_array_equal(ticks.pose[:, :3], press(400))
    np.testing.assert_array_equal(recording.tick, np.arange(1, 401))
    np.testing.assert_allclose(recording.time, np.arange(1, 401) * 1e-3)
    assert (ticks.depth > 0).any() and ((ticks.depth > 0) == np.isfinite(ticks.contact_point[:, 0])).all()
    assert ticks.force is ticks.force, "read once"
    some = ticks.read("force", "tick", first=100, last=149)
    np.testing.assert_array_equal(some["force"], forces[99:149])
    np.testing.assert_array_equal(some["tick"], np.arange(100, 150))
    assert list(recording.ticks) == ["ball"] and recording.bodies == ["drop"] and recording.dt == 1e-3
    info = recording.info()
    assert info == {**recording.info(check=True), "figures_from": info["figures_from"]}
    assert info["tools"][0]["peak_force_n"] == pytest.approx(np.linalg.norm(forces, axis=1).max(), rel=1e-15)
    with pytest.raises(AttributeError, match="contact_force"):
        _ = ticks.farce
    with pytest.raises(KeyError, match="'ball'"):
        _ = recording.ticks["pen"]


def test_any_column_in_any_order_has_a_row_for_each_tick(pressed: Any) -> None:
    path, _ = pressed
    ticks = pp.open(path).ticks["ball"]
    for name in dir(ticks):
        if name != "read":
            assert len(getattr(ticks, name)) == 400, name


def test_nets_at_any_tick_are_those_of_the_simulation(pressed: Any, soft_scene: pp.Scene) -> None:
    path, _ = pressed
    recording = pp.open(path)
    sim = soft_scene.simulate()
    for k, place in enumerate(press(400)):
        sim.step({"ball": place})
        if k in (0, 137, 399):
            np.testing.assert_array_equal(recording.net("drop", tick=k + 1), sim.net("drop"))
    assert len(recording.net_ticks("drop")) > 1
    with pytest.raises(pp.RecordingError, match="401"):
        recording.net("drop", tick=401)
    with pytest.raises(KeyError, match="'drop'"):
        recording.net("frog", tick=1)
    assert recording.scene().simulate().hash() == soft_scene.simulate().hash()


def test_a_replay_matches_every_tick_and_figures_agree(pressed: Any) -> None:
    path, forces = pressed
    recording = pp.open(path)
    report = recording.replay()
    assert (report.ticks_matched, report.complete, report.same_build) == (400, True, True)
    assert recording.replay(last=150, jobs=1).ticks_matched == 150
    assert recording.replay(progress=True).session_hash == report.session_hash
    figures = pp.figures(recording)
    assert figures["tools"][0]["peak_force_n"] == pytest.approx(np.linalg.norm(forces, axis=1).max())


def edited(data: bytes, old: bytes, new: bytes) -> bytes:
    """A recording whose attachments say ``new`` for ``old``, of the same length, with checksums that fit."""
    assert len(old) == len(new) and old in data
    out, at = bytearray(data), 8
    while at + 9 < len(data):
        length = int.from_bytes(data[at + 1 : at + 9], "little")
        start, end = at + 9, at + 9 + length
        if data[at] == 9 and old in data[start:end]:
            body = data[start : end - 4].replace(old, new)
            out[start:end] = body + zlib.crc32(body).to_bytes(4, "little")
        at = end
    return bytes(out)


def test_a_replay_that_differs_tells_tick_and_field(pressed: Any, tmp_path: Path) -> None:
    # The recorded forces are those of another stiffness than the scene inside says.
    path, _ = pressed
    other = tmp_path / "other.mcap"
    other.write_bytes(edited(path.read_bytes(), b"young_pa = 20000.0", b"young_pa = 20001.0"))
    with pytest.raises(pp.DivergedError) as caught:
        pp.open(other).replay()
    error = caught.value
    assert error.tick >= 1 and error.field and error.recorded != error.replayed and error.same_build
    assert str(error.tick) in str(error) and isinstance(error, AssertionError)


def test_pandas_gets_a_row_for_each_tick(pressed: Any) -> None:
    pytest.importorskip("pandas")
    path, forces = pressed
    table = pp.open(path).to_pandas()
    np.testing.assert_array_equal(table[["ball.force.x", "ball.force.y", "ball.force.z"]].to_numpy(), forces)
    assert table.index.name == "tick" and table["time"].iloc[-1] == pytest.approx(0.4)
    small = pp.open(path).to_pandas(["depth"])
    assert list(small.columns) == ["time", "hash", "ball.depth"]


def test_a_recording_that_is_cut_off_warns_and_gives_the_rest(pressed: Any, tmp_path: Path) -> None:
    path, forces = pressed
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    with pytest.warns(pp.RecordingWarning, match="not whole"):
        recording = pp.open(cut)
    assert not recording.whole and recording.cut_short
    got = recording.ticks["ball"].force
    assert 0 < len(got) < 400
    np.testing.assert_array_equal(got, forces[: len(got)])
    assert recording.replay().complete is False


def test_files_that_are_no_recordings_say_so(tmp_path: Path, pressed: Any) -> None:
    with pytest.raises(FileNotFoundError, match="none.mcap"):
        pp.open(tmp_path / "none.mcap")
    (tmp_path / "text.mcap").write_text("not a recording at all")
    with pytest.raises(pp.RecordingError, match="not an MCAP file"):
        pp.open(tmp_path / "text.mcap")
    (tmp_path / "empty.mcap").touch()
    with pytest.raises(pp.RecordingError):
        pp.open(tmp_path / "empty.mcap")
    path, _ = pressed
    later = tmp_path / "later.mcap"
    later.write_bytes(path.read_bytes().replace(b"\x06\x00\x00\x00format\x01\x00\x00\x002", b"\x06\x00\x00\x00format\x01\x00\x00\x009"))
    with pytest.raises(pp.RecordingError, match="format 9"):
        pp.open(later)
    with pytest.raises(OSError):
        pp.open(tmp_path)


def test_a_recording_of_another_build_opens_and_says_so(tmp_path: Path, pressed: Any) -> None:
    path, _ = pressed
    build = pp.build_id().encode()
    content = path.read_bytes()
    assert build in content
    older = tmp_path / "older.mcap"
    older.write_bytes(content.replace(build, build.replace(b"source ", b"SOURCE ")))
    recording = pp.open(older)
    assert len(recording) > 0
    assert recording.metadata["build"] != pp.build_id()
    try:
        assert recording.replay().same_build is False
    except pp.DivergedError as error:
        assert not error.same_build and "another build" in str(error)


def test_a_recording_is_read_while_it_grows(tmp_path: Path) -> None:
    path = tmp_path / "live.mcap"
    places = press(1200)
    with pp.serve(soft(), clock="lockstep", record=path) as daemon, daemon.tool("ball") as ball:
        forces = [ball.step(place).force for place in places[:600]]
        part = path.with_name(path.name + ".part")
        deadline = time.monotonic() + 20.0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pp.RecordingWarning)
            growing = pp.open(part)
            while len(growing) < 300 and time.monotonic() < deadline:
                time.sleep(0.1)
                growing.refresh()
            first = growing.ticks["ball"].force
            forces += [ball.step(place).force for place in places[600:]]
            came = growing.refresh()
            while came == 0 and time.monotonic() < deadline:
                time.sleep(0.1)
                came = growing.refresh()
        assert came > 0 and len(growing.ticks["ball"].force) > len(first) >= 300
        np.testing.assert_array_equal(growing.ticks["ball"].force, np.array(forces)[: len(growing)])
    whole = pp.open(path)
    np.testing.assert_array_equal(whole.ticks["ball"].force, np.array(forces))


def test_a_page_of_a_recording_opens_from_disk(pressed: Any, tmp_path: Path) -> None:
    path, _ = pressed
    page = tmp_path / "press.html"
    assert pp.to_html(path, page) == 1
    text = page.read_text("utf-8")
    assert text.startswith("<!") and 'id="palpate-recording"' in text
    shown = pp.open(path).show()._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and "palpate-recording" in shown


def test_columns_beyond_what_is_there_are_empty(pressed: Any, tmp_path: Path) -> None:
    path, _ = pressed
    ticks = pp.open(path).ticks["ball"]
    assert ticks.read("force", first=500)["force"].shape == (0, 3)
    copy = tmp_path / "copy.mcap"
    shutil.copy(path, copy)
    kept = pp.open(copy)
    copy.unlink()
    assert kept.ticks["ball"].force.shape == (400, 3), "an open file stays open"
