"""How long SciPy's Powell takes to what `whirl tune` finds, on the same objective, in one run on one machine.

    /tmp/venv/bin/python tests/reference/tune_beside_scipy.py target/release/whirl

SciPy starts anew from random gains until it has whirl's value within 1 % or has had `PATIENCE` times whirl's time; its
objective is one `numpy.linalg.eigvals` over all speeds at once, as fast as NumPy can. Whirl runs on one thread, its time
is its own (`seconds`) and, beside it, that of the whole process.
"""

import json
import os
import subprocess
import sys
import time

import numpy as np
import scipy.optimize

from poles import THREE_MASS, complex_matrix

PATIENCE = 100.0
OFF = {**THREE_MASS, "sensors": {}}


def objective(speeds):
    """The least damping over the speeds, negative, for the gains of the report's structure."""
    open_loop = np.array([complex_matrix(OFF, speed) for speed in speeds])

    def negative(gains):
        kd, cd, kc, cc = gains
        closed = open_loop.copy()
        closed[:, 3, 0:2] -= kd - 1j * kc
        closed[:, 3, 3:5] -= cd - 1j * cc
        poles = np.linalg.eigvals(closed)
        return -float(np.min(-poles.real / abs(poles)))

    return negative


def compare(whirl, name, options, speeds):
    begun = time.perf_counter()
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    command = [whirl, "tune", "three-mass", *options, "--signal", "composite", "--sensors", "1,2", "--json"]
    found = json.loads(subprocess.run(command, capture_output=True, check=True, env=environment).stdout)
    process = time.perf_counter() - begun
    target, ours = found["min_damping"], found["seconds"]
    negative, random = objective(speeds), np.random.default_rng(1)
    best, starts, begun = -np.inf, 0, time.perf_counter()
    while best < target - 0.01 * abs(target) and time.perf_counter() - begun < PATIENCE * ours:
        result = scipy.optimize.minimize(negative, random.uniform(-1, 1, 4), method="Powell")
        best, starts = max(best, -result.fun), starts + 1
    theirs = time.perf_counter() - begun
    reached = "reached it" if best >= target - 0.01 * abs(target) else "did not reach it"
    print(
        f"{name}: whirl {target:.6f} in {ours:.3f} s ({process:.3f} s with its process); SciPy {best:.6f} after {starts} starts "
        f"in {theirs:.1f} s, {reached}: ratio {'' if reached == 'reached it' else 'above '}{theirs / ours:.0f}"
    )


if __name__ == "__main__":
    compare(sys.argv[1], "one speed, R = 6", ["--speed", "6"], [6.0])
    compare(sys.argv[1], "a range, 0..5", ["--over", "0..5"], np.linspace(0.0, 5.0, 51))
