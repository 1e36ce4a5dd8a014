"""A session with a daemon: its scene, tools, commands and streams of messages."""

import asyncio
import json
import math
import time
from collections.abc import AsyncIterator, Callable, Iterator
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Optional, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from . import _native, wire
from .base import Message
from .errors import DecodeError, NoAnswerError, UnknownCase
from .events import EventKind  # noqa: F401  (part of what events() gives)
from .messages import ContactSet, LoopStatus, SceneSnapshot, SimEvent, ToolContact, ToolForce
from .watchdog import FRESH_SPARSE_S, Watchdog

if TYPE_CHECKING:
    from ._daemon import Daemon
    from ._native import Pose, SimulatedDevice

T = TypeVar("T")

#: Where daemons listen unless told otherwise.
DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"
#: How long a force may stay away before a tool gives up, s.
PATIENCE_S = 5.0
#: Poses whose lateness a run keeps.
MOST_LATE = 100_000


class Net(NamedTuple):
    """Control net of a body."""

    tick: int
    revision: int
    body: str
    points: NDArray[np.float64]
    """(nu, nv, 3) m."""


class Stream(Generic[T]):
    """Messages as they arrive: iterate it, with ``for`` or ``async for``; close it or leave its ``with`` to end it.

    Iteration waits for the next message for as long as it takes; :meth:`next` waits for a given time.
    """

    def __init__(self, watch: "_native.Watch", read: Callable[["_native.Seen"], Optional[T]], past: "list[T]") -> None:
        self._watch = watch
        self._read = read
        self._past = past
        self._last = 0
        self._open = True

    def next(self, timeout: float = math.inf) -> Optional[T]:
        """The next message, or None when none came within ``timeout`` seconds."""
        if self._past:
            past = self._past.pop(0)
            self._last = max(self._last, getattr(past, "seq", 0))
            return past
        deadline = time.monotonic() + timeout
        while self._open:
            seen = self._watch.next(max(0.0, min(deadline - time.monotonic(), 1e6)))
            if seen is None:
                if time.monotonic() >= deadline:
                    return None
                continue
            message = self._read(seen)
            # Events that were asked for as past ones arrive once more.
            if message is not None and not 0 < getattr(message, "seq", self._last + 1) <= self._last:
                return message
        return None

    @property
    def silence(self) -> Optional[float]:
        """How long ago the newest message came, s; None before the first."""
        return self._watch.silence

    @property
    def dropped(self) -> int:
        """Messages that left unread because more than 65536 waited."""
        return self._watch.dropped

    def close(self) -> None:
        """Ends it."""
        self._open = False
        self._watch.close()

    def __iter__(self) -> Iterator[T]:
        return self

    def __next__(self) -> T:
        message = self.next()
        if message is None:
            raise StopIteration
        return message

    def __aiter__(self) -> AsyncIterator[T]:
        return self

    async def __anext__(self) -> T:
        while self._open:
            # Short waits, so that a cancelled task leaves no thread behind for long.
            message = await asyncio.get_running_loop().run_in_executor(None, self.next, 0.2)
            if message is not None:
                return message
        raise StopAsyncIteration

    def __enter__(self) -> "Stream[T]":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class _Forces(Stream[ToolForce]):
    """Forces as they arrive. When they stop coming, the last one comes again while it fades, and at the end is zero."""

    def __init__(self, watch: "_native.Watch") -> None:
        super().__init__(watch, self._take, [])
        # Whether the holder has a deadband is not known here.
        self._watchdog = Watchdog(deadband=True)
        #: The newest force, while it acts.
        self._acts: Optional[ToolForce] = None

    def _take(self, seen: "_native.Seen") -> Optional[ToolForce]:
        force = _read(ToolForce, seen)
        if force is None:
            return None
        # Of what waited to be read, the time counts at which it came.
        came = time.monotonic() - seen.age
        self._watchdog.heard(came)
        self._acts = force if any(force.force) or any(force.torque) else None
        return self._watchdog.felt(force, came)

    def next(self, timeout: float = math.inf) -> Optional[ToolForce]:
        """The next force, or None when none came within ``timeout`` seconds."""
        deadline = time.monotonic() + timeout
        while self._open:
            wait = max(0.0, deadline - time.monotonic())
            if self._acts is not None:
                wait = min(wait, max(1e-3, FRESH_SPARSE_S - (self._watchdog.silence() or 0.0)))
            force = super().next(wait)
            if force is not None:
                return force
            now = time.monotonic()
            if self._acts is not None and (self._watchdog.silence(now) or 0.0) > FRESH_SPARSE_S:
                faded = self._watchdog.felt(self._acts, now)
                if self._watchdog.gain(now) == 0.0:
                    self._acts = None
                return faded
            if now >= deadline:
                return None
        return None


class Rpc:
    """Commands of a daemon as methods: ``session.rpc.reset()``, ``session.rpc.merge(bodies=["a", "b"])``.

    Each returns the answer as a dictionary; ``tick`` is the first tick on which it has effect. Methods and arguments are
    in ``docs/wire.md``. Raises :class:`palpate.RefusedError` with the daemon's words.
    """

    def __init__(self, link: "_native.Link") -> None:
        self._link = link

    def __getattr__(self, method: str) -> Callable[..., "dict[str, Any]"]:
        if method.startswith("_"):
            raise AttributeError(method)

        def call(**arguments: Any) -> "dict[str, Any]":
            answer: dict[str, Any] = json.loads(self._link.call(method, json.dumps(arguments)))
            return answer

        call.__name__ = method
        return call


class Tool:
    """A held tool. Leave its ``with``, or :meth:`close` it, to give it back.

    Its forces are what a hand may feel: when none has come for 50 ms (100 ms with a deadband) the newest fades to zero
    within 10 ms, because the daemon may be gone and cannot say so; when they come again it comes back over 100 ms.
    Such a force has :attr:`palpate.ForceFlags.RAMPING`. In lockstep, where time stands still, none fades.
    """

    def __init__(self, native: "_native.Tool", session: "Session") -> None:
        self._native = native
        self._session = session

    @property
    def id(self) -> str:
        """Id in the scene."""
        return self._native.id

    @property
    def lockstep(self) -> bool:
        """The daemon waits for each pose."""
        return self._native.lockstep

    def send(self, pose: "Union[Pose, Any]") -> int:
        """Sends a pose (a :class:`palpate.Pose`, or 3, 7 or 13 numbers); returns its number."""
        return self._native.send(pose)

    def wait(self, seq: int, timeout: float = PATIENCE_S) -> ToolForce:
        """The force that answers pose number ``seq`` or a later one.

        Raises
        ------
        DaemonError
            The daemon of this session has ended; with its last words.
        HeldError
            Another client holds the tool: this one's poses are dropped.
        NoAnswerError
            No such force came within ``timeout`` seconds.
        """
        deadline = time.monotonic() + timeout
        while True:
            left = deadline - time.monotonic()
            # In slices, so that a daemon that has died is noticed early.
            force = self._native.wait(seq, max(0.0, min(left, 0.5)))
            if force is not None:
                return force
            self._session._check()
            if left <= 0.5:
                others = "; in lockstep a tick waits for a pose of every tool" if self.lockstep else ""
                raise NoAnswerError(f"no force for pose {seq} of tool {self.id!r} within {timeout} s{others}")

    def step(self, pose: "Union[Pose, Any]", timeout: float = PATIENCE_S) -> ToolForce:
        """Sends a pose and waits for its force: in lockstep one tick, in a scene with one tool."""
        return self.wait(self.send(pose), timeout)

    @property
    def force(self) -> Optional[ToolForce]:
        """The newest force as it may act now; None before the first."""
        return self._native.force()

    @property
    def silence(self) -> Optional[float]:
        """How long ago the newest force came, s; None before the first."""
        return self._native.silence()

    @property
    def received(self) -> int:
        """Forces received so far."""
        return self._native.received()

    def announce(self, **info: Any) -> None:
        """Tells the daemon what the device can do: fields of :class:`palpate.DeviceInfo`, for example
        ``name="arm", dof_force=3, force_max=8.0``."""
        fields = {
            "dof_force": 3, "dof_torque": 0, "workspace": [0.0, 0.0, 0.0], "force_max": 0.0, "force_continuous": 0.0,
            "torque_max": 0.0, "mass": 0.0, "damping": 0.0, "coulomb_friction": 0.0, "encoder_resolution": 0.0,
            "rate_hz": 0.0, "delay_s": 0.0, "deadband": 0.0,
        }  # fmt: skip
        self._native.announce({**fields, **info})

    def run(
        self,
        pose: "Callable[[float, Optional[ToolForce]], Union[Pose, Any, None]]",
        *,
        rate: float = 1000.0,
        seconds: Optional[float] = None,
    ) -> "RunReport":
        """Calls ``pose(t, force)`` at a rate and sends what it returns; ends when it returns None.

        Parameters
        ----------
        pose
            ``t`` in s from the start; ``force`` the newest :class:`palpate.ToolForce` as it may act now, None before
            the first.
        rate
            Poses per second. In lockstep the step of ``t``: each pose then waits for its force.
        seconds
            End after this long.

        Raises
        ------
        DaemonError, HeldError, NoAnswerError
            The daemon has ended, another client holds the tool, or no force came for 5 s.
        """
        if not (math.isfinite(rate) and rate > 0.0):
            raise ValueError(f"rate is {rate}; it must be finite and above 0")
        count = math.inf if seconds is None else round(seconds * rate)
        run = _lockstep if self.lockstep else _realtime
        return run(self, pose, rate, count)

    def drive(
        self,
        device: "SimulatedDevice",
        motion: str = "press",
        *,
        seconds: float = 10.0,
        depth: float = 0.004,
        rate: Optional[float] = None,
        delay: float = 0.0,
        jitter: float = 0.0,
        loss: float = 0.0,
        passivity: bool = False,
    ) -> "dict[str, Any]":
        """Moves this tool with a simulated device, as ``palpate device`` does; returns its report.

        Parameters
        ----------
        motion
            ``press``, ``slide``, ``tap``, ``circle``, ``pull``, ``tremor``, ``hold``, or a TOML file.
        depth
            How far beyond first contact the hand aims, m.
        delay, jitter
            Of the network, each way, s; ``loss``: share of messages lost.
        passivity
            Keep the device's port passive.
        """
        options = {
            "seconds": seconds,
            "depth": depth,
            "rate": rate,
            "delay": delay,
            "jitter": jitter,
            "loss": loss,
            "passivity": passivity,
        }
        try:
            report = device._drive(self._native, motion, options)
        except NoAnswerError:
            self._session._check()
            raise
        told: dict[str, Any] = json.loads(report)
        return told

    def close(self) -> None:
        """Gives the tool back."""
        self._native.close()

    def __enter__(self) -> "Tool":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class RunReport(NamedTuple):
    """What a run of :meth:`Tool.run` did."""

    poses: int
    """Poses sent."""
    forces: int
    """Forces received."""
    seconds: float
    """Wall time."""
    last: Optional[ToolForce]
    """The newest force."""
    late: "NDArray[np.float64]"
    """How late poses were sent, s: of each, or of the last 100,000 in any order; empty in lockstep."""


def _lockstep(tool: Tool, pose: Callable[..., Any], rate: float, count: float) -> RunReport:
    begun, force, sent = time.perf_counter(), None, 0
    while sent < count:
        wanted = pose(sent / rate, force)
        if wanted is None:
            break
        force = tool.step(wanted)
        sent += 1
    return RunReport(sent, sent, time.perf_counter() - begun, force, np.zeros(0))


def _realtime(tool: Tool, pose: Callable[..., Any], rate: float, count: float) -> RunReport:
    native = tool._native
    kept = max(1, int(min(count, MOST_LATE)))
    lateness = np.zeros(kept)
    begun, before = time.perf_counter(), native.received()
    heard, heard_at, sent = before, begun, 0
    while sent < count:
        due = begun + sent / rate
        now = time.perf_counter()
        if now < due:
            time.sleep(due - now)
            now = time.perf_counter()
        elif now - due > 1.0:
            # A process that slept must not send a burst: the clock goes on from here.
            begun = now - sent / rate
        wanted = pose(now - begun, native.force())
        if wanted is None:
            break
        native.send(wanted)
        lateness[sent % kept] = max(0.0, now - due)
        sent += 1
        if sent % 128 == 0:
            received = native.received()
            if received != heard:
                heard, heard_at = received, now
            elif now - heard_at > 0.5:
                tool._session._check()
                if now - heard_at > PATIENCE_S:
                    raise NoAnswerError(f"no force for tool {tool.id!r} in {PATIENCE_S} s")
    return RunReport(
        sent, native.received() - before, time.perf_counter() - begun, native.force(), lateness[:sent]
    )


class Session:
    """A session with one daemon. Leave its ``with``, or :meth:`close` it, to end it."""

    def __init__(self, link: "_native.Link", daemon: "Optional[Daemon]" = None) -> None:
        self._link = link
        self._daemon = daemon
        self._open: list[Any] = []
        #: Commands.
        self.rpc = Rpc(link)

    def _check(self) -> None:
        """Raises when the daemon is ours and has ended."""
        if self._daemon is not None:
            self._daemon.check()

    def scene(self) -> SceneSnapshot:
        """Bodies, tools, knots and nets as they are now."""
        self._check()
        return wire.decode(SceneSnapshot, self._link.scene())

    def status(self) -> LoopStatus:
        """Health of the loop now."""
        self._check()
        return wire.decode(LoopStatus, self._link.status())

    def tools(self) -> "list[str]":
        """Ids of the scene's tools."""
        return [tool.id for tool in self.scene().tools]

    def bodies(self) -> "list[str]":
        """Ids of the scene's bodies."""
        return [body.id for body in self.scene().bodies]

    def info(self) -> "dict[str, Any]":
        """What the daemon says about itself."""
        told: dict[str, Any] = json.loads(self._link.info())
        return told

    def metrics(self) -> str:
        """Counters as OpenMetrics text."""
        return self._link.metrics()

    def tool(self, id: str) -> Tool:
        """Takes a tool of the scene.

        Raises
        ------
        UnknownNameError
            The scene has no such tool; it lists what there is.
        HeldError
            Another client moves it.
        """
        self._check()
        tool = Tool(self._link.tool(id), self)
        self._open.append(tool)
        return tool

    def events(self, *, past: bool = False) -> "Stream[SimEvent]":
        """Events as they happen; with ``past`` first the last 256. Kinds that this version does not know are left out."""
        watch = self._link.watch("event", False)
        before: list[SimEvent] = []
        if past:
            before = [wire.decode(SimEvent, data) for data in self._link.past_events(0)]
        return self._stream(watch, _reader(SimEvent), before)

    def nets(self, body: str) -> "Stream[Net]":
        """Control nets of a body as they change, the newest: what comes faster than it is read is skipped."""
        known = self.bodies()
        if body not in known:
            raise KeyError(f"this scene has no body {body!r}; it has {', '.join(map(repr, known))}")
        return self._stream(self._link.watch(f"body/{body}/net", True), lambda seen: Net(*seen.net()), [])

    def forces(self, tool: str) -> "Stream[ToolForce]":
        """Forces of a tool that somebody else holds.

        When none has come for 100 ms, the last one comes again while it fades to zero within 10 ms, and those that come
        after it begin at zero, marked :attr:`palpate.ForceFlags.RAMPING`; not in lockstep, nor of a recording that is
        played.
        """
        watch = self._link.watch(f"tool/{tool}/force", False)
        about = self.info()
        if about.get("lockstep") or about.get("played"):
            return self._stream(watch, _reader(ToolForce), [])
        return self._keep(_Forces(watch))

    def tool_contacts(self, tool: str) -> "Stream[ToolContact]":
        """What contacts do to a tool, every tick."""
        return self._stream(self._link.watch(f"tool/{tool}/contact", False), _reader(ToolContact), [])

    def contacts(self) -> "Stream[ContactSet]":
        """Contacts of all pairs, at most 60 times a second; the newest."""
        return self._stream(self._link.watch("contact", True), _reader(ContactSet), [])

    def statuses(self) -> "Stream[LoopStatus]":
        """The status, ten times a second; the newest."""
        return self._stream(self._link.watch("status", True), _reader(LoopStatus), [])

    def show(self, width: int = 960, height: int = 640) -> Any:
        """The daemon's page in a notebook (an IFrame on loopback). Needs a daemon with a page: ``http=``."""
        from ._notebook import _show_session

        return _show_session(self, width, height)

    def _stream(self, watch: "_native.Watch", read: Callable[["_native.Seen"], Optional[T]], past: "list[T]") -> "Stream[T]":
        return self._keep(Stream(watch, read, past))

    def _keep(self, stream: "Stream[T]") -> "Stream[T]":
        self._open.append(stream)
        return stream

    def close(self) -> None:
        """Ends the session; tools are given back, streams end."""
        for part in self._open:
            part.close()
        self._open.clear()
        self._link.close()

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


M = TypeVar("M", bound=Message)


def _read(kind: "type[M]", seen: "_native.Seen") -> "Optional[M]":
    try:
        return wire.decode(kind, seen.payload)
    except (UnknownCase, DecodeError):
        # Newer than this version, or somebody else's; the daemon checks what it sends.
        return None


def _reader(kind: "type[M]") -> "Callable[[_native.Seen], Optional[M]]":
    return lambda seen: _read(kind, seen)


def connect(
    endpoint: "Union[str, list[str]]" = DEFAULT_ENDPOINT,
    *,
    instance: str = "default",
    timeout: float = 5.0,
    observe: bool = False,
    zenoh_config: Optional[str] = None,
    insecure: bool = False,
) -> Session:
    """Connects to a running daemon.

    Parameters
    ----------
    endpoint
        For example ``tls/lab.example:7447`` with an identity as ``zenoh_config``; or several.
    instance
        Name that the daemon was given.
    timeout
        How long to wait for answers, s.
    observe
        Receive also what other clients publish.
    zenoh_config
        A Zenoh configuration file (JSON5) instead of a plain peer.
    insecure
        Also connect to another machine without TLS, where nobody knows who answers.

    Raises
    ------
    UnreachableError, NoAnswerError
        Nobody listens there, or no such instance.
    ClientError
        A link to another machine without TLS, and no ``insecure``.
    """
    endpoints = [endpoint] if isinstance(endpoint, str) else list(endpoint)
    return Session(_native.Link(endpoints, instance, timeout, observe, zenoh_config, insecure))
