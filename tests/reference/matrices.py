"""Matrices of a tapered shaft element as NumPy and SciPy write them, from the numbers that ROSS gives for it.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy scipy
    /tmp/venv/bin/python tests/reference/matrices.py

Writes `crates/beam/tests/cases/matrices`, which `crates/beam/tests/matrices.rs` reads.
"""

import json
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse

CASES = Path(__file__).parents[2] / "crates/beam/tests/cases"
X = [(0, 1), (3, 1), (4, 1), (7, 1)]  # x beta at both ends
Y = [(1, 1), (2, -1), (5, 1), (6, -1)]  # y -alpha


def block(matrix, rows, columns):
    return np.array([[a * b * matrix[i][k] for k, b in columns] for i, a in rows])


def main():
    case = json.loads((CASES / "element_matrices.json").read_text())["tapered"]
    mass, stiffness, gyroscopic = block(case["M"], X, X), block(case["K"], X, X), block(case["G"], X, Y)
    out = CASES / "matrices"
    out.mkdir(exist_ok=True)
    np.savez(out / "plain.npz", M=mass, K=np.asfortranarray(stiffness), G=gyroscopic, note=np.arange(3))
    np.savez_compressed(out / "deflated.npz", mass=mass, stiffness=stiffness, gyroscopic=gyroscopic)
    np.save(out / "mass.npy", mass)
    np.save(out / "whole.npy", np.arange(6, dtype="<i4").reshape(2, 3))
    np.save(out / "complex.npy", mass.astype(complex))
    scipy.io.mmwrite(out / "stiffness.mtx", stiffness, symmetry="symmetric", precision=17)
    scipy.io.mmwrite(out / "mass.mtx", scipy.sparse.coo_matrix(mass), symmetry="general", precision=17)
    skew = np.triu(stiffness, 1) - np.triu(stiffness, 1).T
    scipy.io.mmwrite(out / "skew.mtx", scipy.sparse.coo_matrix(skew), symmetry="skew-symmetric", precision=17)
    np.savetxt(out / "gyroscopic.csv", gyroscopic, delimiter=",", fmt="%.17g", header="p1,t1,p2,t2", comments="")
    np.savetxt(out / "gyroscopic.txt", gyroscopic, fmt="%.17g", header="of a tapered element")


main()
