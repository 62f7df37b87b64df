"""Poles and thresholds by SciPy, from the equations of motion as physics.md writes them, in real form: no code is shared.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy
    /tmp/venv/bin/python tests/reference/poles.py > tests/reference/poles.json
    /tmp/venv/bin/python tests/reference/poles.py --time      # zgeev on the benchmark's matrices

The JSON is what `crates/rotor/tests/val_poles.rs` compares with.
"""

import json
import sys
import timeit

import numpy as np
import scipy.linalg

# A chain that is not the report's: five unequal masses, every parameter different, three sensors with gains of their own,
# one of them scheduled, the bearing at mass 2.
CHAIN = {
    "mass": [0.31, 0.18, 0.27, 0.09, 0.15],
    "damping": [0.22, 0.05, 0.13, 0.0, 0.31],
    "cross_damping": [0.04, 0.01, 0.0, 0.02, 0.07],
    "bearing_stiffness": [0.40, 0.0, 0.15, 0.0, 0.35],
    "seal_stiffness": [0.05, 0.02, 0.0, 0.01, 0.02],
    "shaft": [0.50, 0.35, 0.62, 0.27],
    "bearing": 2,
    # sensor (counted from 1): kd, cd, kc, cc; a gain is a number or [value at zero, slope over speed]
    "sensors": {"1": [0.31, 0.62, [0.05, -0.11], 0.03], "3": [-0.12, 0.44, 0.21, -0.02], "5": [0.08, -0.17, 0.10, 0.06]},
}
SPEEDS = [0.0, 0.6, 1.7, 3.1, 4.4, 6.0]

THREE_MASS = {
    "mass": [0.25, 0.5, 0.25],
    "damping": [0.25, 0.0, 0.25],
    "cross_damping": [0.05, 0.0, 0.05],
    "bearing_stiffness": [0.5, 0.0, 0.5],
    "seal_stiffness": [0.0, 0.0, 0.0],
    "shaft": [0.5, 0.5],
    "bearing": 1,
    "sensors": {str(k): [-0.5879, 0.4948, -0.4847, 0.6483] for k in (1, 2)},
}


def at(gain, speed):
    return gain if np.isscalar(gain) else gain[0] + gain[1] * speed


def real_matrix(rotor, speed):
    """State [y.., z.., y'.., z'..], one equation after the other."""
    n = len(rotor["mass"])
    a = np.zeros((4 * n, 4 * n))
    a[: 2 * n, 2 * n :] = np.eye(2 * n)
    stiff = np.zeros((n, n))
    for i, k in enumerate(rotor["shaft"]):
        stiff[i, i] += k
        stiff[i + 1, i + 1] += k
        stiff[i, i + 1] -= k
        stiff[i + 1, i] -= k
    for i in range(n):
        stiff[i, i] += rotor["bearing_stiffness"][i] + rotor["seal_stiffness"][i]
    for i in range(n):
        m, zeta, zq = rotor["mass"][i], rotor["damping"][i], rotor["cross_damping"][i]
        y, z = 2 * n + i, 3 * n + i
        a[y, :n] -= stiff[i] / m
        a[z, n : 2 * n] -= stiff[i] / m
        a[y, 2 * n + i] -= 2 * zeta
        a[z, 3 * n + i] -= 2 * zeta
        a[y, 3 * n + i] -= 2 * zq
        a[z, 2 * n + i] += 2 * zq
        a[y, n + i] -= zeta * speed
        a[z, i] += zeta * speed
    y, z = 2 * n + rotor["bearing"] - 1, 3 * n + rotor["bearing"] - 1
    for sensor, gains in rotor["sensors"].items():
        k = int(sensor) - 1
        kd, cd, kc, cc = (at(g, speed) for g in gains)
        # -(kd - j kc)(y + j z) = -(kd y + kc z) - j (kd z - kc y)
        a[y, k] -= kd
        a[y, n + k] -= kc
        a[z, n + k] -= kd
        a[z, k] += kc
        a[y, 2 * n + k] -= cd
        a[y, 3 * n + k] -= cc
        a[z, 3 * n + k] -= cd
        a[z, 2 * n + k] += cc
    return a


def complex_matrix(rotor, speed):
    """The same for p = y + j z: a block [[a, -b], [b, a]] on (y, z) is multiplication by a + j b."""
    n = len(rotor["mass"])
    a = real_matrix(rotor, speed)
    block = lambda rows, columns: a[rows : rows + n, columns : columns + n]
    c = np.zeros((2 * n, 2 * n), complex)
    for i, rows in enumerate((0, 2 * n)):
        for k, columns in enumerate((0, 2 * n)):
            c[i * n : (i + 1) * n, k * n : (k + 1) * n] = block(rows, columns) + 1j * block(rows + n, columns)
    return c


def thresholds(rotor, top):
    """Sign changes of the count of growing modes on a fine grid, refined by bisection."""
    growing = lambda speed: int((scipy.linalg.eigvals(complex_matrix(rotor, speed)).real > 0).sum())
    grid = np.linspace(0.0, top, 4001)
    counts = [growing(r) for r in grid]
    found = []
    for low, high, before, after in zip(grid, grid[1:], counts, counts[1:]):
        if before == after:
            continue
        assert abs(before - after) == 1, "two thresholds in one cell of the grid"
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if growing(middle) == before else (low, middle)
        poles = scipy.linalg.eigvals(complex_matrix(rotor, low))
        pole = poles[np.argmin(abs(poles.real))]
        found.append({"speed": low, "im": pole.imag, "becomes": "unstable" if after > before else "stable"})
    return found


def reference():
    poles = []
    for speed in SPEEDS:
        both = scipy.linalg.eigvals(real_matrix(CHAIN, speed))
        c = scipy.linalg.eigvals(complex_matrix(CHAIN, speed))
        # The two forms agree: the real one has the complex one's poles and their conjugates.
        assert max(min(abs(both - p)) for p in np.concatenate([c, c.conj()])) < 1e-11
        poles.append({"speed": speed, "poles": [[p.real, p.imag] for p in sorted(c, key=lambda p: p.imag)]})
    return {"chain": CHAIN, "poles": poles, "thresholds": thresholds(CHAIN, 12.0), "to": 12.0}


def timing():
    matrices = [complex_matrix(THREE_MASS, 0.1 * i) for i in range(64)]
    zgeev = scipy.linalg.get_lapack_funcs("geev", (matrices[0],))
    once = lambda: [zgeev(a, compute_vl=0, compute_vr=0) for a in matrices]
    checked = lambda: [scipy.linalg.eigvals(a) for a in matrices]
    for name, work in (("zgeev, straight", once), ("scipy.linalg.eigvals", checked)):
        best = min(timeit.repeat(work, number=20, repeat=7)) / 20 / 64
        print(f"{name}: {best * 1e6:.2f} us for 6 x 6 complex, eigenvalues only")


if __name__ == "__main__":
    if "--time" in sys.argv:
        timing()
    else:
        json.dump(reference(), sys.stdout, indent=1)
        print()
