"""What a dashboard sends to its terminal, and how long a key takes over a line that is far away or slow.

    python3 tests/reference/far_away.py target/release/whirl [keys]

Nothing but Python's own library. The dashboard runs on a pseudo-terminal of 120 x 40 cells; this program stands in for the line: it takes no more
bytes a second than the line has, and hands keys and screen on after a delay. A pseudo-terminal holds some 4 kB on its way and a
socket far more, so that a line behind ssh is felt later by the dashboard than this one.
"""

import collections
import fcntl
import os
import pty
import select
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import termios
import time

LAYOUTS = ["overview", "operator", "tuning", "whirl", "diagnosis", "loop", "runup"]
# A word of the first lines of the help and of nothing else: between words only what differs is sent.
MARK = b"recalls"


class Line:
    """A dashboard behind a line with a delay each way, and so many bytes a second at most."""

    def __init__(self, program, root, arguments, delay=0.0, rate=None):
        self.delay, self.rate = delay, rate
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.environ.update(WHIRL_ROOT=root, TERM="xterm-256color", LC_ALL="C.UTF-8")
            os.execv(program, [program, "dash", "--bench", "far", *arguments])
        fcntl.ioctl(self.fd, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
        self.keys, self.screen = collections.deque(), collections.deque()
        self.bytes, self.free_at = 0, 0.0

    def press(self, key):
        self.keys.append((time.monotonic() + self.delay, key))

    def carry(self, seconds, until=None):
        """Carries both ways; says when `until` was seen, if it was."""
        end, seen = time.monotonic() + seconds, b""
        while (now := time.monotonic()) < end:
            while self.keys and self.keys[0][0] <= now:
                os.write(self.fd, self.keys.popleft()[1])
            if now >= self.free_at and select.select([self.fd], [], [], 0.001)[0]:
                try:
                    got = os.read(self.fd, 65536 if self.rate is None else 1024)
                except OSError:
                    # The dashboard has ended.
                    return None
                self.bytes += len(got)
                if self.rate is not None:
                    self.free_at = max(now, self.free_at) + len(got) / self.rate
                self.screen.append((time.monotonic() + self.delay, got))
            elif now < self.free_at:
                time.sleep(min(0.001, self.free_at - now))
            while self.screen and self.screen[0][0] <= now:
                seen = (seen + self.screen.popleft()[1])[-65536:]
                if until is not None and until in seen:
                    return now
        return None

    def close(self):
        os.kill(self.pid, signal.SIGTERM)
        self.carry(0.5)
        os.waitpid(self.pid, 0)
        os.close(self.fd)


def bytes_a_second(program, root, layout, fps):
    line = Line(program, root, ["--layout", layout, "--fps", str(fps)])
    line.carry(4)
    before, began = line.bytes, time.monotonic()
    line.carry(5)
    rate = (line.bytes - before) / (time.monotonic() - began)
    line.close()
    return rate


def key_to_screen(program, root, delay, rate, fps):
    """Of twenty times the help, from its key to the first line of it on the screen."""
    line = Line(program, root, ["--layout", "overview", "--fps", str(fps)], delay, rate)
    line.carry(8)
    before, began = line.bytes, time.monotonic()
    line.carry(4)
    used = (line.bytes - before) / (time.monotonic() - began)
    times = []
    for _ in range(20):
        pressed = time.monotonic()
        line.press(b"?")
        seen = line.carry(20, MARK)
        if seen is None:
            raise SystemExit("the help did not come within 20 s")
        times.append(seen - pressed)
        line.press(b"\x1b")
        line.carry(1.0 + 2 * delay)
    line.close()
    return times, used


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as root:
        environment = dict(os.environ, WHIRL_ROOT=root)
        bench = subprocess.Popen(
            [program, "sim", "three-mass", "--bench", "far"], env=environment, stdout=subprocess.DEVNULL
        )
        try:
            time.sleep(2)
            print("kB a second at 120 x 40, at --fps 30, 10, 2")
            for layout in LAYOUTS if "keys" not in sys.argv[2:] else []:
                rates = [bytes_a_second(program, root, layout, fps) / 1e3 for fps in (30, 10, 2)]
                print(f"  {layout:10} " + "  ".join(f"{rate:7.1f}" for rate in rates), flush=True)
            print("key to screen: delay each way, line, --fps: median and worst of 20, what the dashboard sends")
            for delay, rate, fps in [(0, None, 30), (0.05, None, 30), (0.05, 100e3, 30), (0.05, 20e3, 30), (0.05, 20e3, 2)]:
                times, used = key_to_screen(program, root, delay, rate, fps)
                of = "unlimited" if rate is None else f"{rate / 1e3:.0f} kB/s"
                median, worst = 1e3 * statistics.median(times), 1e3 * max(times)
                print(f"  {1e3 * delay:.0f} ms  {of:10} {fps:3}: {median:.0f} ms, {worst:.0f} ms, {used / 1e3:.1f} kB/s", flush=True)
        finally:
            bench.terminate()
            bench.wait()


main()
