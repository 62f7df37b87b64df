#!/usr/bin/env python3
"""Reference trajectories, steady maxima and spectra from SciPy, for a rotor that is not the report's.

Five unequal masses, deadband in three bearings, unbalance at every mass, feedback from four sensors. The equations are
written here from physics alone, in y and z, without a line of the program they check. DOP853 at rtol 1e-11, restarted
wherever a mass crosses the edge of its clearance, so that its order is kept.

Makes trajectories.json beside this file:

    python3 -m venv /tmp/whirl-reference
    /tmp/whirl-reference/bin/pip install numpy==2.4.6 scipy==1.17.1
    /tmp/whirl-reference/bin/python tests/reference/trajectories.py
"""

import json
import pathlib

import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.signal import welch

MASS = np.array([0.10, 0.30, 0.20, 0.25, 0.15])
ZETA = np.array([0.30, 0.10, 0.20, 0.15, 0.25])
ZETA_Q = np.array([0.05, 0.02, 0.00, 0.01, 0.04])
BEARING = np.array([0.3, 0.0, 0.2, 0.0, 0.4])
SEAL = np.array([0.05, 0.02, 0.03, 0.04, 0.06])
UNBALANCE = np.array([0.3, 0.1, 0.4, -0.2, 0.2])
SHAFT = np.array([0.4, 0.6, 0.5, 0.3])
CLEARANCE = np.array([0.05, 0.0, 0.10, 0.0, 0.15])
AT = 1  # the control bearing, counted from 0
WEIGHTS = np.array([0.2, 1.0, 0.3, 0.0, 0.1])
KD, CD, KC, CC = 0.1, 0.3, -0.1, 0.05
N = len(MASS)


def parts(state):
    return state[:N], state[N : 2 * N], state[2 * N : 3 * N], state[3 * N :]


def control(state):
    y, z, vy, vz = (WEIGHTS @ part for part in parts(state))
    # (kd - j kc)(y + j z) + (cd - j cc)(vy + j vz)
    return -(KD * y + KC * z + CD * vy + CC * vz), -(KD * z - KC * y + CD * vz - CC * vy)


def slope(tau, state, speed, touching):
    y, z, vy, vz = parts(state)
    radius = np.hypot(y, z)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(touching, 1.0 - CLEARANCE / radius, 0.0)
    stiffness = SEAL + BEARING * share
    fy, fz = -stiffness * y, -stiffness * z
    for i, k in enumerate(SHAFT):
        for f, x in ((fy, y), (fz, z)):
            pull = k * (x[i + 1] - x[i])
            f[i] += pull
            f[i + 1] -= pull
    ay = fy / MASS - 2 * ZETA * vy - 2 * ZETA_Q * vz - ZETA * speed * z + UNBALANCE * speed**2 * np.cos(speed * tau)
    az = fz / MASS - 2 * ZETA * vz + 2 * ZETA_Q * vy + ZETA * speed * y + UNBALANCE * speed**2 * np.sin(speed * tau)
    uy, uz = control(state)
    ay[AT] += uy
    az[AT] += uz
    return np.concatenate([vy, vz, ay, az])


def gap(mass):
    def event(tau, state, speed, touching):
        y, z, _, _ = parts(state)
        return np.hypot(y[mass], z[mass]) - CLEARANCE[mass]

    event.terminal = True
    return event


GAPPED = [k for k in range(N) if BEARING[k] > 0 and CLEARANCE[k] > 0]


def integrate(state, speed, until):
    """Pieces of dense output between contact events."""
    tau, pieces = 0.0, []
    touching = np.hypot(*parts(state)[:2]) > CLEARANCE
    while tau < until:
        events = [gap(k) for k in GAPPED]
        for k, event in zip(GAPPED, events):
            event.direction = -1.0 if touching[k] else 1.0
        made = solve_ivp(
            slope, (tau, until), state, "DOP853", rtol=1e-11, atol=1e-13, dense_output=True, events=events,
            args=(speed, touching.copy()),
        )
        pieces.append((tau, made.t[-1], made.sol))
        tau, state = made.t[-1], made.y[:, -1]
        for k, found in zip(GAPPED, made.t_events):
            if len(found):
                touching[k] = not touching[k]
    return pieces


def sample(pieces, times):
    out = np.empty((4 * N, len(times)))
    for begin, end, sol in pieces:
        inside = (times >= begin) & (times <= end)
        if inside.any():
            out[:, inside] = sol(times[inside])
    return out


def peak(values, step):
    """The maximum between fine samples, by the parabola through the largest three."""
    i = int(np.argmax(values))
    if i in (0, len(values) - 1):
        return float(values[i])
    a, b, c = values[i - 1 : i + 2]
    bend = a - 2 * b + c
    return float(b - (a - c) ** 2 / (8 * bend)) if bend < 0 else float(b)


def case(speed, impulse, until, settle):
    state = np.zeros(4 * N)
    for mass, vy, vz in impulse:
        state[2 * N + mass] += vy
        state[3 * N + mass] += vz
    pieces = integrate(state, speed, until)
    times = np.linspace(settle, until, int(round((until - settle) / 1e-3)) + 1)
    states = sample(pieces, times)
    y, z, _, _ = parts(states)
    uy, uz = control(states)
    marks = np.linspace(0.0, until, 11)
    orbit = {}
    if speed == 1.6:
        even = np.linspace(settle, until, 1537)
        path = sample(pieces, even)
        p = path[2] + 1j * path[N + 2]
        frequency, density = welch(
            p, fs=1 / (even[1] - even[0]), window="hann", nperseg=256, noverlap=128, detrend=False,
            return_onesided=False, scaling="density",
        )
        order = np.argsort(frequency)
        orbit = {
            "psd": {
                "mass": 3,
                "apart": even[1] - even[0],
                "segment": 256,
                "y": list(p.real),
                "z": list(p.imag),
                # Per radian instead of per cycle.
                "frequency": list(2 * np.pi * frequency[order]),
                "density": list(density[order] / (2 * np.pi)),
            }
        }
    return {
        "speed": speed,
        "impulse": [{"mass": m + 1, "vy": vy, "vz": vz} for m, vy, vz in impulse],
        "duration": until,
        "settle": settle,
        "contact_events": len(pieces) - 1,
        "max_force": peak(np.hypot(uy, uz) ** 2, 1e-3) ** 0.5,
        "max_force_component": max(peak(uy**2, 1e-3), peak(uz**2, 1e-3)) ** 0.5,
        "max_displacement": [peak(y[k] ** 2 + z[k] ** 2, 1e-3) ** 0.5 for k in range(N)],
        "mean_radius": [float(np.trapezoid(np.hypot(y[k], z[k]), times) / (until - settle)) for k in range(N)],
        "tau": list(marks),
        "states": sample(pieces, marks).T.tolist(),
        **orbit,
    }


def main():
    document = {
        "made_by": f"tests/reference/trajectories.py, scipy {scipy.__version__}, numpy {np.__version__}",
        "state": "y of every mass, z of every mass, vy of every mass, vz of every mass",
        "cases": [
            case(0.9, [], 200.0, 150.0),
            case(1.6, [], 200.0, 150.0),
            case(2.3, [(0, -1.5, 0.0), (3, 0.0, 0.8)], 60.0, 0.0),
            case(1.2, [(2, 2.0, -1.0)], 60.0, 0.0),
        ],
    }
    for made in document["cases"]:
        print(made["speed"], made["contact_events"], made["max_force"], made["max_displacement"])
    path = pathlib.Path(__file__).with_name("trajectories.json")
    path.write_text(json.dumps(document, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
