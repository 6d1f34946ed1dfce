"""Independent reference simulator: Moreau time stepping of the magnetic block on a plane.

It exists to disagree with the product if one of the two is wrong. It therefore shares nothing with
it: the coil field is a sum of finite straight wires (differentiated numerically), the contact is
solved at velocity and impulse level on a fixed step instead of by events, and the waveform and the
circuit are written anew. Only numpy and numba are needed.

    run = simulate_reference(dict(mode="IPP", frequency=100.0, base=0.5e-3, hold=1e-3, pulses=20))
    run.mean_velocity        # m/s

A robot that turns has a reference of its own: a rigid body with eight corners, `walk.py: walk`,
which knows no plane of motion, no edge and no heading but what comes out.
"""

from .convergence import ConvergenceReport, converge_reference
from .drive import Voltages, voltages_of
from .field import CENTRE_FIELD_PER_AMPERE, coil_field, coil_gradient, coil_wires
from .simulate import ReferenceRun, simulate_reference
from .statics import static_tilt_reference

__all__ = [
    "CENTRE_FIELD_PER_AMPERE",
    "ConvergenceReport",
    "ReferenceRun",
    "Voltages",
    "coil_field",
    "coil_gradient",
    "coil_wires",
    "converge_reference",
    "simulate_reference",
    "static_tilt_reference",
    "voltages_of",
]
