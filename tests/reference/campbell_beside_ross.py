"""A Campbell diagram beside ROSS: the same frequencies of the same rotor, and how long each takes.

    just check-campbell

The rotors are files that ROSS saved, which `whirl rotor import` reads: a small one (`crates/beam/tests/cases/overhung_gyroscopic.toml`: ten
shaft elements, one disc, bearings) and one of sixty elements. Both compute 100 speeds up to 6000 rpm: ROSS by `run_campbell` on a rotor that is read already, Whirl by
`whirl trace --campbell`, once as a whole command with its start, reading and reduction, and once without, as the difference of two
commands. Exits with 1 if a damped frequency differs by more than 1e-4, relative, which is what a reduction to 16 coordinates keeps.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import ross

WHIRL = sys.argv[1] if len(sys.argv) > 1 else "target/release/whirl"
CASE = Path(__file__).resolve().parents[2] / "crates/beam/tests/cases/overhung_gyroscopic.toml"
TOP_RPM, SPEEDS, FREQUENCIES, TIMES = 6000.0, 100, 8, 5


def trace(rotor, speeds):
    """What a command prints, and how long it took, the fastest of some."""
    arguments = [WHIRL, "trace", rotor, "--over", f"0..{TOP_RPM}", "--points", str(speeds), "--campbell", "--json"]
    times = []
    for _ in range(TIMES):
        begin = time.perf_counter()
        ran = subprocess.run(arguments, check=True, capture_output=True)
        times.append(time.perf_counter() - begin)
    return json.loads(ran.stdout), min(times)


def sixty(folder):
    """A stepped shaft of sixty elements with six discs, as the benchmarks of crate `beam` have it, saved by ROSS."""
    steel = ross.Material(name="steel", rho=7810.0, E=211e9, Poisson=0.3)
    shaft = [
        ross.ShaftElement(L=1.5 / 60, idl=0.0, odl=0.05 + 0.03 * (i % 3), material=steel, shear_effects=True, rotary_inertia=True, gyroscopic=True)
        for i in range(60)
    ]
    discs = [ross.DiskElement.from_geometry(n=i, material=steel, width=0.05, i_d=0.0, o_d=0.3) for i in range(5, 60, 10)]
    bearings = [ross.BearingElement(n=n, kxx=1e7, cxx=1e3) for n in (0, 60)]
    path = folder / "sixty.toml"
    ross.Rotor(shaft, discs, bearings).save(path)
    return path


def compare(folder, case, times):
    rotor = str(folder / "rotor.toml")
    Path(rotor).write_bytes(subprocess.run([WHIRL, "rotor", "import", str(case)], check=True, capture_output=True).stdout)
    found, whole = trace(rotor, SPEEDS)
    _, short = trace(rotor, 2)
    mine = (whole - short) / (SPEEDS - 2) * SPEEDS

    model = ross.Rotor.load(case)
    speeds = np.linspace(0.0, TOP_RPM * np.pi / 30.0, SPEEDS)
    took = []
    for _ in range(times):
        begin = time.perf_counter()
        campbell = model.run_campbell(speeds, frequencies=FREQUENCIES)
        took.append(time.perf_counter() - begin)
    theirs = min(took)

    # Every damped frequency of theirs beside the nearest of ours: they have no sign there.
    w0 = found["scales"]["w0"]
    worst = 0.0
    for k in range(SPEEDS):
        ours = np.array([abs(branch[k]["frequency"]) * w0 for branch in found["modes"] if branch[k]])
        for frequency in np.asarray(campbell.wd)[k]:
            # What is critically damped, and axial or torsional motion, is no lateral whirl.
            if frequency > 1.0:
                worst = max(worst, min(abs(ours - frequency)) / frequency)
    elements = len(model.shaft_elements)
    print(f"{elements} shaft elements, {SPEEDS} speeds to {TOP_RPM:g} rpm, {FREQUENCIES} frequencies of ROSS {ross.__version__}")
    print(f"largest difference of a damped frequency: {worst:.1e}")
    print(f"ROSS {1e3 * theirs:.1f} ms; whirl: the whole command {1e3 * whole:.1f} ms, 100 speeds alone {1e3 * mine:.2f} ms")
    print(f"ratio ROSS / whirl: {theirs / whole:.0f} with its start, {theirs / mine:.0f} without")
    return worst


def main():
    folder = Path(tempfile.mkdtemp())
    worst = max(compare(folder, case, times) for case, times in [(CASE, 2), (sixty(folder), 1)])
    return 0 if worst < 1e-4 else 1


if __name__ == "__main__":
    sys.exit(main())
