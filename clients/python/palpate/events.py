"""What happened: the kinds of a :class:`palpate.SimEvent`.

Generated from proto/src/messages.rs by `cargo run -p palpate-proto --example generate`; do not edit.
"""

from dataclasses import dataclass
from typing import Union

from .base import U8, U64


@dataclass(frozen=True)
class Reset:
    """State set back to the scene's start."""


@dataclass(frozen=True)
class Paused:
    """Loop paused."""


@dataclass(frozen=True)
class Resumed:
    """Loop resumed."""


@dataclass(frozen=True)
class ToolJoined:
    """A tool sends poses."""

    tool: str
    """Tool id."""


@dataclass(frozen=True)
class ToolLost:
    """No pose of a tool came for so long that the last one is stale."""

    tool: str
    """Tool id."""


@dataclass(frozen=True)
class PoseRefused:
    """A pose was refused."""

    tool: str
    """Tool id."""
    reason: str
    """Why."""


@dataclass(frozen=True)
class Fault:
    """A tick met a fault."""

    reason: str
    """What and where."""


@dataclass(frozen=True)
class RecordStarted:
    """A recording began."""

    path: str
    """Path."""


@dataclass(frozen=True)
class RecordStopped:
    """A recording ended."""

    path: str
    """Path."""


@dataclass(frozen=True)
class Stopping:
    """The daemon is going down."""


@dataclass(frozen=True)
class Overrun:
    """Ticks took longer than their period, or were woken too late: at most one such event a second for each stage."""

    stage: str
    """Stage that took most of their time: ``latch``, ``render``, ``deform``, ``hash``, ``emit``; ``wake``: the system
    came late.
    """
    count: U64
    """How many since the last such event."""
    worst_ns: U64
    """The longest of them, ns."""


@dataclass(frozen=True)
class QualityChanged:
    """The loop does less, or again more, to keep its rate."""

    level: U8
    """As ``quality_level`` of :class:`LoopStatus`."""
    reason: str
    """Why."""


@dataclass(frozen=True)
class DeviceTold:
    """A device said what it can do."""

    tool: str
    """Tool id."""
    name: str
    """Name of the device."""


@dataclass(frozen=True)
class RecordFailed:
    """A recording could not go on; the loop does, and what was flushed stays readable."""

    path: str
    """Path."""
    reason: str
    """Words of the system."""


@dataclass(frozen=True)
class SceneChanged:
    """Another scene runs from this tick on: bodies were merged or moved. Ask for the scene anew."""

    what: str
    """What became of which bodies."""


@dataclass(frozen=True)
class ForceWithheld:
    """A tool was seated inside a body: it gives no force until its contact force has been small once."""

    tool: str
    """Tool id."""


@dataclass(frozen=True)
class ForceDegraded:
    """A tool's force is less accurate than the scene asks for, from now on."""

    tool: str
    """Tool id."""
    reason: str
    """What is done instead."""


@dataclass(frozen=True)
class ForceRestored:
    """A tool's force is as accurate as the scene asks for again."""

    tool: str
    """Tool id."""
    ticks: U64
    """In how many ticks it was not."""


#: What happened. May grow at its end: skip an event that raises :class:`palpate.UnknownCase`.
EventKind = Union[
    Reset,
    Paused,
    Resumed,
    ToolJoined,
    ToolLost,
    PoseRefused,
    Fault,
    RecordStarted,
    RecordStopped,
    Stopping,
    Overrun,
    QualityChanged,
    DeviceTold,
    RecordFailed,
    SceneChanged,
    ForceWithheld,
    ForceDegraded,
    ForceRestored,
]

__all__ = [
    "DeviceTold",
    "EventKind",
    "Fault",
    "ForceDegraded",
    "ForceRestored",
    "ForceWithheld",
    "Overrun",
    "Paused",
    "PoseRefused",
    "QualityChanged",
    "RecordFailed",
    "RecordStarted",
    "RecordStopped",
    "Reset",
    "Resumed",
    "SceneChanged",
    "Stopping",
    "ToolJoined",
    "ToolLost",
]
