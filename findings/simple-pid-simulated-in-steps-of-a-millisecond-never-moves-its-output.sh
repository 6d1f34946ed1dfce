#!/usr/bin/env bash
# Expected: `pid(x, dt=0.001)`, the documented way for simulations, is a controller that acts each millisecond.
# What happens: a dt below `sample_time` (0.01 s by default) returns the last output, and the time is not carried over:
#   with steps of 1 or 5 ms the first output stays for ever, and a loop that should rest at 0.98 runs to 17. With
#   steps of 8 and 12 ms in turn only the long ones count: the integral is 0.6 of the right one. No warning.
# Package: simple-pid 2.0.1. Source: found by trying; `sample_time` is documented as a wait between two new outputs.
# Who is hurt: whoever tunes gains in a simulation finer than the real loop, or hands over the measured step of a loop
#   that jitters. Instead: sample_time=None wherever dt is given (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    simple-pid==2.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

from simple_pid import PID

warnings.simplefilter("error")
print("simple-pid", version("simple-pid"))


def loop(step, **options):
    """Where x' = u - x stands after 2 s."""
    pid, x = PID(20.0, 5.0, 0.0, setpoint=1.0, **options), 0.0
    for _ in range(round(2.0 / step)):
        x += step * (pid(x, dt=step) - x)
    return x


for step in (0.02, 0.01, 0.005, 0.001):
    default, free = loop(step), loop(step, sample_time=None)
    print(f"steps of {1e3 * step:g} ms: x is {default:.3f} after 2 s, with sample_time=None {free:.3f}")
    assert 0.97 < free < 0.98
    assert default == free if step >= 0.01 else default > 17.0


def integral(**options):
    """Of an error of 1 over 1 s, in steps of 8 and 12 ms in turn."""
    pid = PID(0.0, 1.0, 0.0, setpoint=1.0, **options)
    for k in range(100):
        pid(0.0, dt=0.012 if k % 2 == 0 else 0.008)
    return pid.components[1]


print(f"integral of 1 over 1 s, steps of 12 and 8 ms: {integral():.3f}, with sample_time=None "
      f"{integral(sample_time=None):.3f}")
assert abs(integral(sample_time=None) - 1.0) < 1e-9
assert abs(integral() - 0.6) < 1e-9
PROGRAM
