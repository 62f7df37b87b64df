"""Eigenvalues that ROSS has for rotors whose bearings stand on pedestals, and for two shafts with a coupling between them.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install "ross-rotordynamics==2.3.0" "plotly<6"
    /tmp/venv/bin/python tests/reference/linked.py

Writes `crates/beam/tests/cases/pedestal.toml`, `coupling.toml` and `linked_eigenvalues.json`, which `crates/beam/tests/linked.rs` reads.
The eigenvalues are those of ROSS's own matrices M, K(w), C(w) + w G, in the lateral degrees of freedom alone: nothing couples them with
the axial and torsional ones.
"""

import json
from pathlib import Path

import numpy as np
import ross as rs
import scipy.linalg

CASES = Path(__file__).parents[2] / "crates/beam/tests/cases"
STEEL = rs.Material(name="Steel", rho=7810.0, E=211e9, G_s=81.2e9)
SPEEDS = [0.0, 300.0, 900.0]  # those of the table: between them ROSS fits a curve


def shaft(n, length, outer, **more):
    return rs.ShaftElement(n=n, L=length, idl=0.0, odl=outer, material=STEEL, **more)


def pedestal():
    elements = [shaft(n, 0.25, 0.05) for n in range(6)]
    discs = [
        rs.DiskElement(n=2, m=32.6, Id=0.178, Ip=0.329),
        rs.DiskElement(n=4, m=35.8, Id=0.204, Ip=0.377),
    ]
    over = np.array([0.0, 300.0, 900.0])
    bearings = [
        rs.BearingElement(n=0, n_link=7, kxx=8e6, kxy=4e5, kyx=-4e5, cxx=700.0),
        rs.BearingElement(n=6, n_link=8, kxx=[5e6, 6e6, 9e6], cxx=[900.0, 800.0, 700.0], frequency=over),
        rs.BearingElement(n=7, kxx=4e7, cxx=300.0),
        rs.BearingElement(n=8, kxx=2e7, cxx=500.0),
    ]
    masses = [rs.PointMass(n=7, m=11.0), rs.PointMass(n=8, m=23.0)]
    return rs.Rotor(elements, discs, bearings, masses)


def coupling():
    between = rs.CouplingElement(
        n=3, m_l=3.5, m_r=4.5, Ip_l=0.02, Ip_r=0.03, Id_l=0.012, kt_x=6e7, kt_y=6e7, kt_z=1e7, kr_x=4e4, kr_y=4e4,
        kr_z=1e5, ct_x=90.0, ct_y=90.0, cr_x=1.5, cr_y=1.5, L=0.15, o_d=0.12,
    )
    elements = [shaft(n, 0.25, 0.05) for n in range(3)] + [between] + [shaft(n, 0.2, 0.04) for n in range(4, 7)]
    discs = [
        rs.DiskElement(n=1, m=22.6, Id=0.178, Ip=0.329),
        rs.DiskElement(n=5, m=15.8, Id=0.104, Ip=0.177),
    ]
    bearings = [rs.BearingElement(n=n, kxx=k, cxx=300.0) for n, k in [(0, 4e6), (2, 7e6), (5, 3e6), (7, 5e6)]]
    return rs.Rotor(elements, discs, bearings)


def eigenvalues(rotor, speed):
    mass, stiffness = rotor.M(speed), rotor.K(speed)
    damping = rotor.C(speed) + rotor.G() * speed
    nodes = len(rotor.nodes)
    shaft_dofs = [6 * node + k for node in range(nodes) for k in (0, 1, 3, 4)]
    links = [6 * nodes + 3 * i + k for i in range((mass.shape[0] - 6 * nodes) // 3) for k in (0, 1)]
    own = np.ix_(shaft_dofs + links, shaft_dofs + links)
    mass, stiffness, damping = mass[own], stiffness[own], damping[own]
    size = len(mass)
    solved = np.linalg.solve(mass, np.hstack([stiffness, damping]))
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-solved[:, :size], -solved[:, size:]]])
    found = scipy.linalg.eigvals(state)
    slow = sorted(found, key=lambda s: (abs(s), s.imag))[:48]
    return [[s.real, s.imag] for s in slow]


def main():
    answers = {}
    for name, rotor in [("pedestal", pedestal()), ("coupling", coupling())]:
        rotor.save(str(CASES / f"{name}.toml"))
        answers[name] = {f"{speed}": eigenvalues(rotor, speed) for speed in SPEEDS}
    (CASES / "linked_eigenvalues.json").write_text(json.dumps(answers, indent=1) + "\n")


main()
