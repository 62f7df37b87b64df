#!/usr/bin/env python3
"""Reference run-ups and a coast-down from SciPy: the rotor of trajectories.py while its speed changes, with deadband, through its
critical speeds, and, always on its bearings, under gains that are tables of speed behind a notch that follows it; and a bare mass that passes its critical speed, after F. M. Lewis (1932), by Duhamel's integral.

Makes runup.json beside this file, in the environment of trajectories.py:

    /tmp/whirl-reference/bin/python tests/reference/runup.py
"""

import json
import pathlib

import numpy as np
import scipy
from scipy.integrate import solve_ivp
import trajectories as t


def ramp(begin, rate):
    """Speed, its rate and the angle, of a steady change."""
    return lambda tau: (begin + rate * tau, rate, begin * tau + 0.5 * rate * tau**2)


def decay(begin, rate):
    """The same of a decay towards rest that begins at this rate."""
    k = rate / begin
    return lambda tau: (begin * np.exp(-k * tau), -rate * np.exp(-k * tau), begin / k * -np.expm1(-k * tau))


def slope(tau, state, spin, touching):
    speed, change, angle = spin(tau)
    made = t.slope(0.0, state, speed, touching)
    # What a steady spin at tau = 0 pushes, in place of which comes (R^2 - j R') exp(j theta).
    y = speed**2 * (np.cos(angle) - 1.0) + change * np.sin(angle)
    z = speed**2 * np.sin(angle) - change * np.cos(angle)
    made[2 * t.N : 3 * t.N] += t.UNBALANCE * y
    made[3 * t.N :] += t.UNBALANCE * z
    return made


def run(spin, until):
    tau, state, found = 0.0, np.zeros(4 * t.N), []
    marks = np.linspace(0.0, until, 6)
    touching = np.zeros(t.N, bool)
    events_seen = 0
    while tau < until:
        events = [t.gap(k) for k in t.GAPPED]
        for k, event in zip(t.GAPPED, events):
            event.direction = -1.0 if touching[k] else 1.0
        made = solve_ivp(
            slope, (tau, until), state, "DOP853", rtol=1e-11, atol=1e-13, dense_output=True, events=events,
            args=(spin, touching.copy()),
        )
        found += [(mark, made.sol(mark)) for mark in marks if tau < mark <= made.t[-1]]
        tau, state = made.t[-1], made.y[:, -1]
        for k, seen in zip(t.GAPPED, made.t_events):
            if len(seen):
                touching[k] = not touching[k]
                events_seen += 1
    return found, events_seen


# Gains over speed, straight between these, of kd, cd, kc, cc; and the width of the notch.
GAIN_SPEEDS = [0.0, 0.9, 1.7, 3.0]
GAINS = {"kd": [0.1, 0.25, 0.05, 0.2], "cd": [0.3, 0.35, 0.2, 0.3], "kc": [-0.1, -0.15, 0.05, -0.1], "cc": [0.05, 0.05, 0.1, 0.0]}
NOTCH = 0.2


def scheduled(spin, until):
    """Complex displacements, velocities and the state of the notch (s - j R) / (s - j R + width / 2), which is
    1 - (width / 2) / (s - j R + width / 2)."""
    n = t.N
    # Stiffness of shafts, and what holds every mass by itself.
    shafts = np.zeros((n, n))
    for k, stiffness in enumerate(t.SHAFT):
        shafts[k : k + 2, k : k + 2] += stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = (shafts + np.diag(t.BEARING + t.SEAL)) / t.MASS[:, None]

    def rates(tau, state):
        speed, change, angle = spin(tau)
        p, v, held = state[:n], state[n : 2 * n], state[2 * n]
        kd, cd, kc, cc = (np.interp(speed, GAIN_SPEEDS, GAINS[key]) for key in ("kd", "cd", "kc", "cc"))
        command = -((kd - 1j * kc) * (t.WEIGHTS @ p) + (cd - 1j * cc) * (t.WEIGHTS @ v))
        a = -2.0 * t.ZETA * v + 2j * t.ZETA_Q * v + 1j * t.ZETA * speed * p - stiffness @ p
        a = a + t.UNBALANCE * (speed**2 - 1j * change) * np.exp(1j * angle)
        a[t.AT] += command - 0.5 * NOTCH * held
        return np.concatenate([v, a, [command + (1j * speed - 0.5 * NOTCH) * held]])

    marks = np.linspace(0.0, until, 6)
    # Where the speed passes a corner of a table the equations have a kink.
    grid = np.linspace(0.0, until, 100_001)
    speeds = spin(grid)[0]
    kinks = [grid[i] for s in GAIN_SPEEDS[1:-1] for i in np.nonzero((speeds[:-1] < s) != (speeds[1:] < s))[0]]
    stops = sorted({*marks[1:], *kinks})
    tau, state, found = 0.0, np.zeros(2 * n + 1, complex), []
    for stop in stops:
        made = solve_ivp(rates, (tau, stop), state, "DOP853", rtol=1e-11, atol=1e-13)
        tau, state = stop, made.y[:, -1]
        if stop in marks:
            parts = [state[:n].real, state[:n].imag, state[n : 2 * n].real, state[n : 2 * n].imag]
            found.append((stop, np.concatenate(parts)))
    return found


def lewis(rate, until):
    """Radius of a mass on a spring without damping, unbalance 1, that spins up from rest at `rate`: q'' + q = (R^2 - j R')
    exp(j theta), so q = int sin(tau - s) F(s) ds, two running integrals by Simpson's rule."""
    step = 1e-3
    s = np.arange(0.0, until + step / 2, step)
    force = ((rate * s) ** 2 - 1j * rate) * np.exp(0.5j * rate * s**2)
    with_cos = scipy.integrate.cumulative_simpson(np.cos(s) * force, x=s, initial=0)
    with_sin = scipy.integrate.cumulative_simpson(np.sin(s) * force, x=s, initial=0)
    q = np.sin(s) * with_cos - np.cos(s) * with_sin
    radius = np.abs(q)
    # The first highest: later beats are no lower where nothing damps.
    top = next(i for i in range(1, len(s) - 1) if radius[i] >= radius[i - 1] and radius[i] > radius[i + 1] and s[i] * rate > 1)
    return {"rate": rate, "until": until, "peak_speed": rate * s[top], "peak": radius[top], "end": [q[-1].real, q[-1].imag]}


def main():
    cases = []
    for name, from_speed, to, rate, spin, until in [
        ("ramp", 0.0, 2.5, 0.01, ramp(0.0, 0.01), 250.0),
        ("ramp", 0.0, 2.5, 0.05, ramp(0.0, 0.05), 50.0),
        ("ramp", 2.4, 0.4, 0.02, ramp(2.4, -0.02), 100.0),
        ("decay", 2.0, 0.0, 0.02, decay(2.0, 0.02), 200.0),
    ]:
        found, events = run(spin, until)
        cases.append({
            "kind": name, "from": from_speed, "to": to, "rate": rate, "contact_events": events,
            "tau": [mark for mark, _ in found],
            "speed": [float(spin(mark)[0]) for mark, _ in found],
            "angle": [float(spin(mark)[2]) for mark, _ in found],
            "states": [list(state) for _, state in found],
        })
        print(name, rate, events, np.hypot(*t.parts(found[-1][1])[:2]))
    schedule = []
    for name, from_speed, to, rate, spin, until in [
        ("ramp", 0.2, 2.2, 0.02, ramp(0.2, 0.02), 100.0),
        ("decay", 2.4, 0.0, 0.03, decay(2.4, 0.03), 120.0),
    ]:
        found = scheduled(spin, until)
        schedule.append({
            "kind": name, "from": from_speed, "to": to, "rate": rate,
            "tau": [mark for mark, _ in found],
            "speed": [float(spin(mark)[0]) for mark, _ in found],
            "angle": [float(spin(mark)[2]) for mark, _ in found],
            "states": [list(state) for _, state in found],
        })
        print("scheduled", name, np.hypot(*t.parts(found[-1][1])[:2]))
    passes = [lewis(rate, 1.6 / rate) for rate in (0.002, 0.01, 0.05)]
    print(passes)
    document = {
        "made_by": f"tests/reference/runup.py, scipy {scipy.__version__}, numpy {np.__version__}",
        "state": "y of every mass, z of every mass, vy of every mass, vz of every mass",
        "cases": cases,
        "scheduled": {"gain_speeds": GAIN_SPEEDS, "gains": GAINS, "notch": NOTCH, "cases": schedule},
        "lewis": passes,
    }
    path = pathlib.Path(__file__).with_name("runup.json")
    path.write_text(json.dumps(document, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
