"""The messages of the bus as frozen dataclasses. SI units; quaternions are x y z w; world frame; times are
nanoseconds.

``docs/wire.md`` of the project lists which key carries which message.

Generated from proto/src/messages.rs by `cargo run -p palpate-proto --example generate`; do not edit.
"""

import enum
from dataclasses import dataclass
from typing import Optional

from .base import U8, U16, U32, U64, Hash, Message, Quaternion, Vector
from .events import EventKind


@dataclass(frozen=True)
class ToolPose(Message):
    """Pose and velocity of a tool, sent by whoever holds it. World frame."""

    NAME = "palpate.ToolPose.v1"
    KEY = "palpate/{instance}/tool/{tool}/pose"
    MAX_BYTES = 134

    seq: U64
    """Counts the poses of this client from 1; must grow."""
    t_client_ns: U64
    """Sender's clock, ns; echoed in :class:`ToolForce` so that the sender can measure its round trip."""
    position: Vector
    """Reference point of the tool, m."""
    orientation: Quaternion
    """Unit quaternion x y z w."""
    linear_velocity: Vector = (0.0, 0.0, 0.0)
    """m/s."""
    angular_velocity: Vector = (0.0, 0.0, 0.0)
    """rad/s."""
    buttons: U32 = 0
    """Bit 0: grab. While it is set, the tool holds on to what it touches."""
    flags: U32 = 0
    """Reserved, 0."""


#: While it is set, the tool holds on to what it touches.
GRAB = 1


class ForceFlags(enum.IntFlag):
    """Bits of ``flags`` of :class:`ToolForce`."""

    STALE = 1
    """The newest pose is older than the stale limit; the force ramps to zero."""
    SATURATED = 2
    """The force was limited to what the device can bear."""
    PAUSED = 4
    """The simulation is paused."""
    REFUSED = 8
    """The last pose was refused (a jump, or not finite)."""
    RAMPING = 16
    """The force is being ramped up or down."""
    FAULT = 32
    """The tick met a fault; the force is safe, not right."""
    GRABBING = 64
    """The tool holds on to what it grabbed."""
    DAMPED = 128
    """A damper was added to keep the loop from making energy."""
    WITHHELD = 256
    """No force: the tool was seated inside a body, and its contact force was not small once since then."""
    DEGRADED = 512
    """The force is less accurate than the scene asks for: the step of a body that the tool presses fell back to another
    matrix or was shortened, quality is lowered, or the force may be off by more than 5 % and 0.02 N.
    """


@dataclass(frozen=True)
class ToolForce(Message):
    """The force a hand should feel: wrench on the tool, world axes, at the tool's reference point."""

    NAME = "palpate.ToolForce.v1"
    KEY = "palpate/{instance}/tool/{tool}/force"

    tick: U64
    """Tick that made it."""
    pose_seq: U64
    """``seq`` of the pose that took effect (0: none yet)."""
    t_client_ns: U64
    """``t_client_ns`` of that pose."""
    t_server_ns: U64
    """Server's clock when published, ns."""
    force: Vector
    """N."""
    torque: Vector
    """N·m."""
    proxy_position: Vector
    """Where the surface holds the tool back, m."""
    proxy_orientation: Quaternion
    """x y z w."""
    depth: float
    """Penetration of the device's tool into the surface, m; 0 without contact."""
    contact_count: U16
    """Contact regions."""
    flags: U32
    """:class:`ForceFlags`."""


@dataclass(frozen=True)
class ToolForceV2(Message):
    """:class:`ToolForce`, and how far it may be off. Sent while somebody subscribes."""

    NAME = "palpate.ToolForce.v2"
    KEY = "palpate/{instance}/tool/{tool}/force_v2"

    tick: U64
    """Tick that made it."""
    pose_seq: U64
    """``seq`` of the pose that took effect (0: none yet)."""
    t_client_ns: U64
    """``t_client_ns`` of that pose."""
    t_server_ns: U64
    """Server's clock when published, ns."""
    force: Vector
    """N."""
    torque: Vector
    """N·m."""
    proxy_position: Vector
    """Where the surface holds the tool back, m."""
    proxy_orientation: Quaternion
    """x y z w."""
    depth: float
    """Penetration of the device's tool into the surface, m; 0 without contact."""
    contact_count: U16
    """Contact regions."""
    flags: U32
    """:class:`ForceFlags`."""
    error_n: float
    """How far the force may be from the one that the exact step of the same length would give from the same state, N:
    an estimate, 0 on rigid bodies.
    """
    jaw_force: float = 0.0
    """Reserved for the force on a jaw, N or N·m; 0."""


@dataclass(frozen=True)
class ToolContact(Message):
    """What all contacts do to a tool, before anything is limited for the device: what a sensor between tool and body
    would read. World axes, at the tool's reference point. Sent while somebody subscribes.
    """

    NAME = "palpate.ToolContact.v1"
    KEY = "palpate/{instance}/tool/{tool}/contact"

    tick: U64
    """Tick that made it."""
    pose_seq: U64
    """``seq`` of the pose that took effect (0: none yet)."""
    t_client_ns: U64
    """``t_client_ns`` of that pose."""
    force: Vector
    """N."""
    torque: Vector
    """N·m."""
    energy_j: float
    """Net work done by the device on the loop since the start, J; what is below zero, the loop has made."""
    dissipated_j: float
    """Part of it that the passivity controller took away, J."""
    force_limit: float
    """Greatest force that the loop gives this tool's device, N."""


@dataclass(frozen=True)
class DeviceInfo(Message):
    """What the device that holds a tool can do, as its client describes it. Zero where unknown."""

    NAME = "palpate.DeviceInfo.v1"
    KEY = "palpate/{instance}/tool/{tool}/device"
    MAX_BYTES = 180

    name: str
    """Its name, at most 64 bytes, without control characters."""
    dof_force: U8 = 0
    """Directions in which it can push, 0 to 3. None, and none to turn: it has no motors, as a mouse."""
    dof_torque: U8 = 0
    """Axes about which it can turn, 0 to 3."""
    workspace: Vector = (0.0, 0.0, 0.0)
    """Box in which its tool can go, m."""
    force_max: float = 0.0
    """Greatest force, N."""
    force_continuous: float = 0.0
    """Greatest force that it can hold for long, N; at most ``force_max``."""
    torque_max: float = 0.0
    """Greatest torque, N·m."""
    mass: float = 0.0
    """Mass that the hand feels at its tool, kg."""
    damping: float = 0.0
    """Its own viscous damping, N·s/m."""
    coulomb_friction: float = 0.0
    """Its own Coulomb friction, N."""
    encoder_resolution: float = 0.0
    """Step of its position sensor at the tool, m."""
    rate_hz: float = 0.0
    """Rate of its own loop, Hz."""
    delay_s: float = 0.0
    """Delay between it and the daemon, one way, s."""
    deadband: float = 0.0
    """Relative change of the force below which a hand feels none (Weber fraction), 0 to 0.99; the daemon then leaves
    such forces out. 0: every force is sent.
    """


@dataclass(frozen=True)
class ControlNet(Message):
    """Full control net of a body, u-major. The next one replaces a lost one."""

    NAME = "palpate.ControlNet.v1"
    KEY = "palpate/{instance}/body/{body}/net"

    tick: U64
    """Tick it belongs to."""
    revision: U64
    """Grows with every change of the net."""
    body: str
    """Body id."""
    degree_u: U8
    """Degree in u."""
    degree_v: U8
    """Degree in v."""
    count_u: U16
    """Rows (u)."""
    count_v: U16
    """Columns (v)."""
    points: tuple[Vector, ...]
    """u-major: point (i, j) is number ``i * count_v + j``, m."""
    weights: Optional[tuple[float, ...]] = None
    """Weights of a rational surface, same order."""


@dataclass(frozen=True)
class Contact:
    """One contact of a tool with a body, or of two bodies."""

    tool: str
    """Tool id; between two bodies, the id of the other body (the same one, when a body touches itself)."""
    body: str
    """Body id."""
    u: float
    """Surface parameter."""
    v: float
    """Surface parameter."""
    point: Vector
    """Point on the body's surface, m."""
    normal: Vector
    """Outward unit normal of the body."""
    depth: float
    """Penetration depth of the device's tool, m; between bodies, what the contact solve left."""
    force: Vector
    """This contact's share of the force on the tool (or other body), N."""


@dataclass(frozen=True)
class ContactSet(Message):
    """Contacts that carry force in a tick, the deepest: 16, or 2 per tool if that is more."""

    NAME = "palpate.ContactSet.v1"
    KEY = "palpate/{instance}/contact"

    tick: U64
    """Tick."""
    contacts: tuple[Contact, ...]
    """Deepest first."""


@dataclass(frozen=True)
class Quantiles:
    """A duration over the last status period."""

    p50_ns: U64
    """Median, ns."""
    p99_ns: U64
    """99th percentile, ns."""
    max_ns: U64
    """Maximum, ns."""


class LoopState(enum.IntEnum):
    """What the loop does."""

    RUNNING = 0
    """Ticking."""
    PAUSED = 1
    """Paused by rpc."""
    STOPPING = 2
    """Ramping forces down before the end."""


@dataclass(frozen=True)
class ToolLink:
    """Counters of one tool's link."""

    tool: str
    """Tool id."""
    received: U64
    """Poses received and accepted by the wire."""
    superseded: U64
    """Poses that a newer one replaced before a tick could use them."""
    wrong_version: U64
    """Another type or version in the encoding's schema."""
    malformed: U64
    """Not the bytes of a pose: truncated, or with bytes after its end."""
    oversized: U64
    """More bytes than a pose can have."""
    not_finite: U64
    """A value that is NaN or infinite."""
    bad_quaternion: U64
    """A quaternion whose length is not 1 within 1e-6."""
    duplicated: U64
    """The number of the newest pose once more."""
    out_of_order: U64
    """A number below that of the newest pose."""
    jumps: U64
    """Refused by the loop as a jump."""
    stale_ticks: U64
    """Ticks whose newest pose was stale."""
    energy_j: float
    """Net work done by the hand on the tool so far, J."""
    forces_sent: U64
    """Forces sent to whoever moves it."""
    forces_overtaken: U64
    """Forces that were not sent while somebody moved it, because a newer one was there: the daemon is short of time."""
    forces_lost: U64
    """Forces that were sent and did not arrive, as far as its clients say what they receive."""


class RecorderState(enum.IntEnum):
    """What is being recorded."""

    OFF = 0
    """Nothing."""
    RECORDING = 1
    """A file is being written."""
    RING = 2
    """The last seconds are kept in memory; no file."""
    FAILED = 3
    """The disk refused; what was flushed stays readable."""


@dataclass(frozen=True)
class LoopStatus(Message):
    """Health of the loop, ten times a second."""

    NAME = "palpate.LoopStatus.v4"
    KEY = "palpate/{instance}/status"

    tick: U64
    """Newest tick."""
    state: LoopState
    """What the loop does."""
    rate_hz: float
    """Nominal rate, Hz."""
    late_ticks: U64
    """Ticks that began more than 100 µs after their deadline."""
    skipped_ticks: U64
    """Deadlines dropped because a tick overran them."""
    period: Quantiles
    """Time between tick starts."""
    step: Quantiles
    """Time in a tick."""
    tools: tuple[ToolLink, ...]
    """One per tool."""
    recorder: RecorderState
    """What is being recorded."""
    recorder_bytes: U64
    """Bytes written by the recorder."""
    recorder_drops: U64
    """Records lost because the recorder could not keep up."""
    quality_level: U8
    """0 is full quality; 1: bodies iterate once a step; 2: also fewer sweeps over contacts; 3: also nets ten times
    rarer.
    """
    followed_tool: str
    """Tool whose poses the deadlines of ticks follow; empty: none."""
    shift_s: float
    """How far deadlines have moved from the fixed grid of the first tick, s."""
    wait: Quantiles
    """Time from the arrival of a pose to the tick that took it; of each tick the longest."""


@dataclass(frozen=True)
class SimEvent(Message):
    """An event, numbered so that a loss is seen."""

    NAME = "palpate.SimEvent.v1"
    KEY = "palpate/{instance}/event"

    tick: U64
    """Tick."""
    seq: U64
    """Counts events from 1."""
    t_ns: U64
    """Server clock, ns since the Unix epoch."""
    kind: EventKind
    """What."""


@dataclass(frozen=True)
class BodySnapshot:
    """A body as the loop simulates it."""

    id: str
    """Id."""
    model: str
    """Model name: ``rigid``, ``lattice``."""
    degree: tuple[U8, U8]
    """Degree, u then v."""
    periodic: tuple[bool, bool]
    """Periodic, u then v."""
    knots: tuple[tuple[float, ...], tuple[float, ...]]
    """Knots in u and in v, in the convention of ``palpate.surface.v1``."""
    count: tuple[U16, U16]
    """Net size, u then v."""
    points: tuple[Vector, ...]
    """Net now, u-major, m."""
    rest_points: tuple[Vector, ...]
    """Net at rest, u-major, m."""
    weights: Optional[tuple[float, ...]]
    """Weights, if rational."""
    revision: U64
    """Revision of ``points``."""


@dataclass(frozen=True)
class ToolSnapshot:
    """A tool of the scene."""

    id: str
    """Id."""
    shape: str
    """``point``, ``sphere``, ``plane``, ``implicit``, ``mesh`` or ``surface``."""
    radius: float
    """Radius of a sphere, else 0, m."""
    stiffness: float
    """Stiffness of the virtual coupling, N/m (infinite: the tool is rigid)."""
    damping: float
    """Damping of the virtual coupling, N·s/m."""
    force_max: float
    """Greatest force, N."""
    position: Vector
    """Proxy position now, m."""
    orientation: Quaternion
    """x y z w."""


@dataclass(frozen=True)
class SceneSnapshot(Message):
    """Everything a late joiner needs."""

    NAME = "palpate.SceneSnapshot.v1"
    KEY = "palpate/{instance}/scene"

    tick: U64
    """Tick."""
    scene_hash: Hash
    """SHA-256 of the scene file."""
    scene_name: str
    """Scene name."""
    dt_ns: U64
    """Length of a tick, ns."""
    lockstep: bool
    """True when a tick waits for every tool's next pose."""
    bodies: tuple[BodySnapshot, ...]
    """Bodies."""
    tools: tuple[ToolSnapshot, ...]
    """Tools."""


#: All messages that have a name.
ALL = (
    ToolPose,
    ToolForce,
    ToolForceV2,
    ToolContact,
    DeviceInfo,
    ControlNet,
    ContactSet,
    LoopStatus,
    SimEvent,
    SceneSnapshot,
)

__all__ = [
    "GRAB",
    "BodySnapshot",
    "Contact",
    "ContactSet",
    "ControlNet",
    "DeviceInfo",
    "ForceFlags",
    "LoopState",
    "LoopStatus",
    "Quantiles",
    "RecorderState",
    "SceneSnapshot",
    "SimEvent",
    "ToolContact",
    "ToolForce",
    "ToolForceV2",
    "ToolLink",
    "ToolPose",
    "ToolSnapshot",
]
