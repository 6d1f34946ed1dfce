#!/usr/bin/env bash
# Expected: with several events and a root finder the solve ends at the earliest root: a body that meets one wall at
#   0.34 s and another at 0.55 s stops at 0.34 s.
# What happens: where both signs change within one step, the event that stands first in cond_fn wins, whatever its time.
#   The body is stopped at 0.55 s, deep in the other wall, with event_mask and result as usual.
# Packages: diffrax 0.7.2, optimistix 0.1.0, jax 0.10.2. Source: found by trying.
# Who is hurt: whoever has two walls, two feet or stick and slip as events; most at loose tolerances.
# Instead: one event, the smallest of them, where all start positive, or steps shorter than the least time between two
#   events (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 jax==0.10.2 jaxlib==0.10.2 diffrax==0.7.2 optimistix==0.1.0 equinox==0.13.8
"$folder/venv/bin/python" - <<'PROGRAM'
import diffrax
import jax
import jax.numpy as jnp
import optimistix

jax.config.update("jax_enable_x64", True)
force = diffrax.ODETerm(lambda t, y, args: jnp.array([-1.0 - t, -1.0 - t]))


def late(t, y, args, **kwargs):
    return y[0] - 0.3


def early(t, y, args, **kwargs):
    return y[1] - 0.6


def both(t, y, args, **kwargs):
    return jnp.minimum(y[0] - 0.3, y[1] - 0.6)


def end(conditions, longest=None):
    run = diffrax.diffeqsolve(
        force, diffrax.Dopri5(), 0.0, 5.0, 0.01, jnp.ones(2),
        event=diffrax.Event(conditions, optimistix.Newton(1e-10, 1e-10)),
        stepsize_controller=diffrax.PIDController(rtol=1e-4, atol=1e-4, dtmax=longest),
    )
    return float(run.ts[0]), float(run.ys[0, 1])


first, second = (2 * (1 - 0.6) + 1) ** 0.5 - 1, (2 * (1 - 0.3) + 1) ** 0.5 - 1
assert abs(end((early, late))[0] - first) < 1e-8
wrong, place = end((late, early))
assert abs(wrong - second) < 1e-8 and place < 0.31
assert abs(end((late, early), longest=0.05)[0] - first) < 1e-8
assert abs(end(both)[0] - first) < 1e-8
print("diffrax", diffrax.__version__, "optimistix", optimistix.__version__, "jax", jax.__version__)
print(f"roots at {first:.4f} and {second:.4f}")
print(f"(early, late) ends at {end((early, late))[0]:.4f}; (late, early) at {wrong:.4f}")
print(f"where the coordinate whose wall is at 0.6 has come to {place:.2f}")
PROGRAM
