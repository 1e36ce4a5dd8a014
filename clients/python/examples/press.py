#!/usr/bin/env python3
"""Presses a tool into the scene and prints the forces. Needs ``pip install eclipse-zenoh`` and a daemon:

palpate serve scenes/teardrop.toml
python3 examples/press.py ball
"""

import argparse
import json
import sys
import time
from pathlib import Path

import zenoh

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from palpate import SceneSnapshot, ToolForce, ToolPose, decode, encode, encoding_schema  # noqa: E402


def main() -> int:
    parser = argparse.ArgumentParser(description="Press a tool into the scene and print the forces.")
    parser.add_argument("tool", help="tool id")
    parser.add_argument("--connect", default="tcp/127.0.0.1:7447", help="endpoint of the daemon")
    parser.add_argument("--instance", default="default", help="instance name")
    parser.add_argument("--depth", type=float, default=0.06, help="way along -x, m")
    parser.add_argument("--seconds", type=float, default=2.0, help="time there and back, s")
    args = parser.parse_args()

    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([args.connect]))
    root = f"palpate/{args.instance}"
    forces: list[ToolForce] = []
    with zenoh.open(config) as session:
        replies = [reply.ok for reply in session.get(f"{root}/scene") if reply.ok]
        if not replies:
            print(f"no daemon answers at {args.connect} for {root}", file=sys.stderr)
            return 3
        scene = decode(SceneSnapshot, replies[0].payload.to_bytes())
        tool = next((tool for tool in scene.tools if tool.id == args.tool), None)
        if tool is None:
            print(f"no tool {args.tool!r}; the scene has {[tool.id for tool in scene.tools]}", file=sys.stderr)
            return 2

        def on_force(sample: zenoh.Sample) -> None:
            # An encoding is told as "application/octet-stream;postcard;palpate.ToolForce.v1".
            schema = str(sample.encoding).partition(";")[2]
            forces.append(decode(ToolForce, sample.payload.to_bytes(), schema))

        session.liveliness().declare_token(f"{root}/@live/tool/{args.tool}")
        session.declare_subscriber(f"{root}/tool/{args.tool}/force", on_force)
        encoding = zenoh.Encoding.APPLICATION_OCTET_STREAM.with_schema(encoding_schema(ToolPose))
        poses = session.declare_publisher(
            f"{root}/tool/{args.tool}/pose",
            encoding=encoding,
            priority=zenoh.Priority.REAL_TIME,
            congestion_control=zenoh.CongestionControl.DROP,
            express=True,
        )
        start = time.monotonic()
        seq = 0
        while (elapsed := time.monotonic() - start) < args.seconds:
            seq += 1
            way = args.depth * (1 - abs(2 * elapsed / args.seconds - 1))
            speed = (1 if 2 * elapsed < args.seconds else -1) * 2 * args.depth / args.seconds
            x, y, z = tool.position
            pose = ToolPose(
                seq, time.monotonic_ns(), (x - way, y, z), tool.orientation, linear_velocity=(-speed, 0.0, 0.0)
            )
            poses.put(encode(pose))
            time.sleep(0.002)

    peak = max((sum(f * f for f in force.force) ** 0.5 for force in forces), default=0.0)
    contacts = sum(force.contact_count > 0 for force in forces)
    print(f"{seq} poses, {len(forces)} forces, {contacts} with contact, at most {peak:.2f} N")
    return 0


if __name__ == "__main__":
    sys.exit(main())
