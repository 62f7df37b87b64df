#!/usr/bin/env python3
"""What the public Rerun SDK reads of recordings that were written before messages had checksums: how many steps, and a CRC-32
of all their numbers. With rerun-sdk==0.36.3 and pyarrow from pip:

    python3 tests/reference/old_recordings.py

The values stand in `crates/tape/tests/damage.rs`.
"""

import struct
import zlib
from pathlib import Path

import pyarrow as pa
from rerun.experimental import RrdReader

ROOT = Path(__file__).parents[2]

for name in ["crates/tape/tests/schema-1.rrd", "recordings/run-up.rrd"]:
    found = {}
    reader = RrdReader(str(ROOT / name))
    [store] = reader.recordings()
    for chunk in reader.stream(store=store).to_chunks():
        if chunk.entity_path == "/steps":
            batch = chunk.to_record_batch()
            walls = batch.column("wall").cast(pa.int64()).to_pylist()
            for number, wall, [row] in zip(batch.column("step").to_pylist(), walls, batch.column("whirl:step").to_pylist()):
                assert number not in found
                # In the order of the columns: doubles, then revision and flags.
                whole = [row.pop(name) for name in ("revision", "flags")]
                found[number] = struct.pack(f"<{len(row)}d4Q", *row.values(), *whole, number, wall)
    crc = 0
    for number in sorted(found):
        crc = zlib.crc32(found[number], crc)
    print(f"{name}: {len(found)} steps, {crc:#010x}")
