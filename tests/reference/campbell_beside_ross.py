"""A Campbell diagram beside ROSS: the same frequencies of the same rotor, and how long each takes.

    just check-campbell

The rotors are files that ROSS saved, which `whirl rotor import` reads: a small one (`crates/beam/tests/cases/overhung_gyroscopic.toml`: ten
shaft elements, one disc, bearings) and one of sixty elements. Both compute 100 speeds up to 6000 rpm: ROSS by `run_campbell` on a rotor that is read already, Whirl by
`whirl trace --campbell`, once as a whole command with its start, reading and reduction, and once without, as the difference of two
commands; processor time of one thread each. Exits with 1 if a damped frequency differs by more than 1e-4, relative, which is what a reduction to 16 coordinates keeps.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# One thread each.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import ross

WHIRL = sys.argv[1] if len(sys.argv) > 1 else "target/release/whirl"
CASE = Path(__file__).resolve().parents[2] / "crates/beam/tests/cases/overhung_gyroscopic.toml"
TOP_RPM, SPEEDS, FREQUENCIES, TIMES = 6000.0, 100, 8, 5


def spent():
    """Processor time of the commands so far: what else the machine does is not counted."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def trace(rotor, speeds):
    """What a command prints, and the processor time that it took, the least of some."""
    arguments = [WHIRL, "trace", rotor, "--over", f"0..{TOP_RPM}", "--points", str(speeds), "--campbell", "--json"]
    times = []
    for _ in range(TIMES):
        begin = spent()
        ran = subprocess.run(arguments, check=True, capture_output=True)
        times.append(spent() - begin)
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
        begin = time.process_time()
        campbell = model.run_campbell(speeds, frequencies=FREQUENCIES)
        took.append(time.process_time() - begin)
    theirs = min(took)

    # Every frequency of ours that is as slow as theirs, which are the slowest so many, beside the nearest of those: they have no sign there,
    # and axial and torsional motion among them.
    w0 = found["scales"]["w0"]
    worst, compared = 0.0, 0
    for k in range(SPEEDS):
        theirs_here = np.sort(np.asarray(campbell.wd)[k])
        ours = np.array([abs(branch[k]["frequency"]) * w0 for branch in found["modes"] if branch[k]])
        # What does not turn to speak of is critically damped, or rigid.
        for frequency in ours[(ours > 1.0) & (ours < 0.999 * theirs_here[-1])]:
            worst = max(worst, min(abs(theirs_here - frequency)) / frequency)
            compared += 1
    elements = len(model.shaft_elements)
    print(f"{elements} shaft elements, {SPEEDS} speeds to {TOP_RPM:g} rpm, {FREQUENCIES} frequencies of ROSS {ross.__version__}")
    print(f"largest difference of {compared} damped frequencies: {worst:.1e}")
    print(f"ROSS {1e3 * theirs:.1f} ms; whirl: the whole command {1e3 * whole:.1f} ms, 100 speeds alone {1e3 * mine:.2f} ms")
    print(f"ratio ROSS / whirl: {theirs / whole:.0f} with its start, {theirs / mine:.0f} without")
    return worst


def main():
    folder = Path(tempfile.mkdtemp())
    worst = max(compare(folder, case, times) for case, times in [(CASE, 2), (sixty(folder), 1)])
    return 0 if worst < 1e-4 else 1


if __name__ == "__main__":
    sys.exit(main())
