"""What a controller outside and a reader in Python cost and keep up with.

    cargo build --release -p whirl && cargo build --release -p wire --example controller
    python3 tests/reference/open_bench.py target/release [target/python-bench/bin/python]

Nothing but Python's own library; with the interpreter of a virtual environment that has the package of crates/wire/python (`just check-python` makes
one), reading in Python is measured too. Benches with and without a controller run in turn, so that both meet the same machine.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

SETTINGS = ["--feedback", "individual", "--set", "sample=0.01", "--set", "external=20"]
TURNS, SECONDS = 5, 6


class Bench:
    """A bench under a root of its own, ended with the block."""

    def __init__(self, folder, *arguments):
        self.folder, self.root = folder, tempfile.TemporaryDirectory()
        self.environment = dict(os.environ, WHIRL_ROOT=self.root.name)
        command = [f"{folder}/whirl", "sim", "three-mass", "--bench", "lab", *arguments]
        self.process = subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL)
        time.sleep(1.5)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.root.cleanup()

    def status(self):
        told = subprocess.run(
            [f"{self.folder}/whirl", "status", "--json"], env=self.environment, capture_output=True, check=True
        )
        return json.loads(told.stdout)["benches"][0]

    def controller(self):
        return subprocess.Popen(
            [f"{self.folder}/examples/controller", "lab"], env=self.environment, stdout=subprocess.DEVNULL
        )


def pace(folder):
    """Lateness and cost of a step at 1000 steps/s, with a controller outside and without, and how old its commands are."""
    found = {True: [], False: []}
    ages = []
    for turn in range(2 * TURNS):
        controlled = turn % 2 == 1
        with Bench(folder, "--set", "delay=0.02", *SETTINGS) as bench:
            controller = bench.controller() if controlled else None
            time.sleep(SECONDS)
            status = bench.status()
            if controller is not None:
                ages.append((status["control"]["age_us"]["p50"], status["control"]["age_us"]["p99"]))
                controller.kill()
                controller.wait()
            found[controlled].append(
                [status["lateness_us"]["p50"], status["lateness_us"]["p99"], status["step_cost_us"]["p50"]]
            )
    for place, what in enumerate(["lateness, median", "lateness, 99th percentile", "cost of a step, median"]):
        alone, outside = (statistics.median(row[place] for row in found[is_on]) for is_on in (False, True))
        print(f"{what}: {alone:.1f} us without, {outside:.1f} us with a controller outside ({outside / alone:.2f})")
    median, worst = (statistics.median(pair[i] for pair in ages) for i in (0, 1))
    print(f"age of a command: {median:.0f} us median, {worst:.0f} us at the 99th percentile")


def lockstep(folder):
    """Steps a second where the machine waits for its controller."""
    rates = []
    for _ in range(TURNS):
        with Bench(folder, "--lockstep", *SETTINGS) as bench:
            controller = bench.controller()
            time.sleep(1.0)
            before, began = bench.status()["steps"], time.monotonic()
            time.sleep(SECONDS)
            rates.append((bench.status()["steps"] - before) / (time.monotonic() - began))
            controller.kill()
            controller.wait()
    print(f"lockstep: {statistics.median(rates):.0f} steps/s (median of {TURNS}), {max(rates):.0f} at its fastest")


def python(folder, interpreter):
    """A minute at 20 000 steps/s read in Python."""
    listen = os.path.join(os.path.dirname(__file__), "../../crates/wire/python/examples/listen.py")
    with Bench(folder, "--rate", "20000") as bench:
        told = subprocess.run(
            [interpreter, listen, "lab", "60"], env=bench.environment, capture_output=True, check=True, text=True
        )
    print(f"Python: {told.stdout.strip()}")


def main():
    folder = os.path.abspath(sys.argv[1])
    pace(folder)
    lockstep(folder)
    if len(sys.argv) > 2:
        python(folder, os.path.abspath(sys.argv[2]))


main()
