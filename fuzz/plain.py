"""Writes recordings again without compression and checksums, as inputs for fuzzers: a change of a byte then reaches what
decodes messages, and is not found by a checksum before. Needs the packages of tests/python/requirements.txt.

    python fuzz/plain.py RECORDING.mcap... FOLDER
"""

import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer


def rewrite(source, target):
    with source.open("rb") as file, target.open("wb") as out:
        reader = make_reader(file)
        header, summary = reader.get_header(), reader.get_summary()
        writer = Writer(out, compression=CompressionType.NONE, enable_crcs=False, enable_data_crcs=False, index_types=IndexType.ALL)
        writer.start(header.profile, header.library)
        schemas = {0: 0}
        schemas |= {s.id: writer.register_schema(s.name, s.encoding, s.data) for s in summary.schemas.values()}
        channels = {
            c.id: writer.register_channel(c.topic, c.message_encoding, schemas[c.schema_id], c.metadata) for c in summary.channels.values()
        }
        for record in reader.iter_metadata():
            writer.add_metadata(record.name, record.metadata)
        for a in reader.iter_attachments():
            writer.add_attachment(a.create_time, a.log_time, a.name, a.media_type, a.data)
        for _, channel, message in reader.iter_messages(log_time_order=False):
            # The shapes of bodies are thousands of points, of which one is like the other.
            if channel.topic.startswith("/scene/bodies"):
                continue
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence)
        writer.finish()


if __name__ == "__main__":
    *sources, folder = map(Path, sys.argv[1:])
    for source in sources:
        rewrite(source, folder / source.name)
