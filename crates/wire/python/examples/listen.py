"""Reads every step of a running bench for so many seconds, and says what was lost and what it cost.

    python crates/wire/python/examples/listen.py lab 60
"""

import resource
import sys
import time

import whirl


def spent() -> float:
    """Processor time of this process so far, in seconds."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def main() -> None:
    """Reads, and says how it went."""
    name, seconds = sys.argv[1], float(sys.argv[2])
    steps, lost = 0, 0
    with whirl.attach(name) as bench:
        began, worked = time.monotonic(), spent()
        for block in bench.steps(timeout=5.0):
            steps += len(block)
            lost += block.lost
            if time.monotonic() - began >= seconds:
                break
        elapsed, cost = time.monotonic() - began, spent() - worked
    print(f"{steps} steps in {elapsed:.1f} s ({steps / elapsed:.0f}/s), {lost} lost, {100 * cost / elapsed:.0f} % of a core")


if __name__ == "__main__":
    main()
