#!/usr/bin/env python3
"""Hears all that a daemon and a tool say: `hear_all.py ENDPOINT TOOL`, with eclipse-zenoh.

Listens to every key while `press.py` presses the tool, and until the tool was called lost. Decodes every message by the
schema of its encoding and encodes it again. Prints counts of messages and of kinds of events, and what was wrong, as
JSON.
"""

import json
import subprocess
import sys
import threading
from collections import Counter
from pathlib import Path

import zenoh

CLIENT = Path(__file__).resolve().parents[2] / "clients" / "python"
sys.path.insert(0, str(CLIENT))

import palpate  # noqa: E402

#: Longest wait for the daemon to say that the tool is gone, s.
PATIENCE_S = 30.0
#: Statuses after that, ten a second: what is told again and again shows.
STATUSES_AFTER = 5


class Ear:
    """Counts what it hears."""

    def __init__(self) -> None:
        self.messages: Counter = Counter()
        self.events: Counter = Counter()
        self.wrong: list = []
        self.left = STATUSES_AFTER
        self.done = threading.Event()

    def hear(self, sample: zenoh.Sample) -> None:
        """Takes a message of the bus."""
        # An encoding is told as "application/octet-stream;postcard;palpate.ToolForce.v1".
        schema, data = str(sample.encoding).partition(";")[2], sample.payload.to_bytes()
        try:
            message = palpate.decode(schema, data)
            if palpate.encode(message) != data:
                raise ValueError("other bytes when encoded again")
        except Exception as error:
            self.wrong.append(f"{sample.key_expr} ({sample.encoding}): {error}")
            return
        self.messages[message.NAME] += 1
        if isinstance(message, palpate.SimEvent):
            self.events[type(message.kind).__name__] += 1
        elif isinstance(message, palpate.LoopStatus) and self.events["ToolLost"]:
            self.left -= 1
            if self.left <= 0:
                self.done.set()


def main() -> int:
    endpoint, tool = sys.argv[1:]
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    ear = Ear()
    with zenoh.open(config) as session:
        session.declare_subscriber("palpate/**", ear.hear)
        press = [sys.executable, str(CLIENT / "examples" / "press.py"), tool, "--connect", endpoint]
        subprocess.run(press, check=True, stdout=sys.stderr)
        ear.done.wait(PATIENCE_S)
    print(json.dumps({"messages": ear.messages, "events": ear.events, "wrong": ear.wrong[:5]}, indent=2))
    return 0 if ear.done.is_set() else 1


if __name__ == "__main__":
    sys.exit(main())
