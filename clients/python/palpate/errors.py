"""What can be wrong with bytes that came, or with a message that is to go."""

from typing import Optional


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
