"""A program written from the vendor's page: connects to an Inverse Service, pushes, and prints what it saw.

    haply_program.py URI
"""

import asyncio
import json
import sys

import websockets


async def main(uri):
    async with websockets.connect(uri) as service:
        first = json.loads(await service.recv())
        inverse, grip = first["inverse3"][0], first["wireless_verse_grip"][0]
        assert "state" in inverse and "state" in grip and "config" in inverse
        device = inverse["device_id"]
        before = inverse["state"]["cursor_position"]
        message = {
            "session": {"configure": {"profile": {"name": "test"}}},
            "inverse3": [{"device_id": device, "commands": {"set_cursor_force": {"vector": {"x": 0, "y": 0, "z": 0}}}}],
        }
        for k in range(500):
            await service.send(json.dumps(message))
            message.pop("session", None)
            state = json.loads(await service.recv())["inverse3"][0]["state"]
            command = message["inverse3"][0]["commands"]["set_cursor_force"]
            command["vector"] = {"x": 0.0, "y": 0.0, "z": 1.0}
        # A light hand of 100 N/m gives way by a centimetre.
        moved = state["cursor_position"]["z"] - before["z"]
        print(json.dumps({"moved_m": moved, "force": state["current_cursor_force"]}))


asyncio.run(main(sys.argv[1]))
