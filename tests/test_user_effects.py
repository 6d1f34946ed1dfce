"""Effects of the user's own: wherever the model's own work, in C, numba and Python, and refused."""

import ctypes
import gc
import math
import multiprocessing
import os
import shlex
import signal
import subprocess
import threading
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
import xarray
from click.testing import CliRunner
from numba import cfunc

import stickslip
from helpers import ADHESION, WEIGHT, run, scenario
from own_effects import (
    C_SOURCE,
    METHODS,
    PULSES,
    ROUNDING,
    SIGNATURE,
    by_method,
    nothing,
    nothing_stays,  # noqa: F401 (around every test here)
    numba_wrench,
    parameter,
    python_wrench,
    register,
    unregister,
)
from stickslip import Scenario, ScenarioError, _core, load, simulate, simulate_batch, sweep
from stickslip.cli.commands import stickslip as command
from stickslip.scenario.effects import EffectState


@by_method
def test_at_its_defaults_it_is_absent_to_the_last_bit(method):
    calls = []
    register(lambda state, parameters: calls.append(state), parameter(default=0.25))
    keys = {**PULSES, "solver.method": method}
    with_it = run(keys, {"effects.own.k": 0.25}, rate=2e3)
    at_core = scenario(keys).to_core()
    at_core.set("effects.own.k", 0.25)
    assert with_it.scenario == scenario(keys, {"record.rate": 2e3})
    assert _core.simulate_batch([at_core])[0].mean_velocity == with_it.mean_velocity
    assert calls == []
    unregister("own")
    without = run(keys, rate=2e3)
    for array in ("t", "x", "z", "theta", "vx", "vz", "omega", "normal_force", "friction_force"):
        assert np.array_equal(getattr(with_it, array), getattr(without, array)), array
    assert with_it.summary() == without.summary()


def test_it_is_listed_and_checked_like_the_others(tmp_path):
    before = stickslip.effects()
    keys = Scenario.keys()
    register(nothing, parameter("k", unit="N"), parameter("length", low=1e-6, default=1e-3))
    assert stickslip.effects()[: len(before)] == before
    own = stickslip.effects()[-1]
    assert (own.name, own.meaning) == ("own", "an effect of a test")
    assert [key.name for key in own.parameters] == ["effects.own.k", "effects.own.length"]
    assert own.parameters[0].allowed == "a number from -1 to 1 N"
    assert own.parameters[1].default == 1e-3
    assert Scenario.keys() == (*keys, "effects.own.k", "effects.own.length")

    changed = Scenario().replace({"effects.own.k": 0.5})
    assert changed.get("effects.own.k") == 0.5
    assert changed.get("effects.own.length") == 1e-3
    assert changed == Scenario(effects={"own": {"k": 0.5}})
    changed.to_toml(tmp_path / "own.toml")
    assert load(tmp_path / "own.toml") == changed
    with pytest.raises(ScenarioError, match=r"effects\.own\.k = 2\.0: allowed is a number from"):
        changed.replace({"effects.own.k": 2.0})
    with pytest.raises(ScenarioError, match=r'did you mean "effects\.own\.length"'):
        changed.replace({"effects.own.lenght": 1e-3})

    text = CliRunner().invoke(command, ["effects", "own"]).output
    assert "[effects.own]" in text
    assert "k: of a test; a number from -1 to 1 N; default 0.0" in text
    assert "length = 0.001" in CliRunner().invoke(command, ["keys", "effects.own"]).output

    unregister("own")
    assert stickslip.effects() == before
    assert Scenario.keys() == keys
    with pytest.raises(ScenarioError, match="has to be registered first"):
        load(tmp_path / "own.toml")
    with pytest.raises(ScenarioError, match=r"effects\.own\.k: there is no such key; an effect of"):
        simulate(changed)


def test_an_effect_that_is_registered_again_takes_the_place_of_the_old_one():
    register(lambda state, parameters: (1e-7, 0.0, 0.0))
    scenario_of_both = scenario(PULSES, {"effects.own.k": 1.0})
    pushed = simulate(scenario_of_both).mean_velocity
    assert pushed > 1.001 * run(PULSES).mean_velocity
    register(nothing)
    register(numba_wrench, name="compiled")
    register(numba_wrench.address, name="compiled")
    assert _core.registered_effects() == ["own", "compiled"]
    # Also in a scenario that is there already.
    unmoved = pytest.approx(run(PULSES).mean_velocity, rel=ROUNDING)
    assert simulate(scenario_of_both).mean_velocity == unmoved
    assert run(PULSES, {"effects.own.k": 1.0}).mean_velocity == unmoved
    register(nothing, parameter("length"))
    with pytest.raises(ScenarioError, match=r"effects\.own\.k: there is no such key"):
        simulate(scenario_of_both)


def test_keys_that_have_one_name_in_a_dataset_cannot_be_varied_together(tmp_path):
    register(nothing, parameter("tilt_angle", low=-1.0), name="surface")
    both = {"effects.surface_tilt.angle": [0.0, 0.01], "effects.surface.tilt_angle": [0.5]}
    with pytest.raises(ScenarioError, match=r"cannot vary it beside effects\.surface_tilt\.angle"):
        sweep(scenario(PULSES), both)
    file = tmp_path / "sweep.nc"
    own = {"effects.surface.tilt_angle": [0.0, 1.0]}
    seen = sweep(scenario(PULSES), own, threads=1, out=file)
    assert seen.mean_velocity.dims == ("effects_surface_tilt_angle",)
    xarray.testing.assert_identical(sweep(scenario(PULSES), own, out=file, resume=True), seen)


def test_several_act_together():
    register(lambda state, parameters: (parameters[0] * 1e-7, 0.0, 0.0), name="b")
    register(lambda state, parameters: (parameters[0] * 2e-7, 0.0, 0.0), name="a")
    register(lambda state, parameters: (parameters[0] * 3e-7, 0.0, 0.0), name="c")
    together = run(PULSES, {"effects.b.k": 0.5, "effects.a.k": 0.5})
    reversed_ = run(PULSES, {"effects.a.k": 0.5, "effects.b.k": 0.5})
    assert together.mean_velocity == reversed_.mean_velocity
    alone = run(PULSES, {"effects.c.k": 0.5})
    assert together.mean_velocity == pytest.approx(alone.mean_velocity, rel=ROUNDING)


REGISTERED_THERE = """
import stickslip
stickslip.register_effect(
    "own",
    lambda state, parameters: (parameters[0] * 1e-7, 0.0, 0.0),
    [stickslip.EffectParameter(name="k", unit="-", low=-1.0, high=1.0, meaning="of a test")],
    meaning="an effect of a test",
)
"""


@pytest.mark.parametrize("initializer", ["", REGISTERED_THERE], ids=["unregistered", "registered"])
def test_other_processes_must_register_it_too(initializer):
    namespace = {}
    exec(REGISTERED_THERE, namespace)
    keys = {"effects.own.k": [0.0, 0.5, 1.0]}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        1, mp_context=context, initializer=exec, initargs=(initializer, {})
    ) as executor:
        if not initializer:
            with pytest.raises(ValueError, match="has to be registered in this process too"):
                sweep(scenario(PULSES), keys, executor=executor)
            return
        there = sweep(scenario(PULSES), keys, executor=executor)
    xarray.testing.assert_identical(there, sweep(scenario(PULSES), keys, threads=1))


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


class BoomError(Exception):
    pass


def test_an_exception_of_the_function_passes_through():
    def fails(state, parameters):
        if state.t > 0.06:
            raise BoomError(f"at {state.t:.3f} s")
        return 0.0, 0.0, 0.0

    register(fails)
    for method in METHODS:
        for rate in ("none", "events", 1e5):
            failing = scenario(
                PULSES, {"effects.own.k": 1.0, "solver.method": method, "record.rate": rate}
            )
            with pytest.raises(BoomError, match=r"at 0\.06"):
                simulate(failing)
            for threads in (1, 2):
                with pytest.raises(BoomError):
                    simulate_batch(4 * [failing], threads=threads)
    for threads in (1, 2):
        with pytest.raises(BoomError) as caught:
            sweep(scenario(PULSES), {"effects.own.k": [0.0, 0.5, 1.0]}, threads=threads)
        assert caught.traceback[-1].name == "fails"
    # It is over with that: nothing is left behind for the next run.
    assert run(PULSES).ok


@by_method
@pytest.mark.parametrize("peak", [0.0, 2.5e-3])  # T; at rest without
@pytest.mark.parametrize(("component", "bad"), [(0, math.nan), (1, math.inf), (2, -math.inf)])
def test_a_force_that_is_not_finite_is_a_status(method, peak, component, bad):
    @cfunc(SIGNATURE)
    def broken(state, parameters, wrench):
        wrench[0] = wrench[1] = wrench[2] = 0.0
        if state[0] > 0.06 and parameters[0] > 0.5:
            wrench[component] = bad

    register(broken)
    drive = {**PULSES, "drive.base": 0.0, "drive.peak": peak}
    failed = simulate(scenario(drive, {"effects.own.k": 1.0, "solver.method": method}))
    assert failed.status == "not_finite"
    assert failed.message.startswith("at t = 0.06")
    assert "the function of effect own gave a force or torque that is not a" in failed.message
    seen = sweep(
        scenario(drive, {"solver.method": method}), {"effects.own.k": [0.4, 0.9]}, threads=2
    )
    assert list(seen.status.values == 0) == [True, False]
    assert np.isnan(seen.mean_velocity.values[1])


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_compiled_function_that_fails_gives_no_force_of_zero():
    @cfunc(SIGNATURE)
    def fails(state, parameters, wrench):
        # numba prints the error and returns: nothing is written.
        force = parameters[0] * 1e-9 / (0.0 if state[0] > 0.06 else 1.0)
        wrench[0] = force
        wrench[1] = wrench[2] = 0.0

    register(fails)
    failed = simulate(scenario(PULSES, {"effects.own.k": 1.0}))
    assert failed.status == "not_finite"
    assert failed.message.startswith("at t = 0.06")


def test_a_force_that_grows_without_bound_ends():
    register(lambda state, parameters: (0.0, 1e300 * parameters[0] * state.t, 0.0))
    for method in METHODS:
        ended = simulate(scenario(PULSES, {"effects.own.k": 1.0, "solver.method": method}))
        assert ended.status != "ok"


@pytest.mark.parametrize(
    "result", [None, 1.0, (1.0, 2.0), (1.0, 2.0, 3.0, 4.0), ("a", 0.0, 0.0), (1j, 0.0, 0.0)]
)
def test_a_function_that_returns_something_else(result):
    register(lambda state, parameters: result)
    with pytest.raises(TypeError, match=r"effect own: its function returned .*three numbers"):
        simulate(scenario(PULSES, {"effects.own.k": 1.0}))


def test_the_ends_of_a_range_are_printed_short_and_allowed():
    register(nothing, parameter(low=1 / 3, high=0.1 + 0.2 + 1 / 3, default=0.5), name="ends")
    with pytest.raises(stickslip.ScenarioError, match=r"a number from 0\.333334 to 0\.633333"):
        stickslip.Scenario(effects={"ends": {"k": 9.0}})
    for end in (0.333334, 0.633333):
        assert stickslip.Scenario(effects={"ends": {"k": end}}).effects["ends"]["k"] == end


STILL = {"drive.base": 0.0, "drive.peak": 0.0, "drive.hold": 0.0, "drive.pulses": 1}


def test_a_force_that_breaks_a_long_rest_for_a_moment_is_not_overlooked():
    # A push along x of 2 ms beyond the friction limit, amid 10 s of rest without field.
    middle, width = 6.2, 1e-3

    @cfunc(SIGNATURE)
    def push(state, parameters, wrench):
        wrench[0] = parameters[0] * math.exp(-(((state[0] - middle) / width) ** 2))
        wrench[1] = wrench[2] = 0.0

    register(push)
    made = run(STILL, {"drive.ramp": 10.0, "effects.own.k": 0.2e-6}, rate="events")
    # Sliding begins where the push equals the friction of weight and adhesion.
    still = middle - width * math.sqrt(math.log(0.2e-6 / (0.2 * (WEIGHT + ADHESION))))
    assert made.t[0] == pytest.approx(still, rel=1e-9)
    assert made.x[-1] > 0.0


def test_rest_under_an_effect_can_be_stopped():
    # Hours of rest in one segment, looked at every fraction of a millisecond. How far it came is
    # written down, as a limit on the clock would be that of one machine.
    copy, reached = ctypes.CDLL(None).memcpy, ctypes.c_double()
    copy.argtypes = ctypes.c_size_t, ctypes.POINTER(ctypes.c_double), ctypes.c_size_t
    copy.restype, place = ctypes.c_size_t, ctypes.addressof(reached)

    @cfunc(SIGNATURE)
    def none(state, parameters, wrench):
        copy(place, state, 8)
        wrench[0] = wrench[1] = wrench[2] = 0.0

    register(none)
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        simulate(scenario(STILL, {"drive.ramp": 1e4, "effects.own.k": 1.0}))
    assert 0.0 < reached.value < 5e3  # s, of 1e4
    timer.join()
