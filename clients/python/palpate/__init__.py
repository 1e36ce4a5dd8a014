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
    SurfaceError,
    TrailingBytes,
    Truncated,
    UnknownCase,
    UnknownNameError,
    UnreachableError,
    WrongSchema,
)
from .events import *  # noqa: F403
from .messages import *  # noqa: F403
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
    "to_html": "_notebook",
}

if TYPE_CHECKING:
    from ._client import Net, Session, Stream, Tool, connect
    from ._daemon import Daemon, serve
    from ._dtypes import CLOSEST, CONTACT
    from ._native import Batch, Output, Pose, Scene, SimulatedDevice, Simulation, Snapshot, Surface, build_id
    from ._notebook import to_html
    from ._recordings import Recording, ReplayReport, Ticks, figures, open
    from ._scenes import Trace
    from ._surfaces import (
        Branch,
        Derivatives,
        Fit,
        Isolation,
        Merged,
        Mesh,
        Pipe,
        branch,
        fit,
        isolate,
        merge,
        pipe,
    )

__all__ = [
    "MESSAGES",
    "BusyError",
    "ClientError",
    "DaemonError",
    "DecodeError",
    "DivergedError",
    "EncodeError",
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
    "SurfaceError",
    "TrailingBytes",
    "Truncated",
    "UnknownCase",
    "UnknownNameError",
    "UnreachableError",
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
        value = getattr(importlib.import_module(f"palpate.{module}"), name)
    except ModuleNotFoundError as error:
        if error.name != "palpate._native":
            raise
        raise ImportError(
            f"palpate.{name} needs the compiled part of the package, which is missing here: install a wheel "
            "(pip install palpate) or build it with maturin; the messages (palpate.wire) work without it"
        ) from error
    globals()[name] = value
    return value


def __dir__() -> "list[str]":
    return sorted({*globals(), *_COMPILED})
