"""The H2 cost of unbalance and noise by SciPy: poles.py's equations of motion, SciPy's solver of Lyapunov's equation, SciPy's minimum.

    /tmp/venv/bin/python tests/reference/cost.py > tests/reference/cost.json

Here noise has a state of its own for every reading of every sensor, with that of each component independent, in real form; the product
lumps all of them into one. Also the least cost that Nelder and Mead's method finds from many random gains, over a row of speeds.
`crates/tuner/tests/val_cost.rs` compares.
"""

import copy
import json
import sys

import numpy as np
import scipy.linalg
import scipy.optimize

from poles import THREE_MASS, real_matrix

UNBALANCE = [0.0, 1.0, 0.0]
FORCE, NOISE, CORNER = 0.1, 0.05, 8.0


def rotor_with(gains):
    """Four gains are of the sum of sensors 1 and 2, eight are of each."""
    rotor = copy.deepcopy(THREE_MASS)
    rotor["sensors"] = {"1": list(gains[:4]), "2": list(gains[-4:])}
    return rotor


def cost(gains, speed, force=FORCE, noise=NOISE, corner=CORNER):
    """J^2, infinite where the machine is not stable."""
    rotor = rotor_with(gains)
    n = 3
    plant = real_matrix(rotor, speed)
    if np.linalg.eigvals(plant).real.max() >= 0:
        return np.inf
    bare = copy.deepcopy(rotor)
    bare["sensors"] = {}
    # What a reading of (y, z, y', z') of every mass makes of the force: rows of the bearing's mass.
    law = (plant - real_matrix(bare, speed))[[2 * n, 3 * n]]
    # Synchronous whirl, y = Re, z = Im of p e^{jR tau}: the unbalance pushes with cos in y and sin in z.
    push = np.zeros(4 * n, complex)
    for i, radius in enumerate(UNBALANCE):
        push[2 * n + i] = radius * speed**2
        push[3 * n + i] = -1j * radius * speed**2
    whirl = np.linalg.solve(1j * speed * np.eye(4 * n) - plant, push)
    # The mean square of Re(x e^{jR tau}) is half of |x|^2.
    steady = 0.5 * np.sum(abs(whirl[: 2 * n]) ** 2) + 0.5 * force**2 * np.sum(abs(law @ whirl) ** 2)
    a = np.block([[plant, np.zeros((4 * n, 4 * n))], [np.zeros((4 * n, 4 * n)), -corner * np.eye(4 * n)]])
    a[[2 * n, 3 * n], 4 * n :] = law
    drive = np.zeros((8 * n, 4 * n))
    drive[4 * n :] = np.sqrt(2 * corner) * noise * np.eye(4 * n)
    variance = scipy.linalg.solve_continuous_lyapunov(a, -drive @ drive.T)
    out = np.zeros((2 * n + 2, 8 * n))
    out[: 2 * n, : 2 * n] = np.eye(2 * n)
    out[2 * n :] = force * np.hstack([law, law])
    return float(steady + np.trace(out @ variance @ out.T))


def least(speeds, size, starts, seed):
    random = np.random.default_rng(seed)
    worst = lambda gains: max(cost(gains, speed) for speed in speeds)
    best, at = np.inf, None
    while starts:
        first = random.uniform(-1, 1, size)
        if not np.isfinite(worst(first)):
            continue
        starts -= 1
        found = first
        for _ in range(4):
            step = scipy.optimize.minimize(worst, found, method="Nelder-Mead", options={"maxiter": 2000, "xatol": 1e-7, "fatol": 1e-9, "adaptive": True})
            found = step.x
        if step.fun < best:
            best, at = float(step.fun), [float(x) for x in step.x]
    return {"speeds": speeds, "cost": best, "gains": at}


if __name__ == "__main__":
    points = []
    for gains in ([-0.5879, 0.4948, -0.4847, 0.6483], [0.2, 0.9, 0.1, 0.1], [-0.3, 0.7, -0.4, 0.2, 0.1, 0.4, -0.5, 0.3]):
        for speed in (0.0, 0.7, 1.3, 2.5, 4.0):
            value = cost(gains, speed)
            if np.isfinite(value):
                points.append({"gains": gains, "speed": speed, "cost": value})
    searched = [least([2.5], 4, 12, 1), least([4.0], 4, 12, 2)]
    json.dump({"force": FORCE, "noise": NOISE, "corner": CORNER, "points": points, "searched": searched}, sys.stdout, indent=1)
    print()
