#!/usr/bin/env python3
"""Reads a recording without Palpate's code: topics, counts, peak force of each tool, last tick.

    pip install mcap mcap-protobuf-support
    python3 read_recording.py run.mcap [--json]

The file holds the schema of every message; what the packed numbers of a tick are stands in the comments of that schema.
"""

import argparse
import json
import math
import sys
from typing import Any

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


def summary(path: str) -> dict[str, Any]:
    """What is in a recording."""
    topics: dict[str, dict[str, Any]] = {}
    peaks: list[float] = []
    last_tick = None
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        run = next((m.metadata for m in reader.iter_metadata() if m.name == "palpate.run"), {})
        for schema, channel, _, message in reader.iter_decoded_messages():
            topic = topics.setdefault(channel.topic, {"schema": schema.name if schema else "", "count": 0})
            topic["count"] += 1
            if channel.topic == "/sim/tick":
                last_tick = message.tick
                peaks += [0.0] * (len(message.tools) - len(peaks))
                for index, tool in enumerate(message.tools):
                    # Values begin with the force on the hand, N.
                    peaks[index] = max(peaks[index], math.hypot(*tool.values[:3]))
    names = [name for name in run.get("tools", "").split(",") if name]
    names += [f"tool {index}" for index in range(len(names), len(peaks))]
    return {
        "scene": run.get("scene"),
        "tick_s": int(run["dt_ns"]) * 1e-9 if "dt_ns" in run else None,
        "last_tick": last_tick,
        "peak_force_n": dict(zip(names, peaks)),
        "topics": topics,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description="Tell what is in a recording.")
    parser.add_argument("file", help="recording (.mcap)")
    parser.add_argument("--json", action="store_true", help="print JSON")
    args = parser.parse_args()
    try:
        told = summary(args.file)
    except OSError as error:
        print(f"{args.file}: {error.strerror}", file=sys.stderr)
        return 2
    except McapError as error:
        why = str(error) or type(error).__name__
        print(f"{args.file}: not a whole recording ({why}); try: palpate recover", file=sys.stderr)
        return 3
    if args.json:
        print(json.dumps(told, indent=2))
        return 0
    print(f"scene {told['scene']}, last tick {told['last_tick']}")
    for tool, force in told["peak_force_n"].items():
        print(f"{tool}: at most {force:.3f} N")
    for name, topic in sorted(told["topics"].items()):
        print(f"{topic['count']:8} {name} ({topic['schema']})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
