"""Peaks of the sensitivity by SciPy: a grid of 400 000 frequencies of both signs, closer where the loop resonates, and the highest
of its maxima made exact by a bounded search. No Hamiltonian matrix and no bound: what is compared is the number.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy
    /tmp/venv/bin/python tests/reference/sensitivity_peak.py > tests/reference/sensitivity_peak.json

`crates/linear/tests/val_peak.rs` compares with it. The first loops are those of delay.py; of the last ones two control bearings are
closed, and the peak is that of the largest singular value.
"""

import json

import numpy as np
import scipy.optimize

from delay import COMPOSITE, INDIVIDUAL, both, composite
from poles import THREE_MASS


def sensitivity(a, b, c, delay, w):
    """The largest singular value of S = (I - H)^-1 over an array of frequencies."""
    w = np.atleast_1d(w)
    n, m = b.shape
    inner = np.linalg.solve(1j * w[:, None, None] * np.eye(n) - a, np.broadcast_to(b, (len(w), n, m)))
    h = (c @ inner) * np.exp(-1j * w * delay)[:, None, None]
    return np.linalg.norm(np.linalg.inv(np.eye(m) - h), 2, axis=(1, 2))


def peak(a, b, c, delay):
    far = 20 * max(abs(np.linalg.eigvals(a + b @ c)))
    near = np.concatenate([p.imag + abs(p.real) * np.tan(np.linspace(-1.5, 1.5, 4001)) for p in np.linalg.eigvals(a + b @ c)])
    grid = np.sort(np.concatenate([np.linspace(-far, far, 400_001), near]))
    size = np.concatenate([sensitivity(a, b, c, delay, part) for part in np.array_split(grid, 40)])
    tops = [k for k in range(1, len(grid) - 1) if size[k] >= size[k - 1] and size[k] > size[k + 1]]
    best = (1.0, None)
    for k in sorted(tops, key=lambda k: -size[k])[:4]:
        found = scipy.optimize.minimize_scalar(
            lambda w: -sensitivity(a, b, c, delay, w)[0], bounds=(grid[k - 1], grid[k + 1]), method="bounded", options={"xatol": 1e-13}
        )
        best = max(best, (float(-found.fun), float(found.x)))
    return best


def case(name, a, b, c, delay):
    amplitude, frequency = peak(a, b, c, delay)
    split = lambda m: [[[float(z.real), float(z.imag)] for z in row] for row in np.asarray(m, complex)]
    return {"name": name, "a": split(a), "b": split(b), "c": split(c), "delay": delay, "peak": amplitude, "frequency": frequency}


def main():
    cases = []
    for name, sensors in [("composite", composite(COMPOSITE)), ("individual", INDIVIDUAL)]:
        for speed in [0.0, 2.5, 6.0]:
            for delay in [0.0, 0.02, 0.1]:
                a, through = both(THREE_MASS, sensors, speed)
                bearing = np.flatnonzero(abs(through).sum(axis=1))[0]
                b = np.zeros((6, 1))
                b[bearing] = 1
                cases.append(case(f"{name} {speed} {delay}", a, b, through[[bearing]], delay))
    # Bearings at both ends, each with gains of its own on the sensors beside it.
    for speed in [2.5, 6.0]:
        for delay in [0.0, 0.05]:
            a, first = both(THREE_MASS, INDIVIDUAL, speed)
            bearing = np.flatnonzero(abs(first).sum(axis=1))[0]
            last = bearing + 2
            b = np.zeros((6, 2))
            b[bearing, 0] = b[last, 1] = 1
            turned = np.zeros(6, complex)
            for k in range(3):
                # As a mirror image, and weaker.
                turned[k], turned[3 + k] = 0.4 * first[bearing, 2 - k], 0.4 * first[bearing, 5 - k]
            cases.append(case(f"two bearings {speed} {delay}", a, b, np.vstack([first[bearing], turned]), delay))
    # Hardly damped: a needle that a grid would miss.
    a = np.array([[0, 1, 0, 0], [-1, -2e-5, 0, 0], [0, 0, 0, 1], [1, 0, -9, -1e-4]], complex)
    cases.append(case("needles", a, np.array([[0], [1], [0], [0.5]]), np.array([[-0.02, -0.01j, 0.01j, -0.03]]), 0.0))
    print(json.dumps(cases, indent=0))


if __name__ == "__main__":
    main()
