"""Bus messages of Palpate: :func:`decode`, :func:`encode` and the messages themselves. SI units.

>>> from palpate import ToolForce, decode
>>> force = decode(ToolForce, payload)  # doctest: +SKIP
"""

from . import events as _events
from . import messages as _messages
from .base import Message
from .errors import (
    DecodeError,
    EncodeError,
    Malformed,
    Oversized,
    TrailingBytes,
    Truncated,
    UnknownCase,
    WrongSchema,
)
from .events import *  # noqa: F403
from .messages import *  # noqa: F403
from .wire import MESSAGES, decode, encode, encoding_schema, to_json

__version__ = "0.1.0"
__all__ = [
    "MESSAGES",
    "DecodeError",
    "EncodeError",
    "Malformed",
    "Message",
    "Oversized",
    "TrailingBytes",
    "Truncated",
    "UnknownCase",
    "WrongSchema",
    "decode",
    "encode",
    "encoding_schema",
    "to_json",
]
__all__ += _messages.__all__
__all__ += _events.__all__
