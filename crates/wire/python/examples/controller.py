"""A controller outside a bench, which does what the built-in feedback ``individual`` of the three-mass rotor does.

    whirl sim three-mass --bench lab --feedback individual --set sample=0.01 --set delay=0.01 --set external=20 &
    python crates/wire/python/examples/controller.py lab

With ``whirl sim --lockstep`` the machine waits for it. With a number behind the name it ends after so many commands.
"""

import sys

import whirl

#: Of each sensor kd, cd, kc, cc: u = - sum [(kd - j kc) p + (cd - j cc) p'].
GAINS = [(4.0, 3.1168, 3.1241, 0.9175), (-2.3419, 4.0, -3.7635, 4.0)]


def law(readings: whirl.messages.Readings) -> tuple[float, float]:
    """The law, in the order in which the bench itself computes it, so that the last bit agrees."""
    uy = uz = 0.0
    for (kd, cd, kc, cc), (y, z, vy, vz) in zip(GAINS, readings.readings):
        uy -= (kd * y - -kc * z) + (cd * vy - -cc * vz)
        uz -= (kd * z + -kc * y) + (cd * vz + -cc * vy)
    return uy, uz


def main() -> None:
    """Controls until the bench ends."""
    name = sys.argv[1] if len(sys.argv) > 1 else "default"
    most = int(sys.argv[2]) if len(sys.argv) > 2 else None
    count = 0
    with whirl.attach(name) as bench, bench.controller() as controller:
        for readings in controller.readings():
            controller.command(readings, [law(readings)])
            count += 1
            if count == most:
                break
    print(f"{count} commands")


if __name__ == "__main__":
    main()
