"""What rotors of shaft elements cost in an optimised build, in processor time, so that what else the machine does is not counted:

    cargo build --release && python3 tests/reference/shaft_times.py target/release/whirl

A rotor of sixty elements read, assembled and reduced; its poles in few coordinates, as the difference of two traces; a step of the rig on
its two magnetic bearings, as the difference of two runs.
"""

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

WHIRL = sys.argv[1] if len(sys.argv) > 1 else "target/release/whirl"


def spent():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def least(times, *arguments):
    """The least processor time of some runs of a command, and what it prints."""
    took = []
    for _ in range(times):
        begin = spent()
        ran = subprocess.run([WHIRL, *arguments], check=True, capture_output=True, text=True)
        took.append(spent() - begin)
    return min(took), ran.stdout


def sixty(coordinates):
    text = f"coordinates = {coordinates}\nunits = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n"
    for i in range(60):
        text += f"[[section]]\nlength = {1.5 / 60}\nouter = {0.05 + 0.03 * (i % 3)}\n"
        if i % 10 == 5:
            text += f"[[disc]]\nstation = {i + 1}\nouter = 0.3\nwidth = 0.05\nmaterial = 'steel'\n"
    for station in (1, 61):
        text += f"[[bearing]]\nstation = {station}\nstiffness = 1e7\ndamping = 1e3\n"
    return text


def main():
    folder = Path(tempfile.mkdtemp())
    rotor = str(folder / "rotor.toml")
    for coordinates in (16, 12, 8):
        Path(rotor).write_text(sixty(coordinates))
        if coordinates == 16:
            whole, _ = least(5, "rotor", "check", rotor)
            print(f"sixty elements read, assembled and reduced, with the start of the command: {1e3 * whole:.1f} ms")
        short, long = (least(3, "trace", rotor, "--over", "0..6000", "--points", n, "--json")[0] for n in ("100", "1100"))
        print(f"poles in {coordinates} coordinates, matched and written: {1e3 * (long - short):.0f} us")
    rig = least(1, "rotor", "show", "rig")[1]
    for coordinates in (12, 16):
        Path(rotor).write_text(rig.replace("coordinates = 12", f"coordinates = {coordinates}"))
        runs = [least(2, "run", rotor, "--feedback", "own", "--speed", "6000", "--duration", tau, "--json") for tau in ("20", "220")]
        steps = 200.0 / json.loads(runs[1][1])["dtau"]
        print(f"a step of {coordinates} coordinates with two bearings: {1e6 * (runs[1][0] - runs[0][0]) / steps:.2f} us")


if __name__ == "__main__":
    main()
