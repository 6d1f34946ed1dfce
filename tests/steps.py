"""Voltages of steps for the tests of stepped runs."""

import numpy as np

import stickslip

STEP = 1.0 / 1024  # s; a power of two, so that the times of a program are exact


def random_rows(seed, steps=50):
    rng = np.random.default_rng(seed)
    rows = np.zeros((steps, 5))
    rows[:, 0] = rng.uniform(-20.0, 20.0, steps)
    rows[:, 4] = rng.uniform(-15.0, 5.0, steps)
    return rows


def named(row):
    return dict(zip(stickslip.COIL_NAMES, row, strict=True))
