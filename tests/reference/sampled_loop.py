#!/usr/bin/env python3
"""Poles of sampled loops with a delay, by SciPy's cont2discrete, for crates/machine/tests/val_scipy.rs.

Run: python3 tests/reference/sampled_loop.py > crates/machine/tests/sampled_loop.json   (NumPy and SciPy)

The report's three-mass rotor under its composite gains, written down anew here: nothing is taken from the program. The
delay is split exactly: over the first part of a period the older command still acts.
"""
import json

import numpy as np
from scipy.signal import cont2discrete

RM, ZETA, ZETA_Q = [0.25, 0.5, 0.25], [0.25, 0.0, 0.25], [0.05, 0.0, 0.05]
RB, RF = [0.5, 0.0, 0.5], [0.5, 0.5]
GAINS = dict(kd=-0.5879, cd=0.4948, kc=-0.4847, cc=0.6483)
WEIGHTS = [1.0, 1.0, 0.0]


def plant(speed):
    a = np.zeros((6, 6), complex)
    a[:3, 3:] = np.eye(3)
    for i in range(3):
        a[3 + i, 3 + i] = -2 * ZETA[i] + 2j * ZETA_Q[i]
        own = 1j * ZETA[i] * speed - RB[i] / RM[i]
        for k, shaft in ((i - 1, i - 1), (i + 1, i)):
            if 0 <= k < 3:
                own -= RF[shaft] / RM[i]
                a[3 + i, k] += RF[shaft] / RM[i]
        a[3 + i, i] += own
    b = np.zeros((6, 1), complex)
    b[3, 0] = 1
    on_p, on_v = GAINS["kd"] - 1j * GAINS["kc"], GAINS["cd"] - 1j * GAINS["cc"]
    row = -np.array([[on_p * w for w in WEIGHTS] + [on_v * w for w in WEIGHTS]])
    return a, b, row


def held(a, b, t):
    n = a.shape[0]
    if t == 0:
        return np.eye(n), np.zeros((n, 1))
    # cont2discrete is of real matrices: the complex system as one of twice the size.
    real = lambda m: np.block([[m.real, -m.imag], [m.imag, m.real]])
    ad, bd, *_ = cont2discrete((real(a), real(b), np.zeros((1, 2 * n)), np.zeros((1, 2))), t, method="zoh")
    back = lambda m, rows, columns: m[:rows, :columns] + 1j * m[rows:, :columns]
    return back(ad, n, n), back(bd, n, 1)


def step(speed, period, delay):
    a, b, row = plant(speed)
    whole = int(np.floor(delay / period + 1e-9))
    rest = max(delay - whole * period, 0.0)
    rest = 0.0 if rest < 1e-12 else rest
    free, newer = held(a, b, period - rest)
    before, older = held(a, b, rest)
    memory = whole + (1 if rest > 0 else 0)
    size = 6 + memory
    z = np.zeros((size, size), complex)
    z[:6, :6] = free @ before
    command = np.zeros((1, size), complex)
    command[0, :6] = row
    for age, effect in ((whole, newer), (whole + 1, free @ older)):
        if age == whole + 1 and rest == 0:
            continue
        if age == 0:
            z[:6, :] += effect @ command
        else:
            z[:6, 6 + age - 1] += effect[:, 0]
    if memory:
        z[6, :] = command
        for k in range(1, memory):
            z[6 + k, 6 + k - 1] = 1
    return z


cases = []
for speed in (2.5, 6.0):
    for period, delay in ((0.05, 0.0), (0.05, 0.02), (0.05, 0.05), (0.02, 0.07), (0.1, 0.13)):
        z = np.linalg.eigvals(step(speed, period, delay))
        z = z[np.argsort(-abs(z))][:6]
        cases.append(dict(speed=speed, sample=period, delay=delay, z=[[v.real, v.imag] for v in z]))
print(json.dumps(cases, indent=1))
