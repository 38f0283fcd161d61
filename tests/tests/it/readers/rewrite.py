"""Writes an MCAP file anew with the mcap package, in several legal arrangements, into a folder; prints the names as a JSON array.

Messages are read in the order of their log times, as that package does unless told otherwise.
"""

import json
import os
import sys

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

WAYS = {
    "uncompressed": {"compression": CompressionType.NONE},
    "lz4": {"compression": CompressionType.LZ4},
    "zstd": {"compression": CompressionType.ZSTD, "chunk_size": 20_000},
    "no_chunks": {"use_chunking": False},
    "no_summary": {"use_statistics": False, "use_summary_offsets": False, "repeat_channels": False, "repeat_schemas": False},
    "header_last": {"header_last": True},
    "no_chunks_header_last": {"use_chunking": False, "header_last": True},
}


def write(source, target, header_last=False, **options):
    with open(source, "rb") as read, open(target, "wb") as out:
        reader = make_reader(read)
        writer = Writer(out, **options)
        writer.start(profile="", library="rewrite")

        def header():
            for attachment in reader.iter_attachments():
                writer.add_attachment(
                    attachment.create_time, attachment.log_time, attachment.name, attachment.media_type, attachment.data
                )
            for metadata in reader.iter_metadata():
                writer.add_metadata(metadata.name, metadata.metadata)

        if not header_last:
            header()
        schemas, channels = {}, {}
        for schema, channel, message in reader.iter_messages():
            if schema.id not in schemas:
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
            if channel.id not in channels:
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schemas[schema.id], channel.metadata
                )
            writer.add_message(
                channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence
            )
        if header_last:
            header()
        writer.finish()


for name, options in WAYS.items():
    write(sys.argv[1], os.path.join(sys.argv[2], name + ".mcap"), **options)
print(json.dumps([name + ".mcap" for name in WAYS]))
