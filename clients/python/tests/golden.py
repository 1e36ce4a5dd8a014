"""The kept bytes of every message, shared by the tests of all clients."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

GOLDEN = Path(__file__).resolve().parents[3] / "proto" / "golden"


class Golden(NamedTuple):
    """A payload and what it means."""

    name: str
    type: str
    schema: str
    value: Any
    data: bytes


def golden() -> Iterator[Golden]:
    """All of them."""
    files = sorted(GOLDEN.glob("*.bin"))
    assert files, f"no golden files in {GOLDEN}"
    for file in files:
        document = json.loads(file.with_suffix(".json").read_text("utf-8"))
        yield Golden(file.stem, document["type"], document["schema"], document["value"], file.read_bytes())
