"""How many branches `whirl response` and `whirl cycles` miss: Newton's method by NumPy from thousands of starts, on random rotors
with three (or FEWEST) to eight clearances, from the equations of motion as the report writes them; no code is shared.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install numpy
    /tmp/venv/bin/python tests/reference/branches.py target/release/whirl [ROTORS] [STARTS] [SEED] [FEWEST]

For each rotor the command runs over a range of speeds; at three of them the brute force has its turn. Prints what it finds that
the command does not list, and what the command lists that it does not find.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

FIELDS = ["mass", "damping", "cross_damping", "bearing_stiffness", "seal_stiffness", "unbalance", "deadband"]


def random_rotor(rng, fewest):
    n = int(rng.integers(fewest, 9))
    log = lambda low, high: np.exp(rng.uniform(np.log(low), np.log(high), n))
    rotor = {
        "mass": log(0.1, 0.5),
        "damping": log(0.02, 0.3),
        "cross_damping": rng.uniform(0, 0.05, n),
        "bearing_stiffness": log(0.1, 1.0),
        "seal_stiffness": rng.uniform(0, 0.1, n),
        "unbalance": rng.normal(0, 0.5, n),
        "deadband": log(0.02, 1.0),
    }
    return rotor, rng.uniform(0.2, 1.0, n - 1)


def toml(rotor, shafts):
    lines = ['name = "random"', 'units = "dimensionless"']
    for i in range(len(rotor["mass"])):
        lines += ["[[mass]]"] + [f"{field} = {float(rotor[field][i])!r}" for field in FIELDS]
    for stiffness in shafts:
        lines += ["[[shaft]]", f"stiffness = {float(stiffness)!r}"]
    return "\n".join(lines) + "\n"


class Machine:
    def __init__(self, rotor, shafts, speed):
        n = len(rotor["mass"])
        self.n, self.speed = n, speed
        m = rotor["mass"]
        self.damping = 2 * rotor["damping"] - 2j * rotor["cross_damping"]
        k = np.diag(rotor["seal_stiffness"] / m - 1j * rotor["damping"] * speed)
        for i, shaft in enumerate(shafts):
            k[i, i] += shaft / m[i]
            k[i + 1, i + 1] += shaft / m[i + 1]
            k[i, i + 1] -= shaft / m[i]
            k[i + 1, i] -= shaft / m[i + 1]
        self.k = k
        self.b = rotor["bearing_stiffness"] / m
        self.g = rotor["deadband"]
        self.f = rotor["unbalance"] * speed**2

    def z(self, w):
        """Dynamic stiffness, one matrix a frequency."""
        w = np.atleast_1d(w)
        d = np.arange(self.n)
        z = np.broadcast_to(self.k, (len(w), self.n, self.n)).astype(complex)
        z = z.copy()
        z[:, d, d] += 1j * w[:, None] * self.damping - w[:, None] ** 2
        return z

    def newton(self, c, w, forced):
        """Many at once; amplitudes `c[start, mass]`, frequencies `w[start]`."""
        n = self.n
        phase = c / np.linalg.norm(c, axis=1, keepdims=True)
        size = 2 * n + (0 if forced else 1)
        with np.errstate(all="ignore"):
            for _ in range(40):
                r = np.abs(c)
                contact = r > self.g
                s = np.where(contact, 1 - self.g / r, 0.0)
                z = self.z(w)
                f = np.einsum("sij,sj->si", z, c) + self.b * s * c - (self.f if forced else 0)
                half = np.where(contact, 0.5 * self.g / r, 0.0)
                a = z.copy()
                d = np.arange(n)
                a[:, d, d] += np.where(contact, self.b * (1 - half), 0.0)
                conj = np.where(contact, self.b * half * (c / r) ** 2, 0.0)
                jac = np.zeros((len(c), size, size))
                jac[:, :n, :n], jac[:, :n, n : 2 * n] = a.real, -a.imag
                jac[:, n : 2 * n, :n], jac[:, n : 2 * n, n : 2 * n] = a.imag, a.real
                jac[:, d, d] += conj.real
                jac[:, d, n + d] += conj.imag
                jac[:, n + d, d] += conj.imag
                jac[:, n + d, n + d] -= conj.real
                residual = np.concatenate([f.real, f.imag], axis=1)
                if not forced:
                    by_w = (1j * self.damping - 2 * w[:, None]) * c
                    jac[:, :n, 2 * n], jac[:, n : 2 * n, 2 * n] = by_w.real, by_w.imag
                    jac[:, 2 * n, :n], jac[:, 2 * n, n : 2 * n] = -phase.imag, phase.real
                    residual = np.concatenate([residual, np.sum(phase.conj() * c, axis=1).imag[:, None]], axis=1)
                ok = np.isfinite(jac).all(axis=(1, 2)) & np.isfinite(residual).all(axis=1)
                c, w, phase, jac, residual = c[ok], w[ok], phase[ok], jac[ok], residual[ok]
                if len(c) == 0:
                    break
                jac[:, np.arange(size), np.arange(size)] += 1e-300
                try:
                    step = np.linalg.solve(jac, residual[:, :, None])[:, :, 0]
                except np.linalg.LinAlgError:
                    jac[:, np.arange(size), np.arange(size)] += 1e-12
                    step = np.linalg.solve(jac, residual[:, :, None])[:, :, 0]
                c = c - (step[:, :n] + 1j * step[:, n : 2 * n])
                if not forced:
                    w = w - step[:, 2 * n]
            r = np.abs(c)
            s = np.where(r > self.g, 1 - self.g / r, 0.0)
            f = np.einsum("sij,sj->si", self.z(w), c) + self.b * s * c - (self.f if forced else 0)
            good = np.abs(f).max(axis=1) < 1e-10 * (1 + r.max(axis=1))
        return c[good], w[good]

    def brute(self, forced, starts, rng):
        n = self.n
        s = np.clip(rng.uniform(-0.4, 1.0, (starts, n)), 0, 0.999)
        spread = np.exp(rng.uniform(-2, 3, (starts, 1))) * self.g.mean()
        wild = spread * (rng.normal(size=(starts, n)) + 1j * rng.normal(size=(starts, n)))
        if forced:
            w = np.full(starts, self.speed)
            a = self.z(w)
            a[:, np.arange(n), np.arange(n)] += self.b * s
            tame = np.linalg.solve(a, np.broadcast_to(self.f.astype(complex), (starts, n))[:, :, None])[:, :, 0]
        else:
            w, tame = np.zeros(starts), wild.copy()
            for i in range(starts):
                state = np.zeros((2 * n, 2 * n), complex)
                state[:n, n:] = np.eye(n)
                state[n:, :n] = -self.k - np.diag(self.b * s[i])
                state[n:, n:] = -np.diag(self.damping)
                poles, vectors = np.linalg.eig(state)
                # One of the modes that are nearest to whirling steadily.
                order = np.argsort(np.abs(poles.real))
                pick = order[int(rng.integers(0, min(n, 4)))]
                shape = vectors[:n, pick]
                touching = s[i] > 0
                if touching.any():
                    sizes = self.g[touching] / (1 - s[i][touching]) / np.abs(shape[touching])
                    tame[i] = shape * np.median(sizes)
                w[i] = poles[pick].imag
        c = np.where(rng.uniform(size=(starts, 1)) < 0.7, tame, wild)
        c, w = self.newton(c, w, forced)
        found = []
        for c, w in zip(c, w):
            if not forced and (np.abs(c).max() < self.g.min() or abs(w) < 1e-6 or not (np.abs(c) > self.g).any()):
                continue
            if not any(same((np.abs(c), w), other) for other in found):
                found.append((np.abs(c), w))
        return found


def same(a, b):
    return np.abs(a[0] - b[0]).max() < 1e-5 * np.abs(a[0]).max() and abs(a[1] - b[1]) < 1e-5 * (1 + abs(a[1]))


def main():
    whirl, rotors, starts, seed, fewest = (sys.argv[1:] + ["", "120", "2000", "1", "3"][len(sys.argv) - 1 :])[:5]
    rng = np.random.default_rng(int(seed))
    total = {}
    for number in range(int(rotors)):
        rotor, shafts = random_rotor(rng, int(fewest))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "rotor.toml"
            path.write_text(toml(rotor, shafts))
            for command, over in (("response", (0.3, 3.3)), ("cycles", (1.0, 5.0))):
                arguments = [whirl, command, path, "--over", f"{over[0]}..{over[1]}", "--points", "31", "--json"]
                ran = subprocess.run(arguments, capture_output=True, text=True)
                points = json.loads(ran.stdout)["points"]
                forced = command == "response"
                entry = total.setdefault(command, {"rotors": 0, "rotors missed": 0, "orbits": 0, "missed": 0, "only ours": 0})
                short = 0
                for i in rng.integers(0, 31, 3):
                    point = points[i]
                    speed = point["speed"]
                    ours = [(np.array(b["radius"]), speed if forced else b["frequency"]) for b in point["branches"]]
                    theirs = Machine(rotor, shafts, speed).brute(forced, int(starts), rng)
                    missed = [t for t in theirs if not any(same(t, o) for o in ours)]
                    entry["orbits"] += len(ours) + len(missed)
                    entry["only ours"] += sum(not any(same(o, t) for t in theirs) for o in ours)
                    short += len(missed)
                    for radii, w in missed:
                        claims = "complete" if point.get("complete") else "no proof"
                        print(f"rotor {number} ({len(radii)} masses), {command} at R = {speed:.4f}: missed w = {w:.6f}, radii {np.round(radii, 4)}; {claims}", flush=True)
                entry["rotors"] += 1
                entry["rotors missed"] += short > 0
                entry["missed"] += short
        # What there is so far, in case it is ended.
        print(json.dumps(total), file=sys.stderr, flush=True)
    print(json.dumps(total, indent=1))


main()
