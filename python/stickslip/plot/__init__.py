"""Pictures of runs and sweeps. Each function gives a matplotlib Figure; `save` writes it.

`run` shows all of a run at once; `fields`, `angle_and_contact_velocity`, `trajectory`,
`phase_portrait`, `path` (from above) and `filmstrip` one thing each, in given axes if wanted;
`velocity` draws a sweep, `coils` the coils and their field, `coil_lines` what single ones do;
`animation` gives a moving picture. No module here may have the name of one of them.
"""

from stickslip.plot.above import path
from stickslip.plot.coil_map import coil_lines, coils
from stickslip.plot.curves import (
    angle_and_contact_velocity,
    fields,
    phase_portrait,
    run,
    trajectory,
)
from stickslip.plot.film import filmstrip
from stickslip.plot.moving import Animation, animation
from stickslip.plot.style import check_format, save
from stickslip.plot.velocities import velocity

__all__ = [
    "Animation",
    "angle_and_contact_velocity",
    "animation",
    "check_format",
    "coil_lines",
    "coils",
    "fields",
    "filmstrip",
    "path",
    "phase_portrait",
    "run",
    "save",
    "trajectory",
    "velocity",
]
