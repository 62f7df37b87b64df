"""Plots the orbit of every mass of a running bench, live.

    pip install matplotlib
    python crates/wire/python/examples/live_plot.py lab

With ``--png FILE`` behind the name it draws one picture of the next second and ends.
"""

import sys

import matplotlib
import numpy as np

import whirl

SHOWN = 2000


def main() -> None:
    """Plots until the bench, or the window, is gone."""
    name = sys.argv[1] if len(sys.argv) > 1 and not sys.argv[1].startswith("--") else "default"
    png = sys.argv[sys.argv.index("--png") + 1] if "--png" in sys.argv else None
    if png:
        matplotlib.use("Agg")
    from matplotlib import pyplot

    with whirl.attach(name) as bench:
        masses = bench.status.masses
        orbit = np.zeros((0, 2, masses))
        figure, axes = pyplot.subplots(1, masses, squeeze=False, figsize=(4 * masses, 4))
        lines = [axis.plot([], [], linewidth=0.8)[0] for axis in axes[0]]
        for mass, axis in enumerate(axes[0]):
            axis.set(title=f"mass {mass + 1}", xlabel="y / e_t", ylabel="z / e_t", aspect="equal")
        drawn = 0
        for block in bench.steps():
            # A copy, made by stacking: the block itself goes back to the bench.
            orbit = np.concatenate([orbit, np.stack([block.y, block.z], axis=1)])[-SHOWN:]
            drawn += len(block)
            # Thirty pictures a second, or one.
            if drawn < (1000 if png else bench.status.rate_hz / 30):
                continue
            drawn = 0
            for mass, (axis, line) in enumerate(zip(axes[0], lines)):
                line.set_data(orbit[:, 0, mass], orbit[:, 1, mass])
                reach = 1.1 * np.abs(orbit[:, :, mass]).max() + 1e-9
                axis.set(xlim=(-reach, reach), ylim=(-reach, reach))
            figure.suptitle(f"{name}: tau = {block.tau[-1]:.1f}, R = {block.speed[-1]:.3f}")
            if png:
                figure.savefig(png)
                return
            pyplot.pause(0.001)
            if not pyplot.fignum_exists(figure.number):
                return


if __name__ == "__main__":
    main()
