#!/usr/bin/env python3
"""One mass turned by a given torque, by SciPy's DOP853, for crates/machine/tests/val_drive.rs.

Run: python3 tests/reference/drive.py > crates/machine/tests/drive.json   (NumPy and SciPy)

    p'' = -2 zeta p' + j zeta R p - k p + e (R^2 - j R') exp(j theta),   theta' = R
    J R' = T - c R - m e Im(exp(-j theta) a),   a what p'' is without the unbalance

written as the two linear equations for p'' and R' that Lagrange's give, solved at every evaluation: the substitution that the program
makes is not made here. Dimensionless, m = 1, e = 1, k = 1. One torque sticks below the critical speed, one passes it.
"""
import json

import numpy as np
from scipy.integrate import solve_ivp

ZETA, INERTIA, DRAG = 0.02, 2000.0, 0.5


def slopes(torque):
    def of(_, x):
        p, v, theta, speed = x[0] + 1j * x[1], x[2] + 1j * x[3], x[4], x[5]
        turn = np.exp(1j * theta)
        pushed = -2 * ZETA * v + 1j * ZETA * speed * p - p
        # p'' + j e R' turn = pushed + e R^2 turn;   (J + m e^2) R' + m e Im(conj(turn) p'') = T - c R; in real numbers.
        a = np.array(
            [
                [1.0, 0.0, (1j * turn).real],
                [0.0, 1.0, (1j * turn).imag],
                [-turn.imag, turn.real, INERTIA + 1.0],
            ]
        )
        right = pushed + speed**2 * turn
        y, z, rate = np.linalg.solve(a, [right.real, right.imag, torque - DRAG * speed])
        return [v.real, v.imag, y, z, speed, rate]

    return of


def main():
    cases = []
    for torque, duration in ((5.0, 900.0), (60.0, 120.0)):
        taus = np.linspace(0.0, duration, 31)[1:]
        found = solve_ivp(slopes(torque), (0.0, duration), np.zeros(6), "DOP853", taus, rtol=1e-12, atol=1e-12)
        cases.append({"torque": torque, "duration": duration, "tau": taus.tolist(), "states": found.y.T.tolist()})
    print(json.dumps({"zeta": ZETA, "inertia": INERTIA, "drag": DRAG, "cases": cases}))


main()
