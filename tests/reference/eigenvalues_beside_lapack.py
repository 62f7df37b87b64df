"""All poles of a rotor of 60 elements beside LAPACK's `zgeev` on the same matrix, as SciPy calls it: how long each takes.

    just check-eigenvalues

The matrices are made here (beams of Euler and Bernoulli, two discs, two damped bearings): 122 complex coordinates, whose companion
matrix has 244 rows. They go to Whirl as NPZ, named by a rotor file with `[plant]`; `whirl poles --full` computes all eigenvalues and the
shapes of the modes, and `whirl rotor check` reads the same file and makes the same rotor without any, so that their difference is what
the poles cost. Times are of a processor. Exits with 1 if a slow eigenvalue differs by more than 1e-6, relative.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# One thread.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import scipy.linalg

WHIRL = sys.argv[1] if len(sys.argv) > 1 else "target/release/whirl"
ELEMENTS, LENGTH, DIAMETER, DENSITY, YOUNG, RPM, TIMES = 60, 1.5, 0.06, 7810.0, 211e9, 4000.0, 5


def matrices():
    """M, C, G, K of the complex form, `p` and its slope at each node."""
    n, l = ELEMENTS + 1, LENGTH / ELEMENTS
    area, inertia = np.pi * DIAMETER**2 / 4, np.pi * DIAMETER**4 / 64
    bend = YOUNG * inertia / l**3 * np.array([[12, 6 * l, -12, 6 * l], [6 * l, 4 * l**2, -6 * l, 2 * l**2], [-12, -6 * l, 12, -6 * l], [6 * l, 2 * l**2, -6 * l, 4 * l**2]])
    shake = DENSITY * area * l / 420 * np.array([[156, 22 * l, 54, -13 * l], [22 * l, 4 * l**2, 13 * l, -3 * l**2], [54, 13 * l, 156, -22 * l], [-13 * l, -3 * l**2, -22 * l, 4 * l**2]])
    tilt = DENSITY * inertia / (30 * l) * np.array([[36, 3 * l, -36, 3 * l], [3 * l, 4 * l**2, -3 * l, -(l**2)], [-36, -3 * l, 36, -3 * l], [3 * l, -(l**2), -3 * l, 4 * l**2]])
    m, c, g, k = (np.zeros((2 * n, 2 * n)) for _ in range(4))
    for e in range(ELEMENTS):
        at = slice(2 * e, 2 * e + 4)
        k[at, at] += bend
        m[at, at] += shake + tilt
        g[at, at] += 2 * tilt
    for node in (15, 40):
        m[2 * node, 2 * node] += 30.0
        m[2 * node + 1, 2 * node + 1] += 0.2
        g[2 * node + 1, 2 * node + 1] += 0.38
    for node in (0, ELEMENTS):
        k[2 * node, 2 * node] += 1e7
        c[2 * node, 2 * node] += 2e3
    c += 1e-6 * k
    return m, c, g, k


def spent():
    """Processor time of this program and of the commands that it has run: what else the machine does is not counted."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime + time.process_time()


def fastest(work):
    times = []
    for _ in range(TIMES):
        begin = spent()
        found = work()
        times.append(spent() - begin)
    return found, min(times)


def main():
    m, c, g, k = matrices()
    n = len(m)
    folder = Path(tempfile.mkdtemp())
    np.savez(folder / "rotor.npz", M=m, C=c, G=g, K=k)
    stations = list(range(1, n + 1, 2))
    rotor = folder / "rotor.toml"
    # What has no scale of its own gets one from a spring that is nothing beside the bearings in the matrices.
    rotor.write_text(
        f"units = 'si'\n[plant]\nstations = {stations}\npositions = {np.linspace(0, LENGTH, len(stations)).tolist()}\n"
        "matrices = 'rotor.npz'\n[[bearing]]\nstation = 1\nstiffness = 1e7\n"
    )
    k[0, 0] += 1e7

    def command(*arguments):
        return subprocess.run([WHIRL, *arguments], check=True, capture_output=True, text=True).stdout

    found, whole = fastest(lambda: json.loads(command("poles", str(rotor), "--speed", str(RPM), "--full", "--json")))
    _, read = fastest(lambda: command("rotor", "check", str(rotor)))
    mine = whole - read

    spin = RPM * np.pi / 30
    inverse = np.linalg.inv(m)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ k, -inverse @ (c - 1j * spin * g)]]).astype(complex)
    theirs_values, alone = fastest(lambda: scipy.linalg.eig(a, right=False, check_finite=False))
    (_, _), both = fastest(lambda: scipy.linalg.eig(a, right=True, check_finite=False))

    w0 = found["scales"]["w0"]
    ours = np.array([complex(mode["re"], mode["im"]) for mode in found["modes"]]) * w0
    slow = theirs_values[np.abs(theirs_values) < 1e4]
    worst = max(min(abs(ours - s)) / abs(s) for s in slow)
    print(f"{n} coordinates, {len(a)} eigenvalues; {len(slow)} below 1e4 rad/s differ by {worst:.1e} at most")
    print(f"zgeev: {1e3 * alone:.1f} ms, with vectors {1e3 * both:.1f} ms; whirl poles --full less rotor check: {1e3 * mine:.1f} ms ({1e3 * whole:.1f} - {1e3 * read:.1f})")
    print(f"ratio whirl / zgeev: {mine / alone:.2f}, with vectors {mine / both:.2f}")
    return 0 if worst < 1e-6 else 1


if __name__ == "__main__":
    sys.exit(main())
