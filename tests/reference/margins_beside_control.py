"""Margins beside python-control: the same crossings, and how long each takes.

    just check-margins

python-control knows loops with real coefficients alone. A rotor at rest without cross-coupled damping, under feedback without
cross-coupled gains, is one: both real axes are alike, and each is the complex loop. Its gain is put together here from the equations
of motion, with an actuator lag beside the gains, and handed to `control.stability_margins`. Exits with 1 if a crossing differs by more
than 1e-8, relative.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import control
import numpy as np
import scipy.optimize

WHIRL = sys.argv[1] if len(sys.argv) > 1 else "target/release/whirl"
MASS, DAMPING, BEARING, SHAFT = [0.25, 0.5, 0.25], [0.25, 0.05, 0.25], [0.5, 0.0, 0.5], [0.5, 0.5]
GAINS = [(1.5, 0.9), (0.4, 1.2)]
LAG = 0.1
SPEEDS = 400


def rotor_file():
    text = 'name = "without cross-coupling"\n'
    for m, c, k in zip(MASS, DAMPING, BEARING):
        text += f"[[mass]]\nmass = {m}\ndamping = {c}\nbearing_stiffness = {k}\nunbalance = 0.5\n"
    return text + "".join(f"[[shaft]]\nstiffness = {k}\n" for k in SHAFT)


def feedback_file():
    text = "bearing = 1\n"
    for mass, (kd, cd) in enumerate(GAINS, 1):
        text += f"[[signal]]\nmass = {mass}\nkd = {kd}\ncd = {cd}\nkc = 0.0\ncc = 0.0\n"
    return text


def loop():
    """u = -L u of one real axis: gains on displacement and velocity through the lag."""
    n = len(MASS)
    stiffness = np.diag(BEARING) + 0.0
    for i, k in enumerate(SHAFT):
        stiffness[i : i + 2, i : i + 2] += k * np.array([[1, -1], [-1, 1]])
    a = np.zeros((2 * n + 1, 2 * n + 1))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, :n] = -stiffness / np.array(MASS)[:, None]
    a[n : 2 * n, n : 2 * n] = np.diag([-2 * c for c in DAMPING])
    a[n, 2 * n] = 1.0
    a[2 * n, 2 * n] = -1.0 / LAG
    b = np.zeros((2 * n + 1, 1))
    b[2 * n, 0] = 1.0 / LAG
    c = np.zeros((1, 2 * n + 1))
    for mass, (kd, cd) in enumerate(GAINS):
        c[0, mass], c[0, n + mass] = kd, cd
    return control.ss(a, b, c, [[0.0]])


def ours(*arguments):
    return json.loads(subprocess.run([WHIRL, "margin", *arguments, "--json"], check=True, capture_output=True).stdout)


def main():
    folder = Path(tempfile.mkdtemp())
    (folder / "rotor.toml").write_text(rotor_file())
    (folder / "feedback.toml").write_text(feedback_file())
    machine = [str(folder / "rotor.toml"), "--feedback", str(folder / "feedback.toml"), "--set", f"lag={LAG}"]
    found = ours(*machine, "--speed", "0")
    system = loop()
    gains, phases, _, gain_at, phase_at, _ = control.stability_margins(system, returnall=True)
    worst = 0.0

    def compare(what, mine, theirs):
        nonlocal worst
        apart = abs(mine - theirs) / max(abs(theirs), 1e-12)
        worst = max(worst, apart)
        print(f"{what:32} {mine:.12g} {theirs:.12g} {apart:.1e}")

    nearest = int(np.argmin(np.abs(phases)))
    compare("phase margin, degrees", found["phase"]["degrees"], abs(phases[nearest]))
    compare("its frequency", abs(found["phase"]["frequency"]), phase_at[nearest])
    delays = [(np.radians(p % 360.0) / w, w) for p, w in zip(phases, phase_at)]
    delay, at = min(delays)
    compare("delay margin", found["delay"]["tau"], delay)
    compare("its frequency", abs(found["delay"]["frequency"]), at)
    # What crosses at a hundred million radians is rounding.
    up = [(g, w) for g, w in zip(gains, gain_at) if 1.0 < g < 1e9]
    if up and found["gain"]["up"]:
        factor, at = min(up)
        compare("gain margin", found["gain"]["up"]["factor"], factor)
        compare("its frequency", abs(found["gain"]["up"]["frequency"]), at)
    else:
        print("gain margin: none in either" if not up and not found["gain"]["up"] else f"gain margin in one alone: {found['gain']} {up}")
        worst = max(worst, 0.0 if not up and not found["gain"]["up"] else 1.0)
    # Peak of the sensitivity: the largest of 1 / |1 + L| by their frequency response, from a grid and then between its points.
    size = lambda w: -1.0 / abs(1.0 + system(1j * w))
    grid = np.geomspace(1e-2, 1e2, 2000)
    best = int(np.argmin([size(w) for w in grid]))
    bounds = (grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)])
    peak = scipy.optimize.minimize_scalar(size, bounds=bounds, method="bounded", options={"xatol": 1e-12})
    compare("peak of |S|", found["sensitivity"]["peak"], -peak.fun)

    begin = time.perf_counter()
    for _ in range(20):
        control.stability_margins(system)
    theirs = (time.perf_counter() - begin) / 20
    times = []
    for points in (2, SPEEDS):
        begin = time.perf_counter()
        ours(*machine, "--over", "0..0.001", "--points", str(points))
        times.append(time.perf_counter() - begin)
    mine = (times[1] - times[0]) / (SPEEDS - 2)
    print(f"one set of margins: ours {1e3 * mine:.3f} ms (with peaks of S, T and force), control {1e3 * theirs:.3f} ms (crossings alone)")
    print(f"ratio control / ours {theirs / mine:.2f}")
    return 0 if worst < 1e-8 else 1


if __name__ == "__main__":
    sys.exit(main())
