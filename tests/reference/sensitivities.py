"""Slopes of the smallest damping ratio, in 50 digits: differences of eigenvalues that are computed with mpmath.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install mpmath
    /tmp/venv/bin/python tests/reference/sensitivities.py > tests/reference/sensitivities.json

The JSON is what `crates/variation/tests/val_sensitivities.rs` compares with. Nothing is differentiated by hand here: a pole is a root of
the determinant of the equations of motion, whatever is in the loop, and its slope a central difference over 1e-20, good to 30 digits.
A part that is off has its slope from above, over 1e-25.
"""

import json

from mpmath import det, exp, findroot, matrix, mp, mpc, mpf, fabs, re

mp.dps = 50

GAINS = {"kd": 0, "cd": 1, "kc": 2, "cc": 3}
ROTOR = {
    **{f"mass.{k}": m for k, m in ((1, "0.25"), (2, "0.5"), (3, "0.25"))},
    **{f"damping.{k}": m for k, m in ((1, "0.25"), (2, "0"), (3, "0.25"))},
    **{f"cross_damping.{k}": m for k, m in ((1, "0.05"), (2, "0"), (3, "0.05"))},
    **{f"bearing_stiffness.{k}": m for k, m in ((1, "0.5"), (2, "0"), (3, "0.5"))},
    **{f"seal_stiffness.{k}": "0" for k in (1, 2, 3)},
    **{f"shaft.{k}": "0.5" for k in (1, 2)},
    **{f"factor.{k}": "1" for k in (1, 3)},
    "gain": "1", "delay": "0", "lag": "0", "sensor_lag": "0",
}


def feedback(values):
    """kd.1 .. cc.N in the order of the signals."""
    return {f"{name}.{k + 1}": v for k, gains in enumerate(values) for name, v in zip(GAINS, gains)}


CASES = {
    "individual": (feedback([["4", "3.1168", "3.1241", "0.9175"], ["-2.3419", "4", "-3.7635", "4"]]), [[1, 0, 0], [0, 1, 0]], {}),
    "composite": (feedback([["-0.5879", "0.4948", "-0.4847", "0.6483"]]), [[1, 1, 0]], {}),
    "late": (feedback([["-0.5879", "0.4948", "-0.4847", "0.6483"]]), [[1, 1, 0]], {"delay": "0.02", "lag": "0.03"}),
}


def equations(p, sensed, s):
    """M(s) of M(s) p = 0 for the displacements of the three masses."""
    j, speed = mpc(0, 1), p["speed"]
    m = matrix(3, 3)
    for i in range(3):
        k = i + 1
        own = p[f"bearing_stiffness.{k}"] * p.get(f"factor.{k}", mpf(1)) + p[f"seal_stiffness.{k}"]
        before = p["shaft.1"] if i == 1 else p["shaft.2"] if i == 2 else mpf(0)
        after = p["shaft.1"] if i == 0 else p["shaft.2"] if i == 1 else mpf(0)
        mass, zeta = p[f"mass.{k}"], p[f"damping.{k}"]
        m[i, i] = s * s + 2 * zeta * s - 2 * j * p[f"cross_damping.{k}"] * s - j * zeta * speed + (own + before + after) / mass
        if i > 0:
            m[i, i - 1] = -before / mass
        if i < 2:
            m[i, i + 1] = -after / mass
    # The lags of sensors and actuator, and the delay, between what is read and the force.
    late = p["gain"] * exp(-s * p["delay"]) / ((1 + s * p["lag"]) * (1 + s * p["sensor_lag"]))
    for k, weights in enumerate(sensed):
        kd, cd, kc, cc = (p[f"{name}.{k + 1}"] for name in GAINS)
        for i, w in enumerate(weights):
            m[0, i] += late * w * ((kd - j * kc) + s * (cd - j * cc))
    return m


def pole(p, sensed, guess):
    return findroot(lambda s: det(equations(p, sensed, s)), guess, tol=mpf(10) ** -90, maxsteps=60)


def poles(p, sensed):
    """All slow ones, by Newton's method from a net of starts."""
    found = []
    for x in range(-8, 3):
        for y in range(-16, 17):
            try:
                s = pole(p, sensed, mpc(x, y) / 4)
            except (ValueError, ZeroDivisionError):
                continue
            if all(fabs(s - other) > 1e-20 for other in found):
                found.append(s)
    return found


def damping(s):
    return -re(s) / fabs(s)


def main():
    cases = []
    for name, (gains, sensed, parts) in CASES.items():
        p = {key: mpf(v) for key, v in {**ROTOR, **gains, **parts, "speed": "6"}.items()}
        worst = min(poles(p, sensed), key=damping)
        value = damping(worst)
        slopes = {}
        for key in p:
            def at(h, key=key):
                return damping(pole({**p, key: p[key] + h}, sensed, worst))
            one_sided = key in ("delay", "lag", "sensor_lag") and p[key] == 0
            h = mpf(10) ** (-25 if one_sided else -20)
            slopes[key] = float((at(h) - value) / h if one_sided else (at(h) - at(-h)) / (2 * h))
        cases.append({"name": name, "parts": {k: float(v) for k, v in parts.items()}, "min_damping": float(value),
                      "pole": [float(re(worst)), float(worst.imag)], "slopes": slopes})
    print(json.dumps(cases, indent=1))


main()
