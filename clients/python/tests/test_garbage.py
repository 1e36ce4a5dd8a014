"""Bytes that are no message raise the one typed error, whatever they are."""

import random
import unittest

import palpate
from palpate import DecodeError, SimEvent, ToolPose, decode, encode

from .golden import golden


class Garbage(unittest.TestCase):
    def refused(self, kind: type[DecodeError], name: str, data: bytes, schema: str = "") -> DecodeError:
        with self.assertRaises(kind) as caught:
            decode(name, data, schema)
        self.assertIs(type(caught.exception), kind)
        return caught.exception

    def test_a_message_cut_at_any_length_is_truncated(self) -> None:
        for name, kind, _, _, data in golden():
            with self.subTest(name):
                for length in range(len(data)):
                    self.refused(palpate.Truncated, kind, data[:length])

    def test_a_byte_more_is_told(self) -> None:
        for name, kind, _, _, data in golden():
            with self.subTest(name):
                room = len(data) < palpate.MESSAGES[kind].MAX_BYTES
                self.refused(palpate.TrailingBytes if room else palpate.Oversized, kind, data + b"\0")

    def test_flipped_bits_raise_only_the_typed_error(self) -> None:
        draw = random.Random(7)
        refused = decoded = 0
        for _, kind, _, _, data in golden():
            for _ in range(300):
                bytes_ = bytearray(data)
                for _ in range(draw.randint(1, 4)):
                    bytes_[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
                try:
                    message = decode(kind, bytes(bytes_))
                    decode(kind, encode(message))
                    decoded += 1
                except DecodeError:
                    refused += 1
        self.assertGreater(refused, 100)
        self.assertGreater(decoded, 100, "a flipped bit of a position is still a pose")

    def test_random_bytes_raise_only_the_typed_error(self) -> None:
        draw = random.Random(11)
        for _ in range(5000):
            data = bytes(draw.randrange(256) for _ in range(draw.randrange(120)))
            for kind in palpate.MESSAGES:
                try:
                    decode(kind, data)
                except DecodeError as error:
                    self.assertIn(kind, str(error))

    def test_a_hostile_count_gets_no_memory(self) -> None:
        head = encode(palpate.ControlNet(1, 1, "b", 3, 3, 4, 4, ()))[:-2]
        many = b"\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"
        error = self.refused(palpate.Truncated, "palpate.ControlNet.v1", head + many + b"\0")
        self.assertEqual(error.field, "points")
        self.refused(palpate.Truncated, "palpate.DeviceInfo.v1", many + bytes(100))

    def test_another_schema_is_told(self) -> None:
        data = next(g.data for g in golden() if g.type == ToolPose.NAME)
        for schema in ("postcard;palpate.ToolPose.v2", "palpate.ToolPose.v1", "postcard;palpate.ToolForce.v1"):
            error = self.refused(palpate.WrongSchema, "palpate.ToolPose.v1", data, schema)
            self.assertIn("ToolPose.v1", str(error))
        for name in ("palpate.ToolPose.v9", "", "postcard;", "x" * 10_000):
            self.assertLess(len(str(self.refused(palpate.WrongSchema, name, data))), 300)

    def test_too_many_bytes_are_told_unread(self) -> None:
        self.refused(palpate.Oversized, "palpate.ToolPose.v1", bytes(ToolPose.MAX_BYTES + 1))
        self.refused(palpate.Oversized, "palpate.ContactSet.v1", bytes((16 << 20) + 1))

    def test_a_kind_of_event_that_is_not_known_can_be_told_apart(self) -> None:
        event = bytearray(encode(SimEvent(1, 2, 3, palpate.Reset())))
        event[-1] = 99
        error = self.refused(palpate.UnknownCase, "palpate.SimEvent.v1", bytes(event))
        self.assertEqual((error.message, error.field), ("palpate.SimEvent.v1", "kind"))
        self.assertIn("99", str(error))

    def test_values_outside_their_type_are_malformed(self) -> None:
        seq = b"\xff" * 9 + b"\x02"  # 2^64 and more
        self.assertEqual(self.refused(palpate.Malformed, "palpate.ToolPose.v1", seq + bytes(108)).field, "seq")
        self.refused(palpate.Malformed, "palpate.ToolPose.v1", b"\x80" * 10 + bytes(108))
        self.refused(palpate.Malformed, "palpate.DeviceInfo.v1", b"\x01\xff" + bytes(106))
        net = encode(palpate.ControlNet(1, 1, "b", 3, 3, 4, 4, ()))
        self.assertEqual(self.refused(palpate.Malformed, "palpate.ControlNet.v1", net[:-1] + b"\x02").field, "weights")

    def test_the_innermost_field_is_told(self) -> None:
        contact = palpate.Contact("t", "b", 0.5, 0.5, (0.0,) * 3, (0.0,) * 3, 0.0, (0.0,) * 3)
        two = encode(palpate.ContactSet(1, (contact,)))
        self.assertEqual(self.refused(palpate.Truncated, "palpate.ContactSet.v1", two[:-1]).field, "contacts.force")
