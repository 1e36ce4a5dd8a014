"""Simulations in process: the daemon's bits, views, snapshots, and what is refused."""

import gc
import math
import pickle
import threading
from typing import Any

import numpy as np
import pytest

import palpate as pp
from palpate import _native

from .conftest import lower, press, rigid, soft


def test_a_press_in_process_has_the_bits_of_the_daemon_in_lockstep(soft_scene: pp.Scene, pressed: Any) -> None:
    path, forces = pressed
    recording = pp.open(path)
    trace = soft_scene.simulate().run({"ball": press(400)})
    assert np.abs(forces).max() > 0.1, "it must touch"
    np.testing.assert_array_equal(recording.hash, trace.hash)
    np.testing.assert_array_equal(recording.ticks["ball"].force, trace.force["ball"])
    np.testing.assert_array_equal(forces, trace.force["ball"])
    np.testing.assert_array_equal(recording.ticks["ball"].depth, trace.depth["ball"])
    np.testing.assert_array_equal(recording.ticks["ball"].error_n, trace.error_n["ball"])
    assert trace.error_n["ball"].max() > 0.0


def test_steps_and_a_run_are_the_same(soft_scene: pp.Scene) -> None:
    trace = soft_scene.simulate().run({"ball": press(120)})
    sim = soft_scene.simulate()
    for k, place in enumerate(press(120)):
        out = sim.step({"ball": pp.Pose(position=place)})
        assert out.hash == trace.hash[k] == sim.hash()
        np.testing.assert_array_equal(out.force["ball"], trace.force["ball"][k])
        assert out.error_n["ball"] == trace.error_n["ball"][k]


def test_the_force_on_a_rigid_ball_is_stiffness_times_depth(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    for place in lower(200):
        out = sim.step({"probe": place})
    assert out.force["probe"][2] == pytest.approx(500.0 * 0.002, abs=1e-9)
    assert out.depth["probe"] == pytest.approx(0.002, abs=1e-9)
    (contact,) = out.contacts
    assert (rigid_scene.tools[contact["tool"]], rigid_scene.bodies[contact["body"]]) == ("probe", "ball")
    np.testing.assert_allclose(contact["point"], [0.0, 0.0, 0.02], atol=1e-9)
    np.testing.assert_allclose(contact["normal"], [0.0, 0.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(contact["normal_force"] * contact["normal"] + contact["friction_force"], contact["force"])
    assert list(out.force) == list(out.force.keys()) == ["probe"]
    assert "probe" in out.force and out.force.get("other") is None and len(out.force) == 1


def test_a_force_explains_itself_to_the_same_bits(rigid_scene: pp.Scene, soft_scene: pp.Scene) -> None:
    for scene, tool, way in ((rigid_scene, "probe", lower(60)), (soft_scene, "ball", press(60))):
        plain, asked = scene.simulate(), scene.simulate()
        for place in way:
            a, b = plain.step({tool: place}), asked.step({tool: place}, explain=True)
            assert a.hash == b.hash and a.explain is None
        explained = b.explain
        assert explained["tick"] == 60 and len(explained["bodies"]) == (scene is soft_scene)
        rows = [row for row in explained["rows"] if row["force_n"] > 0.0]
        assert rows
        for row in rows:
            compliance = row["compliance_m_per_n"]
            assert compliance["sum"] == pytest.approx(sum(compliance["by_party"].values()), rel=1e-12)
            assert (row["body"], row["holder"]) == (scene.bodies[0], tool)
        if scene is rigid_scene:
            (row,) = rows
            assert row["force_n"] == pytest.approx(-row["gap_free_m"] / row["compliance_m_per_n"]["sum"], rel=1e-9)
            assert row["force_n"] == pytest.approx(500.0 * 0.002, rel=1e-9)


def test_a_held_pose_is_sent_each_tick_and_none_ends_that(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    for place in lower(200):
        sim.step({"probe": place})
    held = sim.step(ticks=200)
    assert held.force["probe"][2] == pytest.approx(1.0, abs=1e-9)
    assert not held.flags["probe"] & pp.ForceFlags.STALE
    gone = sim.step({"probe": None}, ticks=400)
    assert gone.flags["probe"] & pp.ForceFlags.STALE
    np.testing.assert_array_equal(gone.force["probe"], np.zeros(3))


def test_an_output_has_every_quantity_that_recordings_have(rigid_scene: pp.Scene) -> None:
    out = rigid_scene.simulate().step()
    of_tools, _ = _native.RecordingFile.column_names()
    for name in set(of_tools) - {"pose", "velocity", "buttons"}:
        assert list(getattr(out, name)) == ["probe"], name
    with pytest.raises(AttributeError, match="buttons"):
        _ = out.buttons


def test_outputs_stay_as_they_were(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    first = sim.step({"probe": (0.0, 0.0, 0.04)})
    forces = first.force["probe"]
    for place in lower(50):
        sim.step({"probe": place})
    np.testing.assert_array_equal(forces, np.zeros(3))
    assert first.tick == 1


def test_a_net_view_follows_the_simulation_and_outlives_it(soft_scene: pp.Scene) -> None:
    sim = soft_scene.simulate()
    view = sim.net("drop")
    rest = view.copy()
    assert view.shape == rest.shape == soft_scene.surface("drop").points.shape
    sim.run({"ball": press(200)})
    assert np.abs(view - rest).max() > 1e-3
    np.testing.assert_array_equal(view, sim.surface("drop").points)
    with pytest.raises(ValueError, match="read-only"):
        view[0, 0, 0] = 1.0
    pressed = view.copy()
    del sim
    gc.collect()
    np.testing.assert_array_equal(view, pressed)


def test_views_do_not_grow_in_number(soft_scene: pp.Scene) -> None:
    sim = soft_scene.simulate()
    for _ in range(100):
        sim.net("drop")
        sim.step()
    view = sim.net("drop")
    again = sim.net("drop")
    assert np.shares_memory(view, again)


def test_a_saved_state_comes_back_by_bits_through_a_pickle(soft_scene: pp.Scene) -> None:
    sim = soft_scene.simulate()
    sim.run({"ball": press(100)})
    snapshot = pickle.loads(pickle.dumps(sim.save()))
    assert snapshot == sim.save() and snapshot.hash == sim.hash()
    first = [sim.step().hash for _ in range(20)]
    sim.restore(snapshot)
    assert [sim.step().hash for _ in range(20)] == first
    other = pickle.loads(pickle.dumps(soft_scene)).simulate()
    other.restore(snapshot)
    assert [other.step().hash for _ in range(20)] == first


def test_a_snapshot_of_another_scene_changes_nothing(soft_scene: pp.Scene, rigid_scene: pp.Scene) -> None:
    sim = soft_scene.simulate()
    sim.step({"ball": (0.06, 0.003, 0.045)})
    before = sim.hash()
    with pytest.raises(ValueError, match="another scene"):
        sim.restore(rigid_scene.simulate().save())
    assert sim.hash() == before


def test_reset_is_a_new_simulation(soft_scene: pp.Scene) -> None:
    sim = soft_scene.simulate()
    start, trace = sim.hash(), sim.run({"ball": press(60)})
    sim.reset()
    assert (sim.tick, sim.hash()) == (0, start)
    np.testing.assert_array_equal(sim.run({"ball": press(60)}).hash, trace.hash)


def test_pause_and_reset_are_the_daemons_commands(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    for place in lower(50):
        sim.step({"probe": place})
    sim.command("pause")
    assert sim.step(ticks=100).flags["probe"] & pp.ForceFlags.PAUSED
    sim.command("reset")
    assert sim.tick == 150, "ticks go on, as in a daemon"
    with pytest.raises(ValueError, match="reset, pause, resume or stop"):
        sim.command("dance")


def test_scenes_from_files_dictionaries_and_text_are_the_same() -> None:
    made = pp.Scene(rigid())
    text = pp.Scene(made.text)
    copied = pickle.loads(pickle.dumps(made))
    assert made.simulate().hash() == text.simulate().hash() == copied.simulate().hash()
    assert copied.text == made.text and copied.name == made.name == "rigid"


def test_all_problems_of_a_scene_are_told(tmp_path: Any) -> None:
    bad = soft()
    bad["body"][0]["material"]["young_pa"] = -1.0
    bad["tool"][0]["shape"] = {"sphere": {"radius_m": 0.0}}
    with pytest.raises(pp.SceneError) as caught:
        pp.Scene(bad)
    paths = {problem.path for problem in caught.value.problems}
    assert paths == {"body[0].material.young_pa", "tool[0].shape.sphere.radius_m"}
    assert all(path in str(caught.value) for path in paths)
    misspelt = rigid()
    misspelt["tool"][0]["cuopling"] = misspelt["tool"][0].pop("coupling")
    with pytest.raises(pp.SceneError, match="did you mean \"coupling\""):
        pp.Scene(misspelt)
    file = tmp_path / "bad.toml"
    file.write_text('[[body]]\nid = "a"\nsurface = { builtin = "spere" }\n')
    with pytest.raises(pp.SceneError) as caught:
        pp.Scene.load(file)
    problem = caught.value.problems[0]
    assert (problem.file, problem.line) == (str(file), 3) and "sphere" in problem.reason
    with pytest.raises(FileNotFoundError):
        pp.Scene.load(tmp_path / "none.toml")
    for nothing in (3, None, ["a"]):
        with pytest.raises(TypeError, match="dictionary or TOML"):
            pp.Scene(nothing)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="tool"):
        pp.Scene({"tool": object()})


def test_a_varied_scene_is_another_scene(soft_scene: pp.Scene) -> None:
    stiff = soft_scene.varied({"body/drop/material/young_pa": 60e3, "tool/ball/shape/sphere/radius_m": 0.008})
    bent = stiff.simulate().run({"ball": press(200)}), soft_scene.simulate().run({"ball": press(200)})
    assert np.abs(bent[0].force["ball"]).max() > np.abs(bent[1].force["ball"]).max()
    with pytest.raises(KeyError, match="'drop'|\"drop\""):
        soft_scene.varied({"body/dorp/material/young_pa": 1.0})
    with pytest.raises(pp.SceneError, match="young_pa"):
        soft_scene.varied({"body/drop/material/young_pa": -1.0})


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ((0.0, 0.0), "3 .position."),
        (np.zeros((3, 1)), r"\(3, 1\)"),
        ((0.0, 0.0, math.nan), "finite"),
        (np.array([0.0, math.inf, 0.0]), "finite"),
        ((0.0, 1e155, 0.0), "finite"),
        ((0.0, 0.0, 0.04, 0.0, 0.0, 0.0, 2.0), "divide it by its length"),
    ],
)
def test_bad_poses_are_refused_and_nothing_happens(rigid_scene: pp.Scene, pose: Any, words: str) -> None:
    sim = rigid_scene.simulate()
    before = sim.hash()
    with pytest.raises(ValueError, match=words):
        sim.step({"probe": pose})
    assert (sim.hash(), sim.tick) == (before, 0)


def test_wrong_dtypes_are_refused_and_others_are_exact(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    for pose in ("abc", ("a", "b", "c"), np.zeros(3, complex), np.array([None] * 3), [[1.0], [2.0, 3.0]], object()):
        with pytest.raises(TypeError, match="numbers"):
            sim.step({"probe": pose})
    with pytest.raises(TypeError, match="dictionary"):
        sim.step([(0.0, 0.0, 0.04)])  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="probe"):
        sim.step({"prob": (0.0, 0.0, 0.04)})
    with pytest.raises(ValueError, match="at least one"):
        sim.step(ticks=0)
    place = np.array([0.01, -0.02, 0.03])
    wide = np.zeros((3, 2))
    wide[:, 0] = place
    poses = [
        pp.Pose(place),
        pp.Pose(tuple(place)),
        pp.Pose(place.tolist()),
        pp.Pose(wide[:, 0]),  # not contiguous
        pp.Pose(place[::-1][::-1]),
        pp.Pose(np.asfortranarray(place)),
        pp.Pose([np.float64(x) for x in place]),
    ]
    assert all(pose == poses[0] for pose in poses)
    assert pp.Pose(place.astype(np.float32)) == pp.Pose([float(np.float32(x)) for x in place])
    assert pp.Pose((1, 2, 3)) == pp.Pose(np.array([1, 2, 3], np.int8)) == pp.Pose((1.0, 2.0, 3.0))


def test_poses_are_values() -> None:
    pose = pp.Pose((1.0, 2.0, 3.0), (0.0, 0.6, 0.0, 0.8), (0.1, 0.0, 0.0), (0.0, 0.0, 0.2), buttons=1, t_client_ns=7)
    assert pickle.loads(pickle.dumps(pose)) == pose
    assert pose != pp.Pose((1.0, 2.0, 3.0)) and pose != "pose"
    assert (pose.buttons, pose.t_client_ns) == (1, 7)
    np.testing.assert_array_equal(pose.array()[:7], [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8])
    assert repr(pp.Pose()) == "Pose(position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0, 1.0))"
    with pytest.raises(AttributeError):
        pose.buttons = 0  # type: ignore[misc]
    for name in ("position", "linear_velocity", "angular_velocity"):
        with pytest.raises(ValueError, match=name):
            pp.Pose(**{name: (0.0, math.nan, 0.0)})


def test_runs_need_rows_of_one_count(rigid_scene: pp.Scene) -> None:
    sim = rigid_scene.simulate()
    for poses in (np.zeros(3), np.zeros((4, 5)), np.zeros((2, 2, 3))):
        with pytest.raises(ValueError, match=r"\(ticks, 3\)"):
            sim.run({"probe": poses})
    with pytest.raises(ValueError, match="no poses"):
        sim.run({})
    with pytest.raises(ValueError, match="finite"):
        sim.run({"probe": np.full((2, 3), np.nan)})
    assert sim.run({"probe": np.zeros((0, 3))}).force["probe"].shape == (0, 3)
    assert sim.tick == 0


def test_a_simulation_stepped_by_two_threads_says_so(soft_scene: pp.Scene) -> None:
    sim = soft_scene.simulate()
    busy, begun = [], threading.Event()

    def long() -> None:
        begun.set()
        sim.step(ticks=3000)

    thread = threading.Thread(target=long)
    thread.start()
    begun.wait()
    while thread.is_alive() and not busy:
        try:
            sim.hash()
        except pp.BusyError as error:
            busy.append(error)
    thread.join()
    assert busy and "another thread" in str(busy[0])
    assert sim.tick == 3000, "nothing was disturbed"


def test_simulations_are_not_pickled_and_say_what_is(rigid_scene: pp.Scene) -> None:
    with pytest.raises(TypeError, match="sim.save"):
        pickle.dumps(rigid_scene.simulate())


def test_a_scene_with_a_slip_of_units_warns_and_one_that_cannot_be_meant_is_refused() -> None:
    body = {"id": "ball", "surface": {"builtin": "sphere"}, "model": "lattice", "lattice": {"layers": 1, "refine": "none"}}
    body["material"] = {"density_kg_m3": 1.05}
    body["fixed"] = [{"point": [0.0, 0.0, -0.03], "normal": [0.0, 0.0, 1.0]}]
    with pytest.warns(pp.SceneWarning, match="did you mean 1050 kg/m³"):
        scene = pp.Scene({"body": [body]})
    assert len(scene.warnings) == 1 and "density_kg_m3" in scene.warnings[0]
    other = {**body, "id": "other", "pose": {"position": [0.03, 0.0, 0.0]}}
    with pytest.raises(pp.SceneError, match="mm in each other"):
        pp.Scene({"body": [body, other]})
    with pytest.raises(pp.SceneError, match="within ±1e12"):
        pp.Scene({"body": [{**body, "pose": {"position": [1e200, 0.0, 0.0]}}]})
