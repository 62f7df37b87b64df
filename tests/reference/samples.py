"""Machines drawn at random by NumPy: the same draws, and the damping of each by LAPACK's eigenvalues.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy
    /tmp/venv/bin/python tests/reference/samples.py > tests/reference/samples.json

The JSON is what `crates/variation/tests/val_samples.rs` compares with. Sample i has the numbers that NumPy's `Philox` of the key `seed`
gives from the counter [0, i, 0, 0] on; it counts before it draws, so it is set to one less.
"""

import json

import numpy as np
import scipy.stats

from poles import THREE_MASS, complex_matrix

SEED, COUNT, SPEED = 7, 4000, 6.0
INDIVIDUAL = {"1": [4, 3.1168, 3.1241, 0.9175], "2": [-2.3419, 4, -3.7635, 4]}
# mass 1, damping 1, shaft 2: as `--vary mass.1=0.2..0.3 --vary damping.1=0.1..1.2 --vary shaft.2=0.2..0.8`.
RANGES = [("mass", 0, 0.2, 0.3), ("damping", 0, 0.1, 1.2), ("shaft", 1, 0.2, 0.8)]


def generator(index):
    counter = ((index << 64) - 1) % (1 << 256)
    words = [(counter >> (64 * k)) & (2**64 - 1) for k in range(4)]
    return np.random.Generator(np.random.Philox(key=SEED, counter=np.array(words, dtype=np.uint64)))


def normal(index):
    draws = generator(index).random(400)
    made = []
    for u, v in draws.reshape(-1, 2):
        x = np.sqrt(-2 * np.log1p(-u)) * np.cos(2 * np.pi * v)
        if abs(x) <= 3:
            made.append(0.5 + x / 6)
        if len(made) == len(RANGES):
            return made


def damping(parts):
    rotor = json.loads(json.dumps(THREE_MASS))
    for (name, at, low, high), part in zip(RANGES, parts):
        rotor[name][at] = low * (1 - part) + high * part
    poles = np.linalg.eigvals(complex_matrix({**rotor, "sensors": INDIVIDUAL}, SPEED))
    return float(np.min(-poles.real / abs(poles)))


def told(parts_of):
    values = [damping(parts_of(i)) for i in range(COUNT)]
    stable = int(sum(v > 0 for v in values))
    interval = scipy.stats.binomtest(stable, COUNT).proportion_ci(method="wilson")
    return {
        "first": values[:40],
        "stable": stable,
        "interval": [interval.low, interval.high],
        "quantiles": {q: float(np.quantile(values, float(q))) for q in ("0.01", "0.05", "0.5", "0.95")},
    }


print(json.dumps({
    "seed": SEED,
    "count": COUNT,
    "draws": [generator(i).random(9).tolist() for i in (0, 1, 123456789)],
    "uniform": told(lambda i: generator(i).random(len(RANGES))),
    "normal": told(normal),
}, indent=1))
