"""From the type hints of :mod:`palpate.messages` to bytes and back. The hints are the table."""

import dataclasses
import enum
import typing
from typing import Any, TypeVar, Union, overload

from . import messages
from .base import Message
from .codec import F64, Array, Bool, Case, Cases, ListOf, Maybe, Octets, Reader, Struct, Text, Uint, Wire
from .errors import DecodeError, EncodeError, Oversized, TrailingBytes, WrongSchema

M = TypeVar("M", bound=Message)


def _wire(hint: Any) -> Wire:
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if hint is float:
        return F64()
    if hint is bool:
        return Bool()
    if hint is str:
        return Text()
    if origin is typing.Annotated:
        return Uint(parts[1]) if parts[0] is int else Octets(parts[1])
    if origin is tuple and parts[1:] == (...,):
        return ListOf(_wire(parts[0]))
    if origin is tuple and all(part == parts[0] for part in parts):
        return Array(_wire(parts[0]), len(parts))
    if origin is Union and type(None) in parts:
        return Maybe(_wire(parts[0]))
    if origin is Union:
        return Cases([_struct(part) for part in parts])
    if isinstance(hint, type) and issubclass(hint, enum.IntEnum):
        return Case(hint)
    if dataclasses.is_dataclass(hint):
        return _struct(hint)
    raise TypeError(f"no bytes for {hint!r}")


def _struct(maker: Any) -> Struct:
    hints = typing.get_type_hints(maker, include_extras=True)
    return Struct(maker, [(field.name, _wire(hints[field.name])) for field in dataclasses.fields(maker)])


#: Every message by its name, for example ``palpate.ToolPose.v1``.
MESSAGES: dict[str, type[Message]] = {maker.NAME: maker for maker in messages.ALL}
_WIRES: dict[type[Message], Struct] = {maker: _struct(maker) for maker in messages.ALL}


def encoding_schema(message: Union[Message, type[Message]]) -> str:
    """Schema of the encoding ``application/octet-stream`` of a message: ``postcard;palpate.ToolPose.v1``."""
    return f"postcard;{message.NAME}"


@overload
def decode(name: type[M], data: bytes, schema: str = "") -> M: ...
@overload
def decode(name: str, data: bytes, schema: str = "") -> Message: ...


def decode(name: Union[str, type[Message]], data: bytes, schema: str = "") -> Message:
    """Reads a message.

    ``name`` is the type that the key carries, as class or name, or the schema of the sample's encoding. ``schema`` is
    that of the sample when the type is known from the key; an empty one is not checked.

    Raises :class:`palpate.DecodeError`, or the one of its kinds that fits; nothing else for any bytes.
    """
    maker = MESSAGES.get(name.removeprefix("postcard;")) if isinstance(name, str) else name
    if maker is None:
        raise WrongSchema(f"no message is called {name!r:.128}")
    try:
        if schema and schema != encoding_schema(maker):
            raise WrongSchema(f"the encoding's schema is {schema!r:.128}")
        if len(data) > maker.MAX_BYTES:
            raise Oversized(f"{len(data)} bytes are more than any has ({maker.MAX_BYTES})")
        reader = Reader(data)
        message: Message = _WIRES[maker].read(reader)
        if reader.left():
            raise TrailingBytes(f"{reader.left()} bytes after its end")
        return message
    except DecodeError as error:
        error.message = maker.NAME
        raise


def encode(message: Message) -> bytes:
    """Bytes of a message. Raises :class:`palpate.EncodeError` for a value that its type cannot have."""
    wire = _WIRES.get(type(message))
    if wire is None:
        raise EncodeError(f"{message!r:.80} is no message")
    out = bytearray()
    wire.write(out, message)
    if len(out) > message.MAX_BYTES:
        raise EncodeError(f"{len(out)} bytes are more than any {message.NAME} has ({message.MAX_BYTES})")
    return bytes(out)


def to_json(message: Message) -> dict[str, Any]:
    """The message as plain values for ``json.dumps``: choices by name, numbers that are not finite as None."""
    value: dict[str, Any] = _WIRES[type(message)].json(message)
    return value
