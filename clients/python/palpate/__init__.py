"""Haptic simulation of deforming B-spline surfaces: in process, in batches, from a daemon, from recordings.

>>> import palpate as pp
>>> scene = pp.Scene({
...     "body": [{"id": "ball", "surface": {"builtin": "sphere", "size": 0.02}}],
...     "tool": [{"id": "pen", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"position": [0.0, 0.0, 0.04]}}],
... })
>>> sim = scene.simulate()
>>> out = sim.step({"pen": pp.Pose(position=(0.0, 0.0, 0.04))}, ticks=10)
>>> out.tick, float(out.force["pen"][2])
(10, 0.0)

The messages of the bus (:mod:`palpate.wire`, :mod:`palpate.messages`) are pure Python: they can be imported where the
compiled part is missing. Guide: ``docs/python.md`` of the project.
"""

from typing import TYPE_CHECKING, Any

from . import events as _events
from . import messages as _messages
from .base import Message
from .errors import (
    BusyError,
    ClientError,
    DaemonError,
    DecodeError,
    DivergedError,
    EncodeError,
    HeldError,
    Malformed,
    NoAnswerError,
    NotPicklableError,
    Oversized,
    PalpateError,
    Problem,
    RecordingError,
    RecordingWarning,
    RefusedError,
    SceneError,
    SceneWarning,
    SurfaceError,
    SweepError,
    TrailingBytes,
    Truncated,
    UnknownCase,
    UnknownNameError,
    UnreachableError,
    WrongSchema,
)
from .events import *  # noqa: F403
from .messages import *  # noqa: F403
from .watchdog import Watchdog
from .wire import MESSAGES, decode, encode, encoding_schema, to_json

__version__ = "0.1.0"

# By name: the module that has it. They need the compiled part and NumPy, and are imported when they are used.
_COMPILED = {
    "Batch": "_native",
    "Branch": "_surfaces",
    "CLOSEST": "_dtypes",
    "CONTACT": "_dtypes",
    "Daemon": "_daemon",
    "Derivatives": "_surfaces",
    "Fit": "_surfaces",
    "Isolation": "_surfaces",
    "Merged": "_surfaces",
    "Mesh": "_surfaces",
    "Net": "_client",
    "Output": "_native",
    "PART_CLOSEST": "_dtypes",
    "Part": "_native",
    "Pipe": "_surfaces",
    "Pose": "_native",
    "Recording": "_recordings",
    "ReplayReport": "_recordings",
    "Scene": "_native",
    "Session": "_client",
    "SimulatedDevice": "_native",
    "Simulation": "_native",
    "Snapshot": "_native",
    "Stream": "_client",
    "Surface": "_native",
    "SweepTable": "_sweeps",
    "Ticks": "_recordings",
    "Tool": "_client",
    "Trace": "_scenes",
    "branch": "_surfaces",
    "build_id": "_native",
    "connect": "_client",
    "figures": "_recordings",
    "fit": "_surfaces",
    "isolate": "_surfaces",
    "merge": "_surfaces",
    "open": "_recordings",
    "pipe": "_surfaces",
    "serve": "_daemon",
    "sweep": "_sweeps",
    "to_html": "_notebook",
}

if TYPE_CHECKING:
    from ._client import Net as Net
    from ._client import Session as Session
    from ._client import Stream as Stream
    from ._client import Tool as Tool
    from ._client import connect as connect
    from ._daemon import Daemon as Daemon
    from ._daemon import serve as serve
    from ._dtypes import CLOSEST as CLOSEST
    from ._dtypes import CONTACT as CONTACT
    from ._dtypes import PART_CLOSEST as PART_CLOSEST
    from ._native import Batch as Batch
    from ._native import Output as Output
    from ._native import Part as Part
    from ._native import Pose as Pose
    from ._native import Scene as Scene
    from ._native import SimulatedDevice as SimulatedDevice
    from ._native import Simulation as Simulation
    from ._native import Snapshot as Snapshot
    from ._native import Surface as Surface
    from ._native import build_id as build_id
    from ._notebook import to_html as to_html
    from ._recordings import Recording as Recording
    from ._recordings import ReplayReport as ReplayReport
    from ._recordings import Ticks as Ticks
    from ._recordings import figures as figures
    from ._recordings import open as open
    from ._scenes import Trace as Trace
    from ._surfaces import Branch as Branch
    from ._surfaces import Derivatives as Derivatives
    from ._surfaces import Fit as Fit
    from ._surfaces import Isolation as Isolation
    from ._surfaces import Merged as Merged
    from ._surfaces import Mesh as Mesh
    from ._surfaces import Pipe as Pipe
    from ._surfaces import branch as branch
    from ._surfaces import fit as fit
    from ._surfaces import isolate as isolate
    from ._surfaces import merge as merge
    from ._surfaces import pipe as pipe
    from ._sweeps import SweepTable as SweepTable
    from ._sweeps import sweep as sweep

__all__ = [
    "MESSAGES",
    "BusyError",
    "ClientError",
    "DaemonError",
    "DecodeError",
    "DivergedError",
    "EncodeError",
    "HeldError",
    "Malformed",
    "Message",
    "NoAnswerError",
    "NotPicklableError",
    "Oversized",
    "PalpateError",
    "Problem",
    "RecordingError",
    "RecordingWarning",
    "RefusedError",
    "SceneError",
    "SceneWarning",
    "SurfaceError",
    "SweepError",
    "TrailingBytes",
    "Truncated",
    "UnknownCase",
    "UnknownNameError",
    "UnreachableError",
    "Watchdog",
    "WrongSchema",
    "decode",
    "encode",
    "encoding_schema",
    "to_json",
]
__all__ += _messages.__all__
__all__ += _events.__all__


def __getattr__(name: str) -> Any:
    module = _COMPILED.get(name)
    if module is None:
        if name == "gym":
            import importlib

            return importlib.import_module("palpate.gym")
        raise AttributeError(f"module 'palpate' has no attribute {name!r}")
    import importlib

    try:
        if module in ("_client", "_daemon", "_sweeps") or name == "to_html":
            # Only there with the feature `daemon`.
            importlib.import_module("palpate._native").Link  # noqa: B018
        value = getattr(importlib.import_module(f"palpate.{module}"), name)
    except ModuleNotFoundError as error:
        if error.name != "palpate._native":
            raise
        raise ImportError(
            f"palpate.{name} needs the compiled part of the package, which is missing here: install a wheel "
            "(pip install palpate) or build it with maturin; the messages (palpate.wire) work without it"
        ) from error
    except AttributeError as error:
        raise ImportError(
            f"palpate.{name} needs a module built with the feature `daemon`; this one simulates and reads recordings only"
        ) from error
    globals()[name] = value
    return value


def __dir__() -> "list[str]":
    from importlib.util import find_spec

    # Who asks for names then asks for their values.
    there = find_spec("palpate._native") is not None and find_spec("numpy") is not None
    return sorted({*globals(), *(_COMPILED if there else ())})
