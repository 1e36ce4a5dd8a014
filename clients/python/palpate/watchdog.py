"""When a force is too old to act: a daemon that dies, is stopped or is cut off cannot send zero."""

import dataclasses
import time
from typing import Optional

from .messages import ForceFlags, ToolForce

FRESH_S = 0.05
FRESH_SPARSE_S = 0.1
FADE_OUT_S = 0.01
FADE_IN_S = 0.1


class Watchdog:
    """The share of the newest force that may act: 1 while forces come, 0 within 60 ms of the last one (110 with a
    deadband), and back to 1 over 100 ms when they come again.

    :class:`palpate.Tool` has one of its own. This is for programs that get forces in another way, from Zenoh or
    rosbridge: :meth:`heard` each time one comes, :meth:`felt` or :meth:`gain` whenever it acts. Times are in s, of
    ``time.monotonic()``. ``docs/wire.md`` of the project has the rule.
    """

    def __init__(self, deadband: bool = False) -> None:
        self._limit = FRESH_SPARSE_S if deadband else FRESH_S
        self._last: Optional[float] = None
        # The gain when the last force came; when forces began to come, at first or again, and the gain then.
        self._before = 1.0
        self._since, self._from = 0.0, 1.0

    def heard(self, now: Optional[float] = None) -> None:
        """A force came."""
        now = time.monotonic() if now is None else now
        silence = self.silence(now)
        gain = 1.0 if silence is None else self.gain(now)
        if silence is None or silence > self._limit:
            self._since, self._from = now, gain
        self._before = gain
        self._last = now if self._last is None else max(now, self._last)

    def silence(self, now: Optional[float] = None) -> Optional[float]:
        """How long ago the last force came, s; None before the first."""
        now = time.monotonic() if now is None else now
        return None if self._last is None else max(0.0, now - self._last)

    def gain(self, now: Optional[float] = None) -> float:
        """The share of the newest force and torque that may act now, 0 to 1; 0 before the first."""
        age = self.silence(now)
        if age is None or self._last is None:
            return 0.0
        # It rises for as long as forces have been coming: those that waited while this process or the link stood
        # still come all at once, and may be as old as that.
        most = min(self._from + (self._last - self._since) / FADE_IN_S, 1.0)
        held = min(age, self._limit)
        risen = min(self._before + held / FADE_IN_S, most)
        return max(0.0, risen - (age - held) / FADE_OUT_S)

    def felt(self, force: ToolForce, now: Optional[float] = None) -> ToolForce:
        """A force as it may act now; marked :attr:`ForceFlags.RAMPING` where that is less than all of it."""
        gain = self.gain(now)
        if gain == 1.0:
            return force
        (x, y, z), (a, b, c) = force.force, force.torque
        return dataclasses.replace(
            force,
            force=(x * gain, y * gain, z * gain),
            torque=(a * gain, b * gain, c * gain),
            flags=force.flags | ForceFlags.RAMPING,
        )
