"""Every kept message decodes to its value and encodes back to its bytes."""

import dataclasses
import json
import typing
import unittest

import palpate
from palpate import ControlNet, DeviceInfo, LoopStatus, SimEvent, ToolForce, ToolPose, decode, encode

from .golden import golden


class EveryMessage(unittest.TestCase):
    def test_the_bytes_have_the_value_and_the_value_the_bytes(self) -> None:
        seen = set()
        for name, kind, schema, value, data in golden():
            with self.subTest(name):
                message = decode(kind, data, schema)
                # Through text, so that -0.0 and 0.0 differ and tuples are lists.
                self.assertEqual(
                    json.dumps(palpate.to_json(message), sort_keys=True), json.dumps(value, sort_keys=True)
                )
                self.assertEqual(encode(message), data)
                self.assertEqual(decode(schema, data), message)
                self.assertEqual(palpate.encoding_schema(message), schema)
                seen.add(kind)
        self.assertEqual(seen, set(palpate.MESSAGES), "each message has a golden file, and each golden file a message")

    def test_every_kind_of_event_has_a_golden_file(self) -> None:
        kinds = {type(decode(SimEvent, g.data).kind) for g in golden() if g.type == SimEvent.NAME}
        self.assertEqual(kinds, set(typing.get_args(palpate.EventKind)))

    def test_messages_do_not_change(self) -> None:
        pose = ToolPose(1, 0, (0.0, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0))
        with self.assertRaises(dataclasses.FrozenInstanceError):
            pose.seq = 2  # type: ignore[misc]


class Values(unittest.TestCase):
    def test_numbers_at_the_ends_of_their_types_come_back(self) -> None:
        for seq in (0, 127, 128, 2**53 + 1, 2**64 - 1):
            for buttons in (0, 2**32 - 1):
                pose = ToolPose(seq, 0, (0.0, -0.0, 5e-324), (0.0, 0.0, 0.0, 1.0), buttons=buttons)
                self.assertEqual(decode(ToolPose, encode(pose)), pose)
        longest = ToolPose(2**64 - 1, 2**64 - 1, (0.0,) * 3, (0.0,) * 4, buttons=2**32 - 1, flags=2**32 - 1)
        self.assertEqual(len(encode(longest)), ToolPose.MAX_BYTES)

    def test_floats_keep_their_sign_and_infinity(self) -> None:
        inf = float("inf")
        pose = decode(ToolPose, encode(ToolPose(1, 0, (-0.0, inf, -inf), (0.0, 0.0, 0.0, 1.0))))
        self.assertEqual(str(pose.position), str((-0.0, inf, -inf)))

    def test_a_large_net_comes_back(self) -> None:
        points = tuple((k * 0.1, -k * 0.5, 1.0 / (k + 1)) for k in range(128 * 128))
        net = ControlNet(1, 2, "jelly", 3, 3, 128, 128, points, tuple(1.0 for _ in points))
        self.assertEqual(decode(ControlNet, encode(net)), net)

    def test_values_that_a_type_cannot_have_are_refused_by_their_field(self) -> None:
        good = ToolPose(1, 0, (0.0, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0))
        bad: list[tuple[str, dict[str, typing.Any]]] = [
            ("seq", {"seq": -1}),
            ("seq", {"seq": 2**64}),
            ("seq", {"seq": 1.5}),
            ("buttons", {"buttons": 2**32}),
            ("position", {"position": (0.0, 0.0)}),
            ("position", {"position": (0.0, 0.0, "x")}),
            ("orientation", {"orientation": 1.0}),
        ]
        for field, change in bad:
            with self.assertRaisesRegex(palpate.EncodeError, f"ToolPose.{field}"):
                encode(dataclasses.replace(good, **change))
        with self.assertRaisesRegex(palpate.EncodeError, "DeviceInfo.name"):
            encode(DeviceInfo("\ud800"))
        with self.assertRaisesRegex(palpate.EncodeError, "more than any palpate.DeviceInfo.v1"):
            encode(DeviceInfo("x" * 80))
        with self.assertRaisesRegex(palpate.EncodeError, "DeviceInfo.dof_force"):
            encode(DeviceInfo("arm", dof_force=256))
        with self.assertRaisesRegex(palpate.EncodeError, "SimEvent.kind"):
            encode(SimEvent(1, 1, 1, None))  # type: ignore[arg-type]
        with self.assertRaises(palpate.EncodeError):
            encode("pose")  # type: ignore[arg-type]

    def test_flags_have_names(self) -> None:
        force = next(decode(ToolForce, g.data) for g in golden() if g.type == ToolForce.NAME)
        flags = palpate.ForceFlags(force.flags)
        self.assertEqual(flags, palpate.ForceFlags.SATURATED | palpate.ForceFlags.RAMPING)

    def test_choices_are_choices(self) -> None:
        status = next(decode(LoopStatus, g.data) for g in golden() if g.type == LoopStatus.NAME)
        self.assertIs(status.state, palpate.LoopState.PAUSED)
