"""Bus messages of Palpate: :func:`decode`, :func:`encode` and the messages themselves. SI units.

>>> from palpate import ToolForce, decode
>>> force = decode(ToolForce, payload)  # doctest: +SKIP
"""

from . import messages as _messages
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
from .messages import *  # noqa: F403
from .wire import MESSAGES, decode, encode, encoding_schema, to_json

__version__ = "0.1.0"
__all__ = [
    "MESSAGES",
    "DecodeError",
    "EncodeError",
    "Malformed",
    "Oversized",
    "TrailingBytes",
    "Truncated",
    "UnknownCase",
    "WrongSchema",
    "decode",
    "encode",
    "encoding_schema",
    "to_json",
    # and those of palpate.messages:
]
__all__ += _messages.__all__
