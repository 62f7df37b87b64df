"""Roots of loops with delay by SciPy: Chebyshev collocation of the control signal over the delay, refined on the exact equation.
No code and no method is shared: the crate has Legendre coefficients (Pade) for guesses and counts by the argument principle.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy
    /tmp/venv/bin/python tests/reference/delay.py > tests/reference/delay.json

The JSON is what `crates/linear/tests/val_delay.rs` compares with. One case is simulated too: its growth is that of its rightmost root.
"""

import json

import numpy as np
import scipy.linalg

from poles import THREE_MASS, complex_matrix

OFF = {"sensors": {}}
COMPOSITE = [-0.5879, 0.4948, -0.4847, 0.6483]
INDIVIDUAL = {"1": [4, 3.1168, 3.1241, 0.9175], "2": [-2.3419, 4, -3.7635, 4]}


def both(rotor, sensors, speed):
    """A without control, and B C."""
    a = complex_matrix({**rotor, **OFF}, speed)
    return a, complex_matrix({**rotor, "sensors": sensors}, speed) - a


def composite(gains, sensed=(1, 2)):
    return {str(k): list(gains) for k in sensed}


def chebyshev(m):
    """Nodes from 1 to -1 and the matrix that differentiates there (Trefethen)."""
    x = np.cos(np.pi * np.arange(m + 1) / m)
    c = np.ones(m + 1)
    c[0] = c[-1] = 2
    c *= (-1.0) ** np.arange(m + 1)
    d = np.outer(c, 1 / c) / (x[:, None] - x[None, :] + np.eye(m + 1))
    return x, d - np.diag(d.sum(axis=1))


def discretised(a, through, delay, m):
    """The state, and v = c x at nodes over the last delay, v' = dv / dtheta."""
    n = len(a)
    bearing = np.flatnonzero(abs(through).sum(axis=1))[0]
    c = through[bearing]
    _, d = chebyshev(m)
    d = d * 2 / delay
    g = np.zeros((n + m, n + m), complex)
    g[:n, :n] = a
    g[bearing, -1] = 1
    g[n:, n:] = d[1:, 1:]
    g[n:, :n] = np.outer(d[1:, 0], c)
    return scipy.linalg.eigvals(g)


def refined(a, through, delay, s):
    for _ in range(60):
        e = np.exp(-s * delay)
        m = s * np.eye(len(a)) - a - through * e
        dm = np.eye(len(a)) + delay * through * e
        try:
            step = 1 / np.trace(np.linalg.solve(m, dm))
        except np.linalg.LinAlgError:
            break
        s -= step
        if abs(step) < 1e-15 * abs(s):
            break
    return s


def roots(a, through, delay, line, m):
    found = []
    for guess in discretised(a, through, delay, m):
        if guess.real < line - 0.5 / delay or abs(guess) * delay > 1.2 * m:
            continue
        s = refined(a, through, delay, guess)
        if s.real > line and all(abs(s - t) > 1e-8 * (1 + abs(s)) for t in found):
            found.append(s)
    return sorted(found, key=lambda s: (-s.real, -s.imag))


def growth(a, through, delay, to, steps):
    """RK4 with the past interpolated: the growth rate over the last half of the time."""
    h = delay / steps
    count = int(to / h)
    x = np.zeros((count + steps + 1, len(a)), complex)
    x[steps] = 1 + 0.3j * np.arange(len(a))
    for k in range(steps, count + steps):
        then = [x[k - steps], 0, x[k - steps + 1]]
        before = x[max(k - steps - 1, 0)]
        after = x[k - steps + 2]
        then[1] = (-before + 9 * then[0] + 9 * then[2] - after) / 16
        f = lambda y, late: a @ y + through @ late
        k1 = f(x[k], then[0])
        k2 = f(x[k] + h / 2 * k1, then[1])
        k3 = f(x[k] + h / 2 * k2, then[1])
        k4 = f(x[k] + h * k3, then[2])
        x[k + 1] = x[k] + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    size = np.linalg.norm(x, axis=1)
    return float(np.log(size[-1] / size[len(size) // 2]) / (h * (len(size) - 1 - len(size) // 2)))


def case(name, a, through, delay, line, m, **more):
    found = roots(a, through, delay, line, m)
    again = roots(a, through, delay, line, m + m // 3)
    assert len(found) == len(again), (name, len(found), len(again))
    assert max([abs(s - t) for s, t in zip(found, again)], default=0) < 1e-8 * (1 + abs(found[0])), name
    row = np.flatnonzero(abs(through).sum(axis=1))
    assert len(row) <= 1
    pairs = lambda v: [[float(z.real), float(z.imag)] for z in v]
    bearing = int(row[0]) if len(row) else 0
    return {
        "name": name,
        "a": [pairs(line) for line in a],
        "bearing": bearing,
        "row": pairs(through[bearing]),
        "delay": delay,
        "line": line,
        "roots": pairs(found),
        **more,
    }


def cases():
    made = []
    for name, sensors in (("composite", composite(COMPOSITE)), ("individual", INDIVIDUAL)):
        for speed in (2.5, 6.0):
            a, through = both(THREE_MASS, sensors, speed)
            for delay in (0.02, 0.3, 5.0):
                m = 60 if delay < 1 else 140
                made.append(case(f"{name} {speed} {delay}", a, through, delay, -2 / delay, m))
    # Shafts a hundred times stiffer: modes beyond pi / delay.
    stiff = {**THREE_MASS, "shaft": [50.0, 50.0]}
    a, through = both(stiff, composite([9.0, 6.0, -3.0, 2.0]), 3.0)
    made.append(case("stiff shafts", a, through, 0.25, -8.0, 90, growth=growth(a, through, 0.25, 16.0, 60)))
    # In seconds: eight masses, poles up to 18 000 / s, a delay of 300 us.
    n = 8
    chain = {
        "mass": [1.0] * n,
        "damping": [60.0] + [2.0] * (n - 2) + [60.0],
        "cross_damping": [1.0] * n,
        "bearing_stiffness": [2e6] + [0.0] * (n - 2) + [2e6],
        "seal_stiffness": [0.0] * n,
        "shaft": [8e7] * (n - 1),
        "bearing": 1,
    }
    a, through = both(chain, composite([-2e6, 900.0, 3e5, 50.0]), 500.0)
    made.append(case("eight masses in seconds", a, through, 3e-4, -2 / 3e-4, 50))
    # One mass, a delay of thirty turns of its mode: very many roots.
    jeffcott = {
        "mass": [1.0], "damping": [0.05], "cross_damping": [0.01], "bearing_stiffness": [1.0],
        "seal_stiffness": [0.0], "shaft": [], "bearing": 1,
    }  # fmt: skip
    a, through = both(jeffcott, {"1": [0.3, 0.2, 0.1, 0.05]}, 0.8)
    made.append(case("long delay", a, through, 200.0, -0.01, 400))
    return made


if __name__ == "__main__":
    print(json.dumps(cases()))
