#!/usr/bin/env bash
# Expected: beyond its table an `interpolant` goes on as at the end, keeps the last value, or refuses; "bspline" differs
#   from "linear" in smoothness.
# What happens: "linear" goes on along its last piece, "bspline" is exactly 0 with a gradient of 0, from the first step
#   beyond the table on: of a pull of 1.0 N at 1 mm, the end, nothing is left 1 nm further, in one direction of two of a
#   map as well. A body on a spring whose table ends at 1 mm swings to 1.10 mm with the linear law and leaves for ever
#   with the spline, at a constant speed; below the end of the table the two agree. The integrator reports no error.
# Package: casadi 3.8.2, numpy 2.4.6. Source: found by trying; the page of `interpolant` says nothing of outside.
# Who is hurt: whoever simulates, fits or plans with a measured force, stiffness or magnet; an optimiser sees a flat 0.
# Instead: a table that is longer than any way (tried), or the argument limited by fmin and fmax (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 casadi==3.8.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import casadi
import numpy as np

print(*(f"{name} {version(name)}" for name in ("casadi", "numpy")))
x, speed = casadi.MX.sym("x"), casadi.MX.sym("speed")


def law(kind, places, forces):
    """A force in N over a place in mm, and its gradient."""
    force = casadi.interpolant("force", kind, [places], forces)
    return force, casadi.Function("gradient", [x], [casadi.jacobian(force(x), x)])


def furthest(pull):
    """How far a body of natural period 0.63 s gets that starts at 11 mm/s, and its speeds late on."""
    state = casadi.vertcat(x, speed)
    ode = {"x": state, "ode": casadi.vertcat(speed, pull(x))}
    out = np.array(casadi.integrator("swing", "cvodes", ode, 0, np.linspace(0.02, 2, 100).tolist())(x0=[0, 11])["xf"])
    return out[0].max(), out[1, -20:]


gap = np.linspace(0.1, 1.0, 10)
for kind in ("linear", "bspline"):
    pull, gradient = law(kind, gap, 1 / gap**2)
    seen = [(float(pull(at)), float(gradient(at))) for at in (0.999, 1.0, 1.0 + 1e-6, 1.1, 0.0999)]
    print(f"{kind} at 0.999, 1, 1.000001, 1.1 and 0.0999 mm: " + ", ".join(f"{force:.3f} ({slope:.2f})" for force, slope in seen))
    assert abs(seen[1][0] - 1) < 1e-9 and seen[1][1] < -2
    if kind == "bspline":
        assert all(force == 0 and slope == 0 for force, slope in seen[2:])
    else:
        assert abs(seen[2][0] - 1) < 1e-5 and 0.5 < seen[3][0] < 1 and seen[4][0] > 100
sides = np.linspace(0, 1, 6)
table = (np.add.outer(sides, 2 * sides) + 1).ravel(order="F")
maps = [casadi.interpolant("map", kind, [sides, sides], table) for kind in ("linear", "bspline")]
beyond = [float(one([0.5, 1.05])) for one in maps]
print("a map that rises to 4, beside its edge:", beyond)
assert abs(beyond[0] - 3.6) < 1e-9 and beyond[1] == 0
place = np.linspace(-1, 1, 21)
ways = {}
for kind in ("linear", "bspline"):
    ways[kind], late = furthest(law(kind, place, -100 * place)[0])
    print(f"spring, {kind}: furthest {ways[kind]:.2f} mm, late speeds {late.min():.2f} to {late.max():.2f} mm/s")
assert abs(ways["linear"] - 1.1) < 0.01 and ways["bspline"] > 9 and np.ptp(late) < 1e-9
longer = np.linspace(-2, 2, 41)
far, _ = furthest(law("bspline", longer, -100 * longer)[0])
kept = law("bspline", gap, 1 / gap**2)[0](casadi.fmin(casadi.fmax(x, 0.1), 1.0))
held = float(casadi.Function("kept", [x], [kept])(1.2))
print(f"longer table: furthest {far:.2f} mm; limited argument at 1.2 mm: {held:.3f} N")
assert abs(far - 1.1) < 0.01 and abs(held - 1) < 1e-9
PROGRAM
