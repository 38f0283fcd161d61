"""Decodes every message of an MCAP file with the mcap package and says what it found, as one JSON object by topic."""

import json
import struct
import sys

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

found = {}
with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    # No topic is left out: a channel that does not decode raises.
    for schema, channel, message, decoded in reader.iter_decoded_messages():
        of = found.setdefault(channel.topic, {"schema": schema.name, "messages": 0, "inner": 0})
        of["messages"] += 1
        of["last_ns"] = message.log_time
        if schema.name == "foxglove.PointCloud":
            assert decoded.fields[2].name == "z" and decoded.fields[2].offset == 8
            points = list(struct.iter_unpack("<fff", decoded.data)) if decoded.point_stride == 12 else [
                point[:3] for point in struct.iter_unpack("<ffff", decoded.data)
            ]
            # (No tool and no jaw is farther from its frame than this, metres.)
            assert points and all(abs(x) < 0.5 for point in points for x in point)
            of["inner"] += len(points)
        elif schema.name == "foxglove.FrameTransforms":
            of["inner"] += len(decoded.transforms)
        elif schema.name == "foxglove.PoseInFrame":
            q = decoded.pose.orientation
            assert abs(q.w**2 + q.x**2 + q.y**2 + q.z**2 - 1) < 1e-5
        elif schema.name == "foxglove.Log":
            assert decoded.message
        elif schema.name == "sulcus.v1.Wrench":
            of["inner"] += decoded.peak_force_n > 0
        elif schema.name == "sulcus.v1.Contacts":
            of["inner"] += len(decoded.contacts)
        elif schema.name == "sulcus.v1.ExactRow":
            tick, time_unix_ns = struct.unpack_from("<QQ", decoded.row)
            assert time_unix_ns == message.log_time and tick > of.get("tick", 0)
            of["tick"] = tick
            of["inner"] += len(decoded.row)
        elif schema.name == "sulcus.v1.ExactState":
            of["inner"] += len(decoded.state)
        elif schema.name == "sulcus.v1.ExactStatement":
            of["inner"] += len(decoded.statement)
        elif schema.name == "sulcus.v1.ExactEvent":
            assert json.loads(decoded.event)["level"] in ("info", "warning", "error")
            of["inner"] += len(decoded.event)
print(json.dumps(found))
