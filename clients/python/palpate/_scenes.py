"""What simulations give for whole trajectories."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Trace:
    """Outputs of one tick after the other; rows are ticks."""

    tick: NDArray[np.uint64]
    """(ticks,)"""
    hash: NDArray[np.uint64]
    """(ticks,) hash of the state after each tick."""
    force: "dict[str, NDArray[np.float64]]"
    """By tool (ticks, 3): force for the device, N."""
    torque: "dict[str, NDArray[np.float64]]"
    """By tool (ticks, 3): N·m."""
    contact_force: "dict[str, NDArray[np.float64]]"
    """By tool (ticks, 3): force of all contacts, N."""
    depth: "dict[str, NDArray[np.float64]]"
    """By tool (ticks,): penetration, m."""
    flags: "dict[str, NDArray[np.uint32]]"
    """By tool (ticks,): bits of :class:`palpate.ForceFlags`."""
    error_n: "dict[str, NDArray[np.float64]]"
    """By tool (ticks,): how far contact forces may be from those of the exact step, N."""


def _trace(columns: "dict[str, Any]") -> Trace:
    return Trace(**columns)
