"""Scenes and trajectories that the tests share. The installed package is tested, not the directory beside."""

import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palpate as pp

ROOT = Path(__file__).resolve().parents[4]


def rigid() -> "dict[str, Any]":
    """A rigid ball of radius 20 mm at the origin, and a ball of radius 10 mm above it."""
    return {
        "name": "rigid",
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


def soft() -> "dict[str, Any]":
    """A soft teardrop with few nodes, and a ball beside it."""
    return {
        "name": "soft",
        "body": [
            {
                "id": "drop",
                "surface": {"builtin": "teardrop", "net": [8, 8]},
                "model": "lattice",
                "material": {"young_pa": 20e3, "density_kg_m3": 1000.0},
                "lattice": {"layers": 2, "refine": "none"},
                "fixed": [{"point": [0.0, 0.0, 0.015], "normal": [0.0, 0.0, 1.0]}],
            }
        ],
        "tool": [
            {"id": "ball", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"position": [0.06, 0.003, 0.045]}}
        ],
    }


def press(ticks: int, depth: float = 0.05) -> Any:
    """Positions (ticks, 3) of a ball that is pushed against the soft teardrop."""
    way = depth * np.minimum(np.arange(ticks) / (0.75 * ticks), 1.0)
    return np.column_stack([0.06 - way, np.full(ticks, 0.003), np.full(ticks, 0.045)])


def lower(ticks: int, depth: float = 0.002) -> Any:
    """Positions (ticks, 3) of a probe that is lowered into the rigid ball."""
    height = 0.03 - depth * np.minimum(np.arange(ticks) / (0.5 * ticks), 1.0)
    return np.column_stack([np.zeros(ticks), np.zeros(ticks), height])


@pytest.fixture(scope="session")
def rigid_scene() -> pp.Scene:
    return pp.Scene(rigid())


@pytest.fixture(scope="session")
def soft_scene() -> pp.Scene:
    return pp.Scene(soft())


@pytest.fixture(scope="session")
def pressed(tmp_path_factory: pytest.TempPathFactory) -> "tuple[Path, Any]":
    """A recording of a scripted press in lockstep, and the forces that its client received."""
    path = tmp_path_factory.mktemp("recordings") / "press.mcap"
    with pp.serve(soft(), clock="lockstep", record=path) as daemon, daemon.tool("ball") as ball:
        forces = [ball.step(place).force for place in press(400)]
    return path, np.array(forces)


@pytest.fixture
def ctrl_c() -> "Iterator[None]":
    """Ctrl-C raises, as in a shell: what a script starts in the background ignores it from the start."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
