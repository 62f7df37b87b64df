"""An independent look at what `whirl tune` finds: poles by SciPy from the equations of motion, as in poles.py.

    /tmp/venv/bin/python tests/reference/tune.py target/release/whirl > tests/reference/tune.json

For each search: the gains, the worst condition that whirl names with its damping there, SciPy's damping at that condition, and
SciPy's least damping over a grid of its own. `crates/tuner/tests/val_scipy.rs` judges the gains anew and compares.
"""

import copy
import itertools
import json
import subprocess
import sys

import numpy as np

from poles import THREE_MASS, complex_matrix

COMPOSITE = ["--signal", "composite", "--sensors", "1,2"]
INDIVIDUAL = ["--signal", "individual", "--sensors", "1,2"]
ROBUST = ["--robust", "deadband"]
# Name, from, to, whether each bearing keeps any part of its stiffness, gains at most, options.
CASES = [
    ("composite at 7.2", 7.2, 7.2, False, 20, ["--speed", "7.2", *COMPOSITE]),
    ("composite at 6", 6.0, 6.0, False, 20, ["--speed", "6", *COMPOSITE]),
    ("composite at 4", 4.0, 4.0, False, 20, ["--speed", "4", *COMPOSITE]),
    ("composite over 0..5", 0.0, 5.0, False, 20, ["--over", "0..5", *COMPOSITE]),
    ("individual, 5", 0.0, 7.2, False, 5, ["--over", "0..7.2", *INDIVIDUAL, "--bound", "5"]),
    ("individual, 20", 0.0, 7.2, False, 20, ["--over", "0..7.2", *INDIVIDUAL, "--bound", "20"]),
    ("robust over 0..6, 5", 0.0, 6.0, True, 5, ["--over", "0..6", *INDIVIDUAL, *ROBUST, "--bound", "5"]),
    ("robust over 0..7.2, 5", 0.0, 7.2, True, 5, ["--over", "0..7.2", *INDIVIDUAL, *ROBUST, "--bound", "5"]),
    ("robust over 0..7.2, 20", 0.0, 7.2, True, 20, ["--over", "0..7.2", *INDIVIDUAL, *ROBUST, "--bound", "20"]),
]


def damping(gains, speed, first, third):
    """The least damping ratio; the end bearings keep the parts `first` and `third` of their stiffness."""
    rotor = copy.deepcopy(THREE_MASS)
    rotor["bearing_stiffness"] = [0.5 * first, 0.0, 0.5 * third]
    rotor["sensors"] = gains
    poles = np.linalg.eigvals(complex_matrix(rotor, speed))
    return float(min(-poles.real / abs(poles)))


def case(whirl, name, low, high, robust, bound, options):
    ran = subprocess.run([whirl, "tune", "three-mass", *options, "--json"], capture_output=True, text=True, check=True)
    found = json.loads(ran.stdout)
    signals = found["feedback"]["signal"]
    each = [[signal[gain] for gain in ("kd", "cd", "kc", "cc")] for signal in signals]
    # One signal is the sum of both sensors; two are one of each.
    gains = {"1": each[0], "2": each[-1]}
    worst = found["worst"]
    point = [worst["speed"], worst.get("factor.1", 1.0), worst.get("factor.3", 1.0)]
    speeds = np.linspace(low, high, 1 if low == high else 241 if robust else 2881)
    parts = np.linspace(0.0, 1.0, 21) if robust else [1.0]
    grid = min((damping(gains, *at), at) for at in itertools.product(speeds, parts, parts))
    return {
        "name": name, "from": low, "to": high, "robust": robust, "bound": bound, "gains": sum(each, []),
        "point": point, "ours": found["min_damping"], "tolerance": found["tolerance"], "proven": found["proven"],
        "scipy": damping(gains, *point), "grid": grid[0], "grid_at": [float(x) for x in grid[1]],
    }


if __name__ == "__main__":
    json.dump([case(sys.argv[1], *each) for each in CASES], sys.stdout, indent=1)
    print()
