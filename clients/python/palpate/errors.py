"""Exceptions: of messages (pure Python), and of everything else that this package does."""

from dataclasses import dataclass
from typing import Optional


class PalpateError(Exception):
    """Base of the exceptions of simulations, surfaces, recordings and daemons."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a scene."""

    path: str
    """Path of the key, for example ``body[0].material.young_pa``; empty when it concerns the file as a whole."""
    reason: str
    """What is wrong and how to fix it."""
    file: Optional[str] = None
    """Scene file; None for a scene made from a dictionary."""
    line: Optional[int] = None
    """From 1."""
    column: Optional[int] = None
    """From 1."""


class SceneError(PalpateError, ValueError):
    """A scene that cannot be built. The message has a line for each problem."""

    #: Everything that is wrong with it.
    problems: "list[Problem]" = []


class SceneWarning(UserWarning):
    """A scene with a value that is hardly meant, or that comes out less exact than its numbers suggest."""


class SurfaceError(PalpateError, ValueError):
    """A surface, curve or surface file that cannot be used, or an operation that has no answer."""


class SweepError(PalpateError, ValueError):
    """A sweep that cannot be run, or whose runs did not all come back. What goes wrong in a run is in its row."""


class BusyError(PalpateError, RuntimeError):
    """A simulation or batch that another thread is stepping."""


class NotPicklableError(PalpateError, TypeError):
    """An object that holds running state; the message says what to pickle instead."""


class RecordingError(PalpateError):
    """A recording that cannot be read or replayed."""


class RecordingWarning(UserWarning):
    """A recording that is not whole: what is there is used."""


class DivergedError(RecordingError, AssertionError):
    """A replay that differs from its recording."""

    #: First tick that differs.
    tick: int = 0
    #: What differs, for example ``tool ball force x``.
    field: str = ""
    #: Recorded value, as text.
    recorded: str = ""
    #: Replayed value, as text.
    replayed: str = ""
    #: Distance of the two in floating-point steps, where they are numbers.
    ulps: Optional[int] = None
    #: The recording was made by this very build.
    same_build: bool = False


class ClientError(PalpateError):
    """A daemon that could not be spoken to."""


class UnreachableError(ClientError, ConnectionError):
    """Nobody listens at the endpoint."""


class NoAnswerError(ClientError, TimeoutError):
    """An answer or a force that did not come in time."""


class RefusedError(ClientError, ValueError):
    """A command that the daemon refused, in its words."""


class HeldError(ClientError):
    """A tool that another client holds; the message names the tool, and the other client or its device."""


class UnknownNameError(ClientError, KeyError):
    """A tool or body that the daemon's scene does not have."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class DaemonError(PalpateError):
    """A daemon of :func:`palpate.serve` that did not start, or that ended by itself."""

    #: Exit code, negative for a signal; None while it runs.
    code: Optional[int] = None
    #: What it wrote to stderr last.
    words: str = ""


class DecodeError(ValueError):
    """Bytes that are not the message expected. ``message`` is the type's name, ``field`` where reading stopped."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason
        self.message: Optional[str] = None
        self.field: Optional[str] = None

    def inside(self, field: str) -> None:
        """Notes the field that was being read; called from the innermost outwards."""
        self.field = field if self.field is None else f"{field}.{self.field}"

    def __str__(self) -> str:
        of = f"not a {self.message}: " if self.message else ""
        at = f" (in {self.field})" if self.field else ""
        return f"{of}{self.reason}{at}"


class WrongSchema(DecodeError):
    """Another type or version than expected, or one that this package does not know."""


class Truncated(DecodeError):
    """The bytes end before the message does."""


class TrailingBytes(DecodeError):
    """There are bytes after the end of the message."""


class Oversized(DecodeError):
    """More bytes than any such message has."""


class UnknownCase(DecodeError):
    """A choice whose number is not known. For the kind of an event: a newer daemon; skip that event."""


class Malformed(DecodeError):
    """A value that its type cannot have: a number too large, a bool of 2, text that is not UTF-8."""


class EncodeError(ValueError):
    """A message with a value that its type cannot have."""
