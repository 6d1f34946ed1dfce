"""Effects of the user's own in C, numba and Python: the same bits, and the life of a function."""

import ctypes
import gc
import os
import shlex
import subprocess
import threading

import numpy as np
import pytest

from helpers import run, scenario
from own_effects import (
    C_SOURCE,
    PULSES,
    by_method,
    nothing_stays,  # noqa: F401 (around every test here)
    numba_wrench,
    parameter,
    python_wrench,
    register,
    unregister,
)
from stickslip import _core, simulate_batch
from stickslip.scenario.effects import EffectState


@pytest.fixture(scope="module")
def c_library(tmp_path_factory):
    # The compiler that the package was built with is there, and takes C as well.
    compiler = os.environ.get("CXX", "c++")
    folder = tmp_path_factory.mktemp("c")
    (folder / "wrench.c").write_text(C_SOURCE)
    # No fused multiply-add, which the others do not have.
    subprocess.run(
        [*shlex.split(compiler), "-x", "c", "wrench.c", "-O2", "-ffp-contract=off", "-shared",
         "-fPIC", "-o", "wrench.so"],
        cwd=folder,
        check=True,
    )  # fmt: skip
    return ctypes.CDLL(str(folder / "wrench.so"))


CALLBACK = ctypes.CFUNCTYPE(None, *3 * [ctypes.POINTER(ctypes.c_double)])


@CALLBACK
def ctypes_callback(state, parameters, out):
    out[0], out[1], out[2] = python_wrench(EffectState(*state[:9]), parameters[:2])


@by_method
def test_every_language_gives_the_same_bits(method, c_library):
    functions = {
        "numba": numba_wrench,
        "address": numba_wrench.address,
        "numpy_integer": np.uint64(numba_wrench.address),
        "c": c_library.wrench,
        "callback": ctypes_callback,
        "python": python_wrench,
    }
    values = [parameter("a", low=0.0, unit="N s/m"), parameter("b")]
    velocities = {}
    for name, function in functions.items():
        register(function, *values, name=name)
        keys = {f"effects.{name}.a": 4e-6, f"effects.{name}.b": 3e-5, "solver.method": method}
        velocities[name] = run(PULSES, keys).mean_velocity
    assert len(set(velocities.values())) == 1, velocities
    plain = run(PULSES, {"solver.method": method}).mean_velocity
    assert abs(velocities["c"] / plain - 1.0) > 0.01


def test_a_function_may_return_anything_of_three_numbers():
    register(lambda state, parameters: np.array([1e-7, 0.0, 0.0]) * parameters[0], name="array")
    register(lambda state, parameters: [1e-7 * parameters[0], 0, 0], name="list")
    array, listed = (run(PULSES, {f"effects.{name}.k": 1.0}) for name in ("array", "list"))
    assert array.mean_velocity == listed.mean_velocity


@pytest.mark.nightly
def test_the_function_is_kept_as_long_as_it_is_in_use():
    class Force:
        def __call__(self, state, parameters):
            return parameters[0] * 1e-7, 0.0, 0.0

    register(Force())
    core = scenario(PULSES, {"effects.own.k": 1.0}).to_core()
    expected = _core.simulate_batch([core])[0].mean_velocity
    gc.collect()
    assert _core.simulate_batch([core])[0].mean_velocity == expected
    unregister("own")
    gc.collect()
    assert _core.simulate_batch([core])[0].mean_velocity == expected


def test_python_functions_on_many_threads_do_not_lock_each_other():
    register(python_wrench, parameter("a"), parameter("b"))
    keys = [{"effects.own.a": 1e-6 * i} for i in range(4)]
    expected = [run(PULSES, each).mean_velocity for each in keys]
    found = [None] * 4

    def work(i):
        runs = simulate_batch(3 * [scenario(PULSES, keys[i])], threads=2)
        found[i] = {each.mean_velocity for each in runs}

    threads = [threading.Thread(target=work, args=(i,), daemon=True) for i in range(4)]
    for each in threads:
        each.start()
    for each in threads:
        each.join(timeout=60.0)
    assert found == [{each} for each in expected]
