"""What makes the kernel of the eight corners quick to compile: records, and bare functions."""

import numpy as np
from numba import njit

# A function that only compiled ones call needs no entry from Python. With `njit` and named tuples
# of arrays the kernel takes twice as long to compile, and five times as long to run.
inner = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


def record(floats: dict, integers: dict | None = None) -> np.void:
    """Arrays of zeros, by name with their shapes, that are one argument to a compiled function."""
    kinds = ((floats, np.float64), (integers or {}, np.int64))
    dtype = [(name, kind, shape) for shapes, kind in kinds for name, shape in shapes.items()]
    return np.zeros(1, np.dtype(dtype))[0]
