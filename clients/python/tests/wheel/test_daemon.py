"""Daemons: own and others', tools, streams, commands; what dies, what is in use, what stays behind."""

import asyncio
import gc
import os
import signal
import socket
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palpate as pp

from .conftest import lower, press, rigid, soft


def alive(pid: int) -> bool:
    """Whether a process runs (a zombie does not)."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in "ZX"


def gone(pid: int, timeout: float = 20.0) -> bool:
    """Waits until a process has ended."""
    deadline = time.monotonic() + timeout
    while alive(pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not alive(pid)


def test_a_session_has_scene_status_tools_and_commands(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(soft())
    scene = daemon.scene()
    assert isinstance(scene, pp.SceneSnapshot) and scene.lockstep
    assert (daemon.tools(), daemon.bodies()) == (["ball"], ["drop"])
    assert daemon.status().tick == 0 and daemon.info()["name"] and "palpate" in daemon.metrics()
    with daemon.tool("ball") as ball:
        assert ball.lockstep and ball.force is None
        ball.announce(name="arm", force_max=8.0, force_continuous=2.0)
        for place in press(30):
            force = ball.step(place)
        assert force.tick == 30 and ball.force == force and ball.received >= 30
    assert daemon.rpc.reset()["tick"] >= 1
    with pytest.raises(pp.RefusedError, match="ticks"):
        daemon.rpc.step(tick=3)
    with pytest.raises(pp.RefusedError):
        daemon.rpc.dance()
    with pytest.raises(pp.UnknownNameError, match="ball"):
        daemon.tool("pen")
    with pytest.raises(KeyError, match="'drop'"):
        daemon.nets("frog")
    with pytest.raises(ValueError, match="finite"):
        daemon.tool("ball").send((0.0, 0.0, np.nan))


def test_events_and_nets_are_iterators_and_have_async_twins(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(soft())
    events = daemon.events(past=True)
    nets = daemon.nets("drop")
    with daemon.tool("ball") as ball:
        for place in press(200):
            ball.step(place)
        daemon.rpc.pause()

        async def listen() -> "list[Any]":
            found = []
            async for event in events:
                found.append(event)
                if isinstance(event.kind, pp.Paused):
                    return found
            return found

        found = asyncio.run(asyncio.wait_for(listen(), 20.0))
        assert [event.seq for event in found] == list(range(1, len(found) + 1)), "each event once"
        assert any(isinstance(event.kind, pp.ToolJoined) for event in found)
        net = nets.next(timeout=20.0)
        assert net is not None and net.body == "drop" and net.points.shape == (8, 8, 3)
    assert events.next(timeout=0.0) is None
    for stream in (events, nets):
        stream.close()
        assert list(stream) == []
    with daemon.statuses() as statuses:
        assert isinstance(next(statuses), pp.LoopStatus)


def test_a_tool_is_run_by_a_function_of_time_and_force(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with pp.serve(rigid(), clock="lockstep", record=path) as daemon, daemon.tool("probe") as probe:
        seen = []

        def lowered(t: float, force: Any) -> Any:
            seen.append((t, force))
            return pp.Pose((0.0, 0.0, 0.03 - 0.02 * t))

        report = probe.run(lowered, rate=1000, seconds=0.1)
        assert (report.poses, report.forces) == (100, 100)
        assert seen[0] == (0.0, None) and seen[60][0] == pytest.approx(0.06) and seen[60][1].tick == 60
        assert report.last.force[2] == pytest.approx(500.0 * 0.02 * 0.099, abs=1e-9)
        assert probe.run(lambda t, force: None).poses == 0
        with pytest.raises(ValueError, match="rate"):
            probe.run(lowered, rate=0.0)
    assert pp.open(path).replay().ticks_matched == 100


def test_a_tool_in_real_time_gets_its_forces(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(rigid(), clock="realtime")
    with daemon.tool("probe") as probe:
        report = probe.run(lambda t, force: (0.0, 0.0, 0.03), rate=500.0, seconds=1.0)
    assert report.poses == 500 and report.forces > 100 and report.last is not None
    assert report.late.shape == (500,)
    print(f"sent late: median {np.median(report.late) * 1e6:.0f} us, 99 % {np.quantile(report.late, 0.99) * 1e6:.0f} us")


def pressing(probe: Any) -> "tuple[float, float, float]":
    """Presses a probe in real time until it is felt; returns the place."""
    place = (0.0, 0.0, 0.028)
    deadline = time.monotonic() + 30.0
    coming = 0
    while probe.force is None or probe.force.force[2] < 0.5:
        assert time.monotonic() < deadline
        # From outside, again and again: inside it would feel nothing.
        coming = (coming + 1) % 500
        probe.send((0.0, 0.0, 0.028 + 0.007 * (1.0 - min(1.0, coming / 50))))
        time.sleep(1e-3)
    return place


# A killed daemon closes its sockets, a stopped one says nothing at all. Seen: a callback was given 1.43 N for 5.2 s,
# `Tool.force` for ever.
@pytest.mark.parametrize("sign", [signal.SIGKILL, signal.SIGSTOP])
def test_a_force_is_gone_60_ms_after_the_last_one_whoever_reads_it(sign: signal.Signals) -> None:
    daemon = pp.serve(rigid(), clock="realtime")
    # Another session: that of a daemon of one's own raises when it has died.
    with pp.connect(daemon.endpoint) as session, session.tool("probe") as probe:
        forces = session.forces("probe")
        place = pressing(probe)
        silences: list[float] = []

        def at(t: float, force: Any) -> Any:
            # Where no force came between two looks, what was read between them is as old as the first says.
            before, now, after = probe.silence, probe.force, probe.silence
            if after >= before > 0.06:
                assert now.force == (0.0, 0.0, 0.0) and now.flags & pp.ForceFlags.RAMPING
            if silences and before >= silences[-1] > 0.06:
                assert force.force == (0.0, 0.0, 0.0)
            silences.append(before)
            if len(silences) == 300:
                os.kill(daemon.pid, sign)
            return None if len(silences) > 300 and before > 0.3 else place

        report = probe.run(at, seconds=20.0)
        assert silences[-1] > 0.3, "forces stopped"
        assert report.last.force == (0.0, 0.0, 0.0) and probe.wait(1).force == (0.0, 0.0, 0.0)
        seen = []
        while (force := forces.next(timeout=0.5)) is not None:
            seen.append(force)
        assert max(force.force[2] for force in seen) > 0.5, "what came is there as it came"
        assert seen[-1].force == (0.0, 0.0, 0.0) and seen[-1].tick == seen[-2].tick
        assert forces.silence is not None and forces.silence > 0.3
    os.kill(daemon.pid, signal.SIGCONT)
    os.kill(daemon.pid, signal.SIGKILL)
    with pytest.raises(pp.DaemonError):
        daemon.stop()


def test_in_lockstep_a_force_stays_and_its_age_is_told(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(rigid())
    with daemon.tool("probe") as probe:
        assert probe.silence is None
        for place in lower(100):
            force = probe.step(place)
        time.sleep(0.15)
        assert probe.force == force and force.force[2] > 0.5 and probe.silence > 0.15
    with pytest.raises(pp.ClientError, match="given back"):
        _ = probe.force


def test_simulated_devices_press_like_hands(palpate_daemon: Any) -> None:
    device = pp.SimulatedDevice("touch", hand="firm")
    assert "touch" in pp.SimulatedDevice.names() and device.rate == 1000.0
    for _ in range(2000):
        pose = device.step((0.01, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert pose.position[0] == pytest.approx(0.01, abs=1e-3)
    energy = device.energy()
    balance = energy["hand_j"] - energy["loop_j"] - energy["viscous_j"] - energy["coulomb_j"] - energy["kinetic_j"]
    assert abs(balance) < 1e-9
    with pytest.raises(ValueError, match="touch"):
        pp.SimulatedDevice("tuch")
    with pytest.raises(ValueError, match="dt"):
        device.step((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt=0.0)
    daemon = palpate_daemon(rigid())
    reports = []
    with daemon.tool("probe") as probe:
        reports.append(probe.drive(pp.SimulatedDevice("ideal", "relaxed"), "press", seconds=5.0, depth=0.003))
    assert reports[0]["poses"] == 5000 and reports[0]["peak_force_n"] > 0.1
    with daemon.tool("probe") as probe, pytest.raises(ValueError, match="press"):
        probe.drive(pp.SimulatedDevice(), "juggle", seconds=1.0)


def test_a_daemon_that_dies_under_a_tool_raises_its_last_words() -> None:
    daemon = pp.serve(rigid(), clock="lockstep")
    probe = daemon.tool("probe")
    probe.step((0.0, 0.0, 0.04))
    os.kill(daemon.pid, signal.SIGKILL)
    begun = time.monotonic()
    with pytest.raises(pp.DaemonError, match="signal 9") as caught:
        while True:
            probe.step((0.0, 0.0, 0.04), timeout=20.0)
    assert time.monotonic() - begun < 15.0, "noticed before the time is over"
    assert caught.value.code == -9 and "serving" in caught.value.words
    with pytest.raises(pp.DaemonError):
        daemon.scene()
    with pytest.raises(pp.DaemonError):
        daemon.stop()


def test_two_daemons_do_not_mix(palpate_daemon: Any) -> None:
    first, second = palpate_daemon(rigid()), palpate_daemon(soft())
    assert first.endpoint != second.endpoint
    with first.tool("probe") as probe, second.tool("ball") as ball:
        for a, b in zip(lower(20), press(20)):
            one, other = probe.step(a), ball.step(b)
        assert one.tick == other.tick == 20
    assert (first.tools(), second.tools()) == (["probe"], ["ball"])
    assert first.status().tick == 20


def test_a_port_in_use_is_told_with_the_daemons_words() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
        with pytest.raises(pp.DaemonError, match="cannot listen"):
            pp.serve(rigid(), listen=endpoint, timeout=10.0)
    with pp.serve(rigid()) as daemon, pytest.raises(pp.DaemonError, match="cannot listen"):
        pp.serve(rigid(), listen=daemon.endpoint, timeout=10.0)


def test_what_cannot_be_served_says_why(tmp_path: Path) -> None:
    bad = rigid()
    bad["tool"][0]["shape"] = {"sphere": {"radius_m": -1.0}}
    with pytest.raises(pp.SceneError, match="radius_m"):
        pp.serve(bad)
    there = tmp_path / "there.mcap"
    there.touch()
    with pytest.raises(pp.DaemonError, match="there.mcap"):
        pp.serve(rigid(), record=there)
    with pytest.raises(FileNotFoundError):
        pp.serve(tmp_path / "none.toml")
    with pytest.raises(pp.DaemonError, match="unexpected argument"):
        pp.serve(rigid(), arguments=["--dance"])
    with pytest.raises(pp.UnreachableError, match="palpate serve"):
        pp.connect("tcp/127.0.0.1:1")


def test_another_session_joins_a_running_daemon(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(rigid())
    with pp.connect(daemon.endpoint, observe=True) as session, daemon.tool("probe") as probe:
        forces = session.forces("probe")
        deadline = time.monotonic() + 20.0
        seen = None
        while seen is None and time.monotonic() < deadline:
            probe.step((0.0, 0.0, 0.04))
            seen = forces.next(timeout=0.1)
        assert isinstance(seen, pp.ToolForce)
        with pytest.raises(pp.NoAnswerError, match="nobody"):
            pp.connect(daemon.endpoint, instance="nobody", timeout=0.5).scene()
    with pytest.raises(pp.ClientError, match="closed"):
        session.scene()
    with pytest.raises(pp.ClientError, match="given back"):
        probe.send((0.0, 0.0, 0.04))


def test_the_page_of_a_daemon_is_shown_in_a_frame(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(rigid(), http="127.0.0.1:0")
    shown = daemon.show()._repr_html_()
    assert shown.startswith('<iframe src="http://127.0.0.1:')
    with pytest.raises(ValueError, match="http="):
        palpate_daemon(rigid()).show()


def test_nothing_is_left_behind_when_the_interpreter_ends(tmp_path: Path) -> None:
    program = textwrap.dedent(
        """
        import sys
        import palpate as pp
        daemon = pp.serve({scene!r}, clock="lockstep")
        tool = daemon.tool("probe")
        events = daemon.events()
        print(daemon.pid, flush=True)
        {end}
        """
    )
    for end in ("pass", "sys.exit(3)", "raise RuntimeError('out')", "import os; os.kill(os.getpid(), 9)"):
        run = subprocess.run(
            [sys.executable, "-c", program.format(scene=rigid(), end=end)],
            capture_output=True, text=True, timeout=120, cwd=tmp_path,
        )  # fmt: skip
        pid = int(run.stdout)
        assert gone(pid), f"{end}: process {pid} still runs"
        if end == "pass":
            assert (run.returncode, run.stderr) == (0, ""), run.stderr


def test_daemons_started_from_other_threads_outlive_them() -> None:
    import threading

    daemons: list[Any] = []
    thread = threading.Thread(target=lambda: daemons.append(pp.serve(rigid(), clock="lockstep")))
    thread.start()
    thread.join()
    time.sleep(0.3)
    with daemons[0] as daemon, daemon.tool("probe") as probe:
        assert probe.step((0.0, 0.0, 0.04)).tick == 1


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_waiting_for_a_force(palpate_daemon: Any) -> None:
    import threading

    daemon = palpate_daemon(rigid())
    with daemon.tool("probe") as probe:
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            probe.wait(10**6, timeout=60.0)
        assert probe.step((0.0, 0.0, 0.04)).tick == 1


def test_long_use_of_a_tool_holds_no_more_memory(palpate_daemon: Any) -> None:
    daemon = palpate_daemon(rigid())

    def held() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    with daemon.tool("probe") as probe:
        for _ in range(3000):
            probe.step((0.0, 0.0, 0.03))
        gc.collect()
        before = held()
        for _ in range(10_000):
            probe.step((0.0, 0.0, 0.03))
        gc.collect()
        assert held() - before < 4 << 20, f"{(held() - before) / 1e6:.1f} MB more"


def test_another_machine_without_tls_is_refused_before_it_is_asked() -> None:
    begun = time.monotonic()
    for endpoint in ("tcp/10.99.0.2:7447", "tls/10.99.0.2:7447", "tcp/0.0.0.0:7447"):
        with pytest.raises(pp.ClientError, match="insecure|--identity"):
            pp.connect(endpoint, timeout=30.0)
    assert time.monotonic() - begun < 20.0


@pytest.mark.parametrize("clock", ["realtime", "lockstep"])
def test_a_tool_that_another_client_holds_is_refused_by_name_and_gives_no_force(clock: str) -> None:
    with pp.serve(rigid(), clock=clock) as daemon, pp.connect(daemon.endpoint) as other:
        holder, early = daemon.tool("probe"), other.tool("probe")
        ended = threading.Event()

        def hold() -> None:
            for place in lower(100_000):
                if ended.is_set():
                    return
                holder.step(place)
                time.sleep(0.001)

        thread = threading.Thread(target=hold)
        thread.start()
        try:
            with pytest.raises(pp.HeldError, match='"probe"'):
                deadline = time.monotonic() + 30.0
                while time.monotonic() < deadline:
                    other.tool("probe").close()
            # It had the tool before the other moved it.
            with pytest.raises(pp.HeldError, match='"probe"'):
                early.step((0.0, 0.0, 0.1))
            with pytest.raises(pp.HeldError, match='"probe"'):
                early.run(lambda t, force: (0.0, 0.0, 0.1), seconds=30.0)
            with pytest.raises(pp.HeldError, match='"probe"'):
                early.drive(pp.SimulatedDevice(), "hold", seconds=30.0)
            assert early.force is None and early.received == 0
        finally:
            ended.set()
            thread.join()
