#!/usr/bin/env bash
# Expected: a ball thrown up from the floor, whose height is the event, gives the landing at 2 v / g; an exact zero at
#   the start adds a report at t = 0 at worst.
# What happens: a non-terminal event reports t = 0 twice and never the landing, if both fall into one Taylor step, as
#   they do for smooth flight. A start 1e-300 above the floor gives the landing. A terminal event reports both.
# Package: heyoka 7.13.2. Source: found by trying.
# Who is hurt: whoever starts on a surface, or restarts at an impact.
# Instead: a start a little off, or a terminal event (both tried). Direction `negative` reports nothing at all.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 heyoka==7.13.2
"$folder/venv/bin/python" - <<'PROGRAM'
import heyoka
import numpy as np

x, v = heyoka.make_vars("x", "v")
GRAVITY, SPEED = 9.81, 3.0
LANDING = 2 * SPEED / GRAVITY


def reports(height, drag=0.0, **options):
    found = []
    event = heyoka.nt_event(x, callback=lambda ta, t, sign: found.append(t), **options)
    flight = [(x, v), (v, -GRAVITY - drag * v)]
    heyoka.taylor_adaptive(flight, [height, SPEED], nt_events=[event]).propagate_until(2.0)
    return found


def terminal(height):
    found = []

    def call(ta, sign):
        found.append(ta.time)
        return True

    event = heyoka.t_event(x, callback=call)
    heyoka.taylor_adaptive(
        [(x, v), (v, heyoka.expression(-GRAVITY))], [height, SPEED], t_events=[event]
    ).propagate_until(2.0)
    return found


print("heyoka", heyoka.__version__, "numpy", np.__version__, f"landing at {LANDING:.4f} s")
for drag in (0.0, 0.3):
    print(f"drag {drag}: at 0", reports(0.0, drag), "at 1e-300", reports(1e-300, drag))
down = heyoka.event_direction.negative
print("terminal:", terminal(0.0), " falling only:", reports(0.0, direction=down))
for drag in (0.0, 0.3):
    assert reports(0.0, drag) == [0.0, 0.0]
    assert reports(0.0, drag, direction=down) == []
    assert len(reports(1e-300, drag)) == len(reports(1e-300, drag, direction=down)) == 1
assert abs(reports(1e-300)[0] - LANDING) < 1e-12
assert terminal(0.0)[0] == 0.0 and abs(terminal(0.0)[1] - LANDING) < 1e-12
PROGRAM
