#!/usr/bin/env python3
"""Checks recordings against the public Rerun SDK: what it reads is what whirl printed, computed and exports, bit for bit.

    just check-recordings

or, with rerun-sdk==0.36.3 and pyarrow from pip:

    python3 tests/reference/recordings.py target/release/whirl

1. A bench is recorded while `whirl tail --json` prints it: every value of the SDK equals the printed one.
2. A run without a bench is written as .rrd and as .csv: every value of the SDK equals the one in the table.
3. The sample in recordings/: entities, timelines, and every column beside `whirl export --parquet`; every alarm in its log.
"""

import csv
import json
import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet
import rerun as rr
from rerun.experimental import RrdReader

SAMPLE = Path(__file__).parents[2] / "recordings" / "run-up.rrd"
TIMELINES = {"step", "tau", "wall"}


def bits(value):
    return struct.pack("<d", value)


def chunks(path):
    """Every chunk of the recording in a file, as pyarrow sees it."""
    reader = RrdReader(str(path))
    [store] = reader.recordings()
    return reader.stream(store=store).to_chunks()


def steps(path):
    """Every step of a recording by its number, as the SDK reads it."""
    found = {}
    for chunk in chunks(path):
        if chunk.entity_path != "/steps":
            continue
        batch = chunk.to_record_batch()
        rows = batch.column("whirl:step").to_pylist()
        numbers = batch.column("step").to_pylist()
        walls = batch.column("wall").cast(pa.int64()).to_pylist()
        for number, wall, row in zip(numbers, walls, rows, strict=True):
            [row] = row
            assert number not in found, f"step {number} twice"
            found[number] = row | {"wall_ns": wall}
    return found


def equal(what, ours, theirs):
    assert bits(float(ours)) == bits(float(theirs)), f"{what}: {ours!r} is not {theirs!r}"


def whirl(*arguments, **options):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True, **options).stdout


def live(folder):
    """What is recorded of a bench is what `whirl tail` prints of it."""
    environment = os.environ | {"WHIRL_ROOT": str(folder / "root")}
    (folder / "root").mkdir()
    path = folder / "live.rrd"
    bench = subprocess.Popen([PROGRAM, "sim", "three-mass", "--rate", "2000"], env=environment, stdout=subprocess.DEVNULL)
    try:
        recorder = subprocess.Popen([PROGRAM, "record", path], env=environment, stdout=subprocess.DEVNULL)
        while not path.exists():
            time.sleep(0.01)
        whirl("set", "kd=0.1", "--why", "to see", env=environment)
        lines = [json.loads(line) for line in whirl("tail", "--count", 5000, "--json", env=environment).splitlines()]
        recorder.terminate()
        assert recorder.wait() == 0
    finally:
        bench.terminate()
        bench.wait()
    recorded = steps(path)
    for line in lines:
        row = recorded[line["seq"]]
        equal("tau", row["tau"], line["tau"])
        equal("speed", row["speed"], line["speed"])
        equal("uy", row["uy"], line["force"]["y"])
        equal("uz", row["uz"], line["force"]["z"])
        assert row["revision"] == line["revision"]
        for k, mass in enumerate(line["masses"], 1):
            for name in ["y", "z", "vy", "vz"]:
                equal(f"{name}{k}", row[f"{name}{k}"], mass[name])
    return f"{len(lines)} steps as `whirl tail` printed them"


def events(path):
    """Every event of a recording: its step, its level, its words and its document, as the SDK reads them."""
    for chunk in chunks(path):
        if chunk.entity_path != "/events":
            continue
        batch = chunk.to_record_batch()
        columns = ["step", "TextLog:level", "TextLog:text", "whirl:document"]
        for step, [level], [text], [document] in zip(*(batch.column(name).to_pylist() for name in columns), strict=True):
            yield step, level, text, json.loads(document)


def alarms(folder):
    """Each alarm that `whirl info` tells of rises in the log at its step, with a value that was that of its step."""
    told = json.loads(whirl("info", SAMPLE, "--json"))["alarms"]
    assert {"damping", "orbit"} <= {alarm["watch"] for alarm in told}, told
    recorded, log = steps(SAMPLE), list(events(SAMPLE))
    for alarm in told:
        for end in ["from", "to"]:
            [(_, level, text, document)] = [
                event for event in log
                if event[0] == alarm[end]["step"] and event[3].get("alarm", {}).get("watch") == alarm["watch"]
            ]
            alarmed = document["alarm"]
            assert alarm["watch"] in text and level in ("ERROR", "WARN", "INFO"), text
            assert (alarmed["before"] if end == "from" else alarmed["level"]) == "fine", document
            if alarm["watch"] == "orbit":
                row = recorded[alarm[end]["step"]]
                radius = max((row[f"y{k}"] ** 2 + row[f"z{k}"] ** 2) ** 0.5 for k in (1, 2, 3))
                # A hypotenuse is not rounded alike everywhere.
                assert abs(alarmed["value"] - radius) <= 1e-14 * radius, (alarmed, radius)
    return f"{len(told)} alarms as `whirl info` tells of them, each at its step"


def offline(folder):
    """What is recorded of a run is what the run computed."""
    run = ["run", "three-mass", "--feedback", "composite", "--speed", "2.5", "--deadband", "1", "--duration", "50"]
    whirl(*run, "--out", folder / "run.rrd")
    whirl(*run, "--out", folder / "run.csv")
    recorded = steps(folder / "run.rrd")
    with open(folder / "run.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    assert len(rows) == len(recorded)
    for number, row in enumerate(rows):
        assert recorded[number]["flags"] == int(row.pop("contact"))
        for name, value in row.items():
            equal(name, recorded[number][name], value)
    return f"{len(rows)} steps as `whirl run` computed them"


def sample(folder):
    """Entities and timelines of the sample, and every column beside our own export."""
    entities, timelines = set(), set()
    for chunk in chunks(SAMPLE):
        entities.add(chunk.entity_path)
        timelines.update(chunk.timeline_names)
    expected = {"/session", "/steps", "/settings", "/settings/values", "/poles"}
    expected |= {"/poles/min_damping", "/events", "/health"}
    expected |= {f"/orbits/mass{k}{rest}" for k in (1, 2, 3) for rest in ("", "/deadband")}
    assert expected <= entities, f"missing: {expected - entities}"
    assert timelines == TIMELINES, timelines
    whirl("export", SAMPLE, "--out", folder / "sample.parquet")
    table = pa.parquet.read_table(folder / "sample.parquet")
    recorded = steps(SAMPLE)
    assert table.num_rows == len(recorded)
    for row in table.to_pylist():
        theirs = recorded[row.pop("step")]
        for name in ["wall_ns", "revision", "flags"]:
            assert row.pop(name) == theirs[name]
        # The sample is older than some columns of today.
        assert set(theirs) - {"wall_ns", "revision", "flags"} <= set(row), theirs
        for name in set(row) & set(theirs):
            equal(name, theirs[name], row[name])
    return f"{len(entities)} entities on {len(timelines)} timelines, {table.num_rows} steps beside `whirl export`"


PROGRAM = str(Path(sys.argv[1]).resolve())
assert rr.__version__ == "0.36.3", f"rerun-sdk is {rr.__version__}, expected 0.36.3"
for check in [live, offline, sample, alarms]:
    with tempfile.TemporaryDirectory(prefix="whirl-") as folder:
        rest = "" if check is alarms else ": equal to the last bit"
        print(f"{check.__name__}: {check(Path(folder))}{rest}")
