"""Types of fields, by name.

The hints say what the bytes are: ``float`` is an f64, ``tuple[X, ...]`` a list, a tuple of known length an array,
``U64`` a number of at most 64 bits, a union of dataclasses a choice whose cases are numbered in that order from 0.
"""

from typing import Annotated, ClassVar

U8 = Annotated[int, 8]
U16 = Annotated[int, 16]
U32 = Annotated[int, 32]
U64 = Annotated[int, 64]
Hash = Annotated[bytes, 32]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Message:
    """What travels on the bus."""

    #: Versioned name of the type.
    NAME: ClassVar[str]
    #: Key, for example ``ToolPose.KEY.format(instance="default", tool="ball")``.
    KEY: ClassVar[str]
    #: Most bytes that one has: more are refused before they are read.
    MAX_BYTES: ClassVar[int] = 16 << 20
