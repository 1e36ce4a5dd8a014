#!/usr/bin/env python3
"""Strict reading of a recording with the public readers alone: `read_all.py FILE`, with mcap and mcap-protobuf-support.

Decodes every message with the schema in the file. Fails on one that does not decode or has fields that its schema
lacks, on times that run backwards in a channel, on a log time that is not tick × dt, on a count that the summary does
not have, on a Foxglove message whose schema is not the published one. Prints topics, schemas and counts as JSON.
"""

import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any

from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorSet
from google.protobuf.unknown_fields import UnknownFieldSet
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


class Bad(Exception):
    """What a recording must not have."""


def without_unknown_fields(message: Any, where: str) -> None:
    """Refuses what the file's schema does not name, at any depth."""
    if len(UnknownFieldSet(message)):
        raise Bad(f"{where}: {message.DESCRIPTOR.full_name} has fields that its schema lacks")
    for field, value in message.ListFields():
        if field.message_type is not None:
            for part in [value] if hasattr(value, "DESCRIPTOR") else value:
                without_unknown_fields(part, where)


def as_published(data: bytes, where: str) -> None:
    """Refuses a Foxglove message that viewers would not know: `proto/tests/foxglove_published.json` holds them."""
    facts = Path(__file__).resolve().parents[2] / "proto" / "tests" / "foxglove_published.json"
    published = json.loads(facts.read_text("utf-8"))["messages"]
    for file in FileDescriptorSet.FromString(data).file:
        for message in file.message_type if file.package == "foxglove" else ():
            fields = []
            for field in sorted(message.field, key=lambda field: field.number):
                kind = FieldDescriptorProto.Type.Name(field.type).removeprefix("TYPE_").lower()
                repeated = field.label == FieldDescriptorProto.LABEL_REPEATED
                kind = f"{kind} {field.type_name}".rstrip()
                fields.append({"name": field.name, "number": field.number, "type": kind, "repeated": repeated})
            enums = {choice.name: {value.name: value.number for value in choice.value} for choice in message.enum_type}
            ours, theirs = {"enums": enums, "fields": fields}, published.get(f"foxglove.{message.name}")
            if theirs is not None:
                theirs["fields"].sort(key=lambda field: field["number"])
            if file.syntax != "proto3" or ours != theirs:
                raise Bad(f"{where}: foxglove.{message.name} is not as published")


def tick_of(message: Any) -> Any:
    """Tick to which a message belongs, if it tells."""
    names = message.DESCRIPTOR.fields_by_name
    name = next((name for name in ("tick", "after_tick") if name in names), None)
    return None if name is None else getattr(message, name)


def read(path: str) -> dict[str, Any]:
    """Reads all; raises at the first thing that is wrong."""
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        parts = reader.get_summary()
        if parts is None or parts.statistics is None:
            raise Bad("the file has no summary")
        metadata = {entry.name: entry.metadata for entry in reader.iter_metadata()}
        if "palpate.run" not in metadata:
            raise Bad("no metadata palpate.run")
        dt_ns = int(metadata["palpate.run"]["dt_ns"])
        for attachment in reader.iter_attachments():
            if not attachment.data:
                raise Bad(f"attachment {attachment.name} is empty")

        # A channel without messages must be readable as well.
        factory = DecoderFactory()
        decoders, topics = {}, {}
        for channel in parts.channels.values():
            schema = parts.schemas.get(channel.schema_id)
            decoder = factory.decoder_for(channel.message_encoding, schema)
            if decoder is None:
                raise Bad(f"{channel.topic}: no decoder for {channel.message_encoding!r}")
            if channel.topic in topics:
                raise Bad(f"{channel.topic}: two channels")
            decoder(b"")
            as_published(schema.data, channel.topic)
            decoders[channel.id] = decoder
            topics[channel.topic] = {"schema": schema.name, "count": 0}

        counts: Counter = Counter()
        last: dict[int, int] = {}
        # In the order of the file: a reader that sorts would hide times that run backwards.
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            where = f"{channel.topic} message {counts[channel.id]} at {message.log_time} ns"
            try:
                value = decoders[channel.id](message.data)
            except Exception as error:
                raise Bad(f"{where}: does not decode as {schema.name}: {error}") from error
            without_unknown_fields(value, where)
            before = last.get(channel.id)
            if before is not None and message.log_time < before:
                raise Bad(f"{where}: earlier than the one before it, at {before} ns")
            if before == message.log_time and channel.topic == "/sim/tick":
                raise Bad(f"{where}: the same tick twice")
            last[channel.id] = message.log_time
            tick = tick_of(value)
            if tick is None and channel.topic.startswith("/sim/"):
                raise Bad(f"{where}: {schema.name} names no tick")
            if tick is not None and message.log_time != tick * dt_ns:
                raise Bad(f"{where}: tick {tick} of {dt_ns} ns each is {tick * dt_ns} ns")
            counts[channel.id] += 1
            topics[channel.topic]["count"] += 1

        # The summary leaves out channels without messages.
        told = {channel: count for channel, count in parts.statistics.channel_message_counts.items() if count}
        if told != dict(counts):
            raise Bad(f"the summary counts {told}, the file has {dict(counts)}")
    return {"file": path, "dt_ns": dt_ns, "messages": sum(counts.values()), "topics": topics}


def main() -> int:
    if len(sys.argv) != 2:
        print("usage: read_all.py FILE", file=sys.stderr)
        return 2
    try:
        print(json.dumps(read(sys.argv[1]), indent=2))
    except Exception as error:
        print(f"{sys.argv[1]}: {type(error).__name__}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
