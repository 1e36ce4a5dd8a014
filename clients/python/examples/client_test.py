"""How a project tests its own client: run it with pytest. The fixtures come with the package.

pytest client_test.py
"""

from pathlib import Path
from typing import Any

SCENE = {
    "body": [{"id": "ball", "surface": {"builtin": "sphere", "size": 0.02}}],
    "tool": [
        {
            "id": "probe",
            "shape": {"sphere": {"radius_m": 0.01}},
            "pose": {"position": [0.0, 0.0, 0.04]},
            "coupling": {"stiffness_n_m": 500.0, "damping_n_s_m": 0.0},
            "device": {"ramp_s": 0.0},
        }
    ],
}


def my_client(tool: Any) -> float:
    """The client under test: lowers the probe until it feels half a newton; returns the height, m."""
    height, force = 0.031, 0.0
    while force < 0.5:
        height -= 1e-5
        force = tool.step((0.0, 0.0, height)).force[2]
    return height


def test_the_client_stops_at_half_a_newton(palpate_daemon: Any) -> None:
    with palpate_daemon(SCENE).tool("probe") as probe:
        # 500 N/m: half a newton is a millimetre below the first contact at 30 mm.
        assert abs(my_client(probe) - 0.029) < 2e-5


def test_a_session_of_the_client_replays(palpate_daemon: Any, assert_replays: Any, tmp_path: Path) -> None:
    daemon = palpate_daemon(SCENE, record=tmp_path / "client.mcap")
    with daemon.tool("probe") as probe:
        my_client(probe)
    daemon.stop()
    assert assert_replays(tmp_path / "client.mcap").ticks_matched > 100
