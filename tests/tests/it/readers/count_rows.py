"""Counts the rows of every component of every entity in a Rerun file, as one JSON object by entity path."""

import json
import sys

from rerun.experimental import RrdReader

found = {}
for chunk in RrdReader(sys.argv[1]).stream():
    batch = chunk.to_record_batch()
    of = found.setdefault(chunk.entity_path, {})
    for name, column in zip(batch.schema.names, batch.columns):
        of[name] = of.get(name, 0) + batch.num_rows - column.null_count
print(json.dumps(found))
