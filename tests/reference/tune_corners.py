"""What a global optimiser of SciPy makes of gains and corners of filters together: differential evolution, then Nelder and Mead.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy
    /tmp/venv/bin/python tests/reference/tune_corners.py > tests/reference/tune_corners.json     # some minutes

three-mass at one speed; both end sensors 1 and 2 summed to one signal with four gains, a lead behind them, a low-pass behind the sum.
Poles are NumPy's eigenvalues of matrices written down here: equations of motion of poles.py, filters as the difference of a direct
path and a lag, and as Butterworth's second order in companion form. `crates/tuner/tests/val_corners.rs` judges SciPy's best anew and
has a search of its own, which must not end below it.
"""

import copy
import json
import sys

import numpy as np
from scipy.optimize import differential_evolution, minimize

from poles import THREE_MASS, complex_matrix

# Speed, range of zero and pole of the lead, range of the corner of the low-pass.
CASES = [(4.0, (1.5, 24.0), (2.25, 36.0), (5.0, 60.0)), (6.0, (1.5, 24.0), (2.25, 36.0), (12.0, 120.0))]
BOUND = 5.0


def open_matrix(speed):
    rotor = copy.deepcopy(THREE_MASS)
    rotor["sensors"] = {}
    return complex_matrix(rotor, speed)


def poles(free, speed, gains, zero, pole, corner):
    """States: displacements and velocities, the lead's lag, the low-pass and its rate."""
    n = 3
    kd, cd, kc, cc = gains
    a = np.zeros((2 * n + 3, 2 * n + 3), complex)
    a[: 2 * n, : 2 * n] = free
    signal = np.zeros(2 * n + 3, complex)
    signal[[0, 1]] = -(kd - 1j * kc)
    signal[[n, n + 1]] = -(cd - 1j * cc)
    lag, low, rate = 2 * n, 2 * n + 1, 2 * n + 2
    # (1 + s / zero) / (1 + s / pole) = pole / zero + (1 - pole / zero) / (1 + s / pole)
    a[lag] = pole * signal
    a[lag, lag] -= pole
    out = pole / zero * signal
    out[lag] += 1 - pole / zero
    a[low, rate] = 1
    a[rate] = corner**2 * out
    a[rate, low] -= corner**2
    a[rate, rate] -= np.sqrt(2.0) * corner
    a[n, low] += 1
    return np.linalg.eigvals(a)


def case(speed, *ranges):
    free = open_matrix(speed)

    def damping(x):
        found = poles(free, speed, x[:4], *np.exp(x[4:]))
        return float(min(-found.real / abs(found)))

    bounds = [(-BOUND, BOUND)] * 4 + [tuple(np.log(ends)) for ends in ranges]
    best = None
    for seed in range(4):
        rough = differential_evolution(
            lambda x: -damping(x), bounds, seed=seed, popsize=20, maxiter=1500, tol=1e-10, polish=False
        )
        x = rough.x
        for _ in range(6):
            fine = minimize(
                lambda x: -damping(x), x, method="Nelder-Mead", bounds=bounds,
                options={"xatol": 1e-10, "fatol": 1e-13, "maxiter": 20000, "maxfev": 20000, "adaptive": True},
            )
            x = fine.x
        print(f"R = {speed}, seed {seed}: {-rough.fun:.9f} {damping(x):.9f}", file=sys.stderr)
        if best is None or damping(x) > damping(best):
            best = x
    low, high = np.array(bounds).T
    best = np.clip(best, low, high)
    return {
        "speed": speed, "bound": BOUND, "ranges": ranges, "gains": list(best[:4]), "corners": list(np.exp(best[4:])),
        "damping": damping(best),
    }


if __name__ == "__main__":
    json.dump([case(*each) for each in CASES], sys.stdout, indent=1)
    print()
