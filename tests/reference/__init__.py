"""Independent reference simulator: Moreau time stepping of the magnetic block on a plane.

It exists to disagree with the product if one of the two is wrong, and shares nothing with it: the
coil field is a sum of finite straight wires (differentiated numerically), the contact is solved at
velocity and impulse level on a fixed step instead of by events, and the waveform and the circuit
are written anew. Only numpy, scipy and numba are needed.

    run = simulate_reference(dict(mode="IPP", frequency=100.0, base=0.5e-3, hold=1e-3, pulses=20))
    run.mean_velocity        # m/s

Walks of a robot that turns are stored, see `tests/data/README.md`.
"""

from .field import coil_field, coil_wires
from .simulate import simulate_reference, static_tilt_reference

__all__ = ["coil_field", "coil_wires", "simulate_reference", "static_tilt_reference"]
