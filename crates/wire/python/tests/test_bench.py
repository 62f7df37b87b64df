"""The package against a real bench: `just check-python`, or WHIRL=path/to/whirl pytest."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import whirl
from whirl import _settings
from whirl.messages import Readings

PROGRAM = os.environ.get("WHIRL", "whirl")
EXAMPLES = Path(__file__).parents[1] / "examples"
sys.path.insert(0, str(EXAMPLES))


class Benches:
    """Benches under a root of their own."""

    def __init__(self, root: Path) -> None:
        self.root = whirl.Root(root)
        self.environment = {**os.environ, "WHIRL_ROOT": str(root)}
        self.running: list[subprocess.Popen[str]] = []

    def start(self, *arguments: str, name: str = "a") -> whirl.Bench:
        """Starts a simulation and attaches to it."""
        command = [PROGRAM, "sim", *arguments, "--bench", name]
        self.running.append(subprocess.Popen(command, env=self.environment, stdout=subprocess.PIPE, text=True))
        return whirl.attach(name, self.root, patience=60.0)

    def run(self, *arguments: str) -> str:
        """Runs whirl to its end."""
        done = subprocess.run([PROGRAM, *arguments], env=self.environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done
        return done.stdout

    def end(self) -> None:
        """Ends them all."""
        for process in self.running:
            process.send_signal(signal.SIGTERM)
            assert process.wait(60) == 0
        self.running.clear()


@pytest.fixture
def benches() -> Iterator[Benches]:
    # A short path: that of pytest is longer than iceoryx2 can use without a link.
    with tempfile.TemporaryDirectory(prefix="w") as folder:
        made = Benches(Path(folder))
        try:
            yield made
            made.end()
        finally:
            for process in made.running:
                process.kill()


def test_a_root_is_that_of_the_program(benches: Benches) -> None:
    import json

    told = json.loads(benches.run("wire", "--json"))
    assert told["iceoryx2"]["root"] == str(benches.root.iceoryx2)
    assert told["iceoryx2"]["prefix"] == benches.root.prefix
    long = benches.root.path / ("x" * 60)
    benches.environment["WHIRL_ROOT"] = str(long)
    process = subprocess.Popen([PROGRAM, "sim", "--bench", "a"], env=benches.environment, stdout=subprocess.DEVNULL)
    try:
        end = time.monotonic() + 60
        while True:
            try:
                assert whirl.attach("a", long).latest().masses == 3
                break
            except whirl.WhirlError:
                assert time.monotonic() < end
                time.sleep(0.1)
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait()


def test_every_step_comes_in_order_and_as_views(benches: Benches) -> None:
    bench = benches.start("three-mass", "--rate", "5000")
    seen, previous = 0, None
    for block in bench.steps():
        assert block.masses == 3 and block.bearings == 1
        assert block.lost == 0
        if previous is not None:
            assert block.seq[0] == previous + 1
        previous = int(block.seq[-1])
        assert np.all(np.diff(block.seq.astype(np.int64)) == 1)
        assert block.y.shape == (len(block), 3) and not block.y.flags.owndata
        assert block.y.base is not None and np.shares_memory(block.y, block.words)
        assert np.array_equal(block.channel("reading_y"), block.y)
        columns = block.columns()
        assert np.array_equal(columns["y2"], block.y[:, 1]) and len(columns) == 31
        seen += len(block)
        if seen > 3000:
            break
    latest = bench.latest()
    assert len(latest) == 1 and latest.seq[0] >= previous - 1000
    with pytest.raises(KeyError, match="no channel 'w': there are run_id"):
        latest.channel("w")


def test_blocks_can_be_kept_two_at_a_time_and_copies_for_ever(benches: Benches) -> None:
    bench = benches.start("jeffcott")
    kept = []
    with pytest.raises(whirl.WhirlError, match="take a copy"):
        for block in bench.steps():
            kept.append(block)
    assert len(kept) == 2
    kept.clear()
    copies = []
    for block in bench.steps():
        copies.append(block.copy())
        if len(copies) == 50:
            break
    seqs = np.concatenate([copy.seq for copy in copies]).astype(np.int64)
    assert np.all(np.diff(seqs) == 1)


def test_settings_are_read_and_changed_and_what_is_refused_says_why(benches: Benches) -> None:
    bench = benches.start("three-mass", "--speed", "2.5")
    assert bench.settings["speed"] == 2.5 and bench.settings["deadband"] == [1.0, 1.0, 1.0]
    assert bench.rotor["name"] == "three-mass" and len(bench.rotor["mass"]) == 3
    answer = bench.set(speed=2.6, kd=-0.58, deadband=0.5, delay=0.02, why="to see")
    assert answer.revision == 2
    settings = bench.settings
    end = time.monotonic() + 10
    while settings["speed"] != 2.6 and time.monotonic() < end:
        settings = bench.settings
    assert settings["deadband"] == [0.5, 0.5, 0.5]
    assert settings["feedback"]["signal"][0]["kd"] == -0.58 and settings["feedback"]["loop"] == {"delay": 0.02}
    bench.set(delay="off", **{"deadband.2": 1.5})
    end = time.monotonic() + 10
    while "loop" in bench.settings["feedback"] and time.monotonic() < end:
        time.sleep(0.01)
    assert "loop" not in bench.settings["feedback"] and bench.settings["deadband"] == [0.5, 1.5, 0.5]
    with pytest.raises(whirl.Refused, match="speed"):
        bench.set(speed=1e9)
    with pytest.raises(ValueError, match="no setting 'kx': expected one of speed"):
        bench.set(kx=1.0)
    with pytest.raises(ValueError, match="kd = 'high': expected a number"):
        bench.set(kd="high")
    assert bench.note("hello from Python").step > 0
    bench.impulse(0, vy=0.1)
    events = {event.kind: event for event in bench.events()}
    assert events["note"].text == "hello from Python" and events["impulse"].who.startswith("python:")
    told = [event for event in whirl.attach("a", benches.root).events() if event.kind == "settings"]
    assert told[0].why == "to see" and told[0].revision == 2


def test_somebody_who_changes_something_meanwhile_is_no_obstacle(benches: Benches) -> None:
    bench = benches.start("three-mass")
    first = bench.status.revision
    # Behind the back of `bench`, whose status is of before.
    benches.run("set", "--bench", "a", "trip=77")
    bench.set(kd=-0.57)
    end = time.monotonic() + 10
    while bench.status.revision < first + 2 and time.monotonic() < end:
        time.sleep(0.01)
    assert bench.settings["trip"] == 77.0 and bench.settings["feedback"]["signal"][0]["kd"] == -0.57


def test_documents_are_written_as_they_are_read() -> None:
    text = (
        "speed = 0.30000000000000004\ntrip = 1e9\nramp = inf\ndeadband = [1.0, 0.5]\nmasses = 2\nfeedback = '''\nbearing = 1\n"
        "filter = [{ kind = \"notch\", frequency = 3.0, width = 0.2 }]\n[[signal]]\nmass = 1\nkd = { at_zero = -0.0, slope = 5e-324 }\n"
        "cd = { speed = [0.0, 2.0], value = [1.0, 1e-17] }\nkc = 0.0\ncc = 0.0\n[loop]\ndelay = 0.1\nlimit = 20.0\n'''\n"
    )
    settings = _settings.read(text)
    assert _settings.read(_settings.write(settings)) == settings
    again = _settings.read(_settings.changed(text, {"limit": "off", "ramp": 0.25, "kd.1": 2}))
    assert again["feedback"]["loop"] == {"delay": 0.1} and again["ramp"] == 0.25
    assert again["feedback"]["signal"][0]["kd"] == 2.0
    assert _settings.read(_settings.changed(text, {"ramp": "off"}))["ramp"] == math.inf
    coasting = _settings.changed(text, {"coast_down": 0.5})
    assert _settings.read(coasting)["coast_down"] == 0.5
    assert _settings.read(_settings.changed(coasting, {"coast_down": "off"}))["coast_down"] == 0.0
    with pytest.raises(ValueError, match="index from 1 to 2"):
        _settings.changed(text, {"deadband.3": 1.0})
    changed = _settings.read(_settings.changed(_two(), {"right.kd": 3.0, "delay": 0.5}))
    assert changed["feedback"]["bearing"][1]["signal"][0]["kd"] == 3.0
    assert all(bearing["loop"]["delay"] == 0.5 for bearing in changed["feedback"]["bearing"])
    with pytest.raises(ValueError, match="which control bearing"):
        _settings.changed(_two(), {"kd": 1.0})


def _two() -> str:
    bearing = '[[bearing]]\nname = "{}"\nmass = {}\n[[bearing.signal]]\nmass = {}\nkd = 1.0\n'
    feedback = bearing.format("left", 1, 1) + bearing.format("right", 2, 2)
    return f"speed = 1.0\ntrip = 10.0\nramp = inf\ndeadband = [1.0, 0.5]\nmasses = 2\nfeedback = '''\n{feedback}'''\n"


def test_a_controller_does_what_the_built_in_law_does_to_the_last_bit(benches: Benches, tmp_path: Path) -> None:
    import controller as example

    loop = ["--feedback", "individual", "--speed", "2.5", "--deadband", "1"]
    command = ["sim", "three-mass", *loop, "--set", "sample=0.01", "--set", "external=20", "--lockstep", "--bench", "c"]
    benches.running.append(subprocess.Popen([PROGRAM, *command], env=benches.environment, stdout=subprocess.PIPE, text=True))
    bench = whirl.attach("c", benches.root, patience=60.0)
    steps = bench.steps(timeout=60.0)
    rows: list[np.ndarray] = []
    with bench.controller() as controller:
        with pytest.raises(whirl.WhirlError, match="controlled from outside already"):
            bench.controller()
        count = 0
        for readings in controller.readings(timeout=60.0):
            controller.command(readings, [example.law(readings)])
            count += 1
            if count == 1500:
                break
        for block in steps:
            assert block.has("external").all()
            rows.append(np.column_stack([block.tau, block.y, block.z, block.uy, block.uz]))
            if sum(map(len, rows)) >= 1400:
                break
    ours = np.concatenate(rows)
    out = tmp_path / "run.csv"
    benches.run("run", "three-mass", *loop, "--set", "sample=0.01", "--dtau", "0.01", "--duration", "15", "--out", str(out))
    names = out.read_text().splitlines()[0].split(",")
    theirs = np.genfromtxt(out, delimiter=",", skip_header=1)
    wanted = ["tau", "y1", "y2", "y3", "z1", "z2", "z3", "uy", "uz"]
    by_tau = {row[names.index("tau")]: row[[names.index(name) for name in wanted]] for row in theirs}
    compared = 0
    for row in ours:
        if row[0] in by_tau:
            assert np.array_equal(by_tau[row[0]], row), row[0]
            compared += 1
    assert compared > 1300


def test_readings_are_finite_and_named(benches: Benches) -> None:
    loop = ["--feedback", "individual", "--set", "sample=0.01", "--set", "delay=0.15", "--set", "external=5"]
    bench = benches.start("three-mass", *loop)
    with bench.controller() as controller:
        last: Readings | None = None
        for readings in controller.readings(timeout=30.0):
            assert last is None or readings.number > last.number
            last = readings
            controller.command(readings, [(math.nan, 0.0)])
            if readings.refused > 3:
                break
    assert last is not None and last.masses == 3 and last.lockstep == 0 and last.deadline_ns > last.wall_ns - 10**10
    # The bench goes on by its own law.
    assert np.isfinite(bench.latest().y).all()


def test_nobody_there_is_told(benches: Benches) -> None:
    with pytest.raises(whirl.WhirlError, match="no bench 'none' is running"):
        whirl.attach("none", benches.root, patience=0.1)
    bench = benches.start("jeffcott")
    steps = bench.steps()
    next(steps)
    benches.end()
    # What was sent before still comes, and then it is over.
    assert sum(len(block) for block in steps) >= 0
    assert not bench.is_alive()


def test_an_example_logs_to_polars(benches: Benches) -> None:
    pytest.importorskip("polars")
    import to_polars

    frame = to_polars.log(benches.start("three-mass", "--rate", "2000"), 0.5)
    assert frame.height >= 1000 and frame["seq"].diff().drop_nulls().eq(1).all()
    assert frame["y1"].is_finite().all()
