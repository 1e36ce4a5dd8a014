"""The checker of recordings finds what is wrong with one: golden recordings written again with a fault each."""

import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Optional

from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Message
from mcap.writer import Writer
from read_all import Bad, as_published, read

GOLDEN = Path(__file__).resolve().parents[2] / "recordings" / "golden" / "teardrop-tap.mcap"
TICKS = 20

Change = Callable[[str, Message], Optional[Message]]


def written(path: Path, change: Change, run: bool = True, cut: int = 0) -> None:
    """The first ticks of a golden recording; `change` may alter or drop messages."""
    with open(GOLDEN, "rb") as source, open(path, "wb") as target:
        reader, writer = make_reader(source), Writer(target)
        writer.start()
        channels = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            if message.log_time > TICKS * 1_000_000:
                continue
            if channel.id not in channels:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, schema_id)
            changed = change(channel.topic, message)
            if changed is not None:
                writer.add_message(channels[channel.id], changed.log_time, changed.data, changed.publish_time)
        if run:
            for entry in reader.iter_metadata():
                writer.add_metadata(entry.name, entry.metadata)
        writer.finish()
    if cut:
        path.write_bytes(path.read_bytes()[:-cut])


def at_tick(tick: int, **changes: object) -> Change:
    """Changes one message of /sim/tick."""

    def change(topic: str, message: Message) -> Message:
        if topic == "/sim/tick" and message.log_time == tick * 1_000_000:
            for name, value in changes.items():
                setattr(message, name, value)
        return message

    return change


class Checker(unittest.TestCase):
    def check(self, change: Change, **options: object) -> dict:
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory) / "again.mcap"
            written(path, change, **options)
            return read(str(path))

    def test_a_recording_as_it_was_is_well(self) -> None:
        told = self.check(lambda _, message: message)
        self.assertEqual(told["topics"]["/sim/tick"], {"schema": "palpate.v1.Tick", "count": TICKS})

    def test_bytes_that_do_not_decode_are_found(self) -> None:
        with self.assertRaisesRegex(Bad, r"/sim/tick message 6 .* does not decode as palpate\.v1\.Tick"):
            self.check(at_tick(7, data=b"\x0a\xff"))

    def test_fields_that_the_schema_lacks_are_found(self) -> None:
        # Field 99, a varint; and the same in a message within.
        for extra in (b"\x98\x06\x01", b"\x12\x03\x98\x06\x01"):
            with self.assertRaisesRegex(Bad, r"has fields that its schema lacks"):
                self.check(at_tick(7, data=b"\x08\x07" + extra))

    def test_a_time_that_is_not_that_of_its_tick_is_found(self) -> None:
        with self.assertRaisesRegex(Bad, r"tick 7 of 1000000 ns each is 7000000 ns"):
            self.check(at_tick(7, log_time=7_000_001))

    def test_a_tick_out_of_order_or_twice_is_found(self) -> None:
        with self.assertRaisesRegex(Bad, r"earlier than the one before it"):
            self.check(at_tick(7, log_time=3_000_000, data=b"\x08\x03"))
        with self.assertRaisesRegex(Bad, r"the same tick twice"):
            self.check(at_tick(7, log_time=6_000_000, data=b"\x08\x06"))

    def test_a_foxglove_schema_that_is_not_the_published_one_is_found(self) -> None:
        def color(name: str, syntax: str) -> bytes:
            file = FileDescriptorProto(name="foxglove/Color.proto", package="foxglove", syntax=syntax)
            message = file.message_type.add(name="Color")
            for number, field in enumerate(("r", "g", name, "a"), start=1):
                kind, label = FieldDescriptorProto.TYPE_DOUBLE, FieldDescriptorProto.LABEL_OPTIONAL
                message.field.add(name=field, number=number, type=kind, label=label)
            return FileDescriptorSet(file=[file]).SerializeToString()

        as_published(color("b", "proto3"), "/view/scene")
        for name, syntax in (("blue", "proto3"), ("b", "proto2")):
            with self.assertRaisesRegex(Bad, r"/view/scene: foxglove\.Color is not as published"):
                as_published(color(name, syntax), "/view/scene")

    def test_a_recording_without_its_head_or_its_end_is_found(self) -> None:
        with self.assertRaisesRegex(Bad, r"palpate\.run"):
            self.check(lambda _, message: message, run=False)
        with self.assertRaises(McapError):
            self.check(lambda _, message: message, cut=100)


if __name__ == "__main__":
    unittest.main()
