"""postcard: the types a message is made of, read and written.

https://postcard.jamesmunns.com/wire-format. Each type reads itself from a :class:`Reader`, writes itself to a
``bytearray``, and gives the value that the golden ``.json`` files have. A count is believed only when the bytes left
can hold that many items, so hostile bytes cost no memory.
"""

import math
import struct
from collections.abc import Sequence
from typing import Any, Optional

from .errors import DecodeError, EncodeError, Malformed, Truncated, UnknownCase

_NUMBER = struct.Struct("<d")


class Reader:
    """Bytes and the place in them."""

    __slots__ = ("at", "data")

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def left(self) -> int:
        """Bytes not yet read."""
        return len(self.data) - self.at

    def skip(self, count: int) -> int:
        """Moves on by ``count`` bytes; returns where they begin."""
        start = self.at
        if count > len(self.data) - start:
            raise Truncated(f"{len(self.data)} bytes end where {count} more were to begin at {start}")
        self.at = start + count
        return start

    def varint(self, bits: int) -> int:
        """An unsigned number of at most ``bits`` bits, seven a byte, low ones first."""
        value = shift = 0
        while shift < bits:
            byte = self.data[self.skip(1)]
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                if value >> bits:
                    break
                return value
            shift += 7
        raise Malformed(f"a number has more than {bits} bits")

    def count(self, item_bytes: int) -> int:
        """How many items follow, each of at least ``item_bytes``."""
        count = self.varint(64)
        if count * item_bytes > self.left():
            raise Truncated(f"{count} items cannot be in the {self.left()} bytes left")
        return count


def write_varint(out: bytearray, value: int) -> None:
    """Writes an unsigned number, seven bits a byte, low ones first."""
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)


class Wire:
    """A type on the wire."""

    #: Fewest bytes that a value has.
    min_bytes = 1

    def read(self, reader: Reader) -> Any:
        """The value at the reader's place."""
        raise NotImplementedError

    def write(self, out: bytearray, value: Any) -> None:
        """Appends the bytes of a value."""
        raise NotImplementedError

    def json(self, value: Any) -> Any:
        """The value as JSON has it."""
        return value


class Uint(Wire):
    """Unsigned: one plain byte with 8 bits, else a varint."""

    def __init__(self, bits: int) -> None:
        self.bits = bits

    def read(self, reader: Reader) -> int:
        return reader.data[reader.skip(1)] if self.bits == 8 else reader.varint(self.bits)

    def write(self, out: bytearray, value: Any) -> None:
        if isinstance(value, bool) or not isinstance(value, int) or value < 0 or value >> self.bits:
            raise EncodeError(f"{value!r} is not a whole number of {self.bits} bits")
        if self.bits == 8:
            out.append(value)
        else:
            write_varint(out, value)


class Bool(Wire):
    """One byte, 0 or 1."""

    def read(self, reader: Reader) -> bool:
        byte = reader.data[reader.skip(1)]
        if byte > 1:
            raise Malformed(f"{byte} is neither 0 nor 1")
        return byte == 1

    def write(self, out: bytearray, value: Any) -> None:
        if not isinstance(value, bool):
            raise EncodeError(f"{value!r} is not a bool")
        out.append(value)


def _json_number(value: float) -> Optional[float]:
    return value if math.isfinite(value) else None


class F64(Wire):
    """Eight bytes, IEEE 754, little-endian."""

    min_bytes = 8

    def read(self, reader: Reader) -> float:
        value: float = _NUMBER.unpack_from(reader.data, reader.skip(8))[0]
        return value

    def write(self, out: bytearray, value: Any) -> None:
        out += _pack(_NUMBER, (value,))

    def json(self, value: float) -> Optional[float]:
        return _json_number(value)


def _pack(form: struct.Struct, values: Sequence[Any]) -> bytes:
    try:
        return form.pack(*values)
    except (struct.error, OverflowError) as error:
        raise EncodeError(f"{values!r:.80} are not numbers: {error}") from None


class Text(Wire):
    """Count of bytes, then UTF-8."""

    def read(self, reader: Reader) -> str:
        count = reader.count(1)
        start = reader.skip(count)
        try:
            return str(reader.data[start : start + count], "utf-8")
        except UnicodeDecodeError as error:
            raise Malformed(f"text is not UTF-8: {error.reason} at byte {start + error.start}") from None

    def write(self, out: bytearray, value: Any) -> None:
        if not isinstance(value, str):
            raise EncodeError(f"{value!r} is not text")
        try:
            data = value.encode()
        except UnicodeEncodeError as error:
            raise EncodeError(f"text has no UTF-8: {error.reason}") from None
        write_varint(out, len(data))
        out += data


class Octets(Wire):
    """A known count of plain bytes."""

    def __init__(self, count: int) -> None:
        self.min_bytes = count

    def read(self, reader: Reader) -> bytes:
        start = reader.skip(self.min_bytes)
        return bytes(reader.data[start : start + self.min_bytes])

    def write(self, out: bytearray, value: Any) -> None:
        if not isinstance(value, (bytes, bytearray)) or len(value) != self.min_bytes:
            raise EncodeError(f"{value!r:.80} are not {self.min_bytes} bytes")
        out += value

    def json(self, value: bytes) -> Any:
        return list(value)


class Array(Wire):
    """A known count of items."""

    def __init__(self, item: Wire, count: int) -> None:
        self.item, self.count = item, count
        self.min_bytes = item.min_bytes * count
        self.numbers = struct.Struct(f"<{count}d") if isinstance(item, F64) else None

    def read(self, reader: Reader) -> Any:
        if self.numbers:
            return self.numbers.unpack_from(reader.data, reader.skip(self.numbers.size))
        return tuple(self.item.read(reader) for _ in range(self.count))

    def write(self, out: bytearray, value: Any) -> None:
        if not isinstance(value, (tuple, list)) or len(value) != self.count:
            raise EncodeError(f"{value!r:.80} has not {self.count} items")
        if self.numbers:
            out += _pack(self.numbers, value)
        else:
            for item in value:
                self.item.write(out, item)

    def json(self, value: Any) -> Any:
        return [self.item.json(item) for item in value]


class ListOf(Wire):
    """A count, then the items."""

    def __init__(self, item: Wire) -> None:
        self.item = item

    def read(self, reader: Reader) -> Any:
        count = reader.count(self.item.min_bytes)
        # A net has thousands of points: all in one call.
        if isinstance(self.item, F64):
            return struct.unpack_from(f"<{count}d", reader.data, reader.skip(8 * count))
        if isinstance(self.item, Array) and self.item.numbers:
            size = self.item.min_bytes * count
            start = reader.skip(size)
            return tuple(self.item.numbers.iter_unpack(memoryview(reader.data)[start : start + size]))
        return tuple(self.item.read(reader) for _ in range(count))

    def write(self, out: bytearray, value: Any) -> None:
        if not isinstance(value, (tuple, list)):
            raise EncodeError(f"{value!r:.80} is neither a tuple nor a list")
        write_varint(out, len(value))
        for item in value:
            self.item.write(out, item)

    def json(self, value: Any) -> Any:
        return [self.item.json(item) for item in value]


class Maybe(Wire):
    """0, or 1 and the value."""

    def __init__(self, item: Wire) -> None:
        self.item = item

    def read(self, reader: Reader) -> Any:
        byte = reader.data[reader.skip(1)]
        if byte > 1:
            raise Malformed(f"{byte} is neither 0 nor 1")
        return self.item.read(reader) if byte else None

    def write(self, out: bytearray, value: Any) -> None:
        out.append(value is not None)
        if value is not None:
            self.item.write(out, value)

    def json(self, value: Any) -> Any:
        return None if value is None else self.item.json(value)


class Struct(Wire):
    """A dataclass: its fields in order, nothing between."""

    def __init__(self, maker: type, fields: Sequence[tuple[str, Wire]]) -> None:
        self.maker, self.fields = maker, tuple(fields)
        self.min_bytes = sum(wire.min_bytes for _, wire in self.fields)

    def read(self, reader: Reader) -> Any:
        values, name = [], ""
        try:
            for name, wire in self.fields:
                values.append(wire.read(reader))
        except DecodeError as error:
            error.inside(name)
            raise
        return self.maker(*values)

    def write(self, out: bytearray, value: Any) -> None:
        if type(value) is not self.maker:
            raise EncodeError(f"{value!r:.80} is not a {self.maker.__name__}")
        for name, wire in self.fields:
            try:
                wire.write(out, getattr(value, name))
            except EncodeError as error:
                raise EncodeError(f"{self.maker.__name__}.{name}: {error}") from None

    def json(self, value: Any) -> Any:
        return {name: wire.json(getattr(value, name)) for name, wire in self.fields}


class Case(Wire):
    """A choice without fields, an ``IntEnum``: the number of the case."""

    def __init__(self, choice: Any) -> None:
        self.choice = choice

    def read(self, reader: Reader) -> Any:
        number = reader.varint(32)
        try:
            return self.choice(number)
        except ValueError:
            raise UnknownCase(f"{self.choice.__name__} has no case {number}") from None

    def write(self, out: bytearray, value: Any) -> None:
        try:
            write_varint(out, self.choice(value))
        except ValueError:
            raise EncodeError(f"{value!r} is no {self.choice.__name__}") from None

    def json(self, value: Any) -> str:
        return "".join(word.capitalize() for word in self.choice(value).name.split("_"))


class Cases(Wire):
    """A choice with fields, a union of dataclasses: the number of the case, then its fields."""

    def __init__(self, cases: Sequence[Struct]) -> None:
        self.cases = tuple(cases)
        self.numbers = {case.maker: number for number, case in enumerate(self.cases)}

    def read(self, reader: Reader) -> Any:
        number = reader.varint(32)
        if number >= len(self.cases):
            raise UnknownCase(f"no case has number {number}, the last is {len(self.cases) - 1}")
        return self.cases[number].read(reader)

    def write(self, out: bytearray, value: Any) -> None:
        number = self.numbers.get(type(value))
        if number is None:
            raise EncodeError(f"{value!r:.80} is no case of this choice")
        write_varint(out, number)
        self.cases[number].write(out, value)

    def json(self, value: Any) -> Any:
        case = self.cases[self.numbers[type(value)]]
        name = case.maker.__name__
        return {name: case.json(value)} if case.fields else name
