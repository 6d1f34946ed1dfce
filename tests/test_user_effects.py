"""Effects of the user's own: the same answers as theory and as the model's own effects."""

import ctypes
import gc
import math
import multiprocessing
import shutil
import subprocess
import threading
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
import xarray
from click.testing import CliRunner
from numba import carray, cfunc

import stickslip
from helpers import (
    ADHESION,
    GRAVITY,
    HEIGHT,
    LENGTH,
    MASS,
    NO_FIELD,
    WEIGHT,
    run,
    scenario,
    still_for,
)
from stickslip import (
    EffectParameter,
    Scenario,
    ScenarioError,
    _core,
    register_effect,
    simulate,
    simulate_batch,
    sweep,
    unregister_effect,
)
from stickslip.cli.commands import stickslip as command
from stickslip.keys import known_keys
from stickslip.sweeping.points import short_name

SIGNATURE = "void(CPointer(float64), CPointer(float64), CPointer(float64))"
PULSES = {"drive.base": 0.5e-3, "drive.pulses": 10}
METHODS = ["tsit5", "arkode"] if _core.has_arkode else ["tsit5"]

# The same forces in the same steps, computed in another order. A step's rounding of 1e-16 and an
# event's place, 1e-12 of a step, add up over some 1e4 steps at most.
ROUNDING = 1e-8

by_method = pytest.mark.parametrize("method", METHODS)


@pytest.fixture(autouse=True)
def _nothing_stays():
    yield
    for name in _core.registered_effects():
        unregister_effect(name)


def parameter(name="k", low=-1.0, high=1.0, unit="-", **more):
    return EffectParameter(name=name, unit=unit, low=low, high=high, meaning="of a test", **more)


def register(function, *parameters, name="own"):
    register_effect(name, function, parameters or [parameter()], meaning="an effect of a test")


def nothing(state, parameters):
    return 0.0, 0.0, 0.0


# What is known in closed form.


@by_method
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_part_of_the_weight_along_the_surface_is_its_tilt(method, direction):
    @cfunc(SIGNATURE)
    def tilt(state, parameters, wrench):
        angle = parameters[0]
        wrench[0] = MASS * GRAVITY * math.sin(angle)
        wrench[1] = MASS * GRAVITY * (1.0 - math.cos(angle))
        wrench[2] = 0.0

    register(tilt, parameter("angle", unit="rad"))
    keys = {**PULSES, "solver.method": method, "drive.direction": direction}
    level = run(keys)
    for angle in (0.02, -0.05):
        own = run(keys, {"effects.own.angle": angle})
        built_in = run(keys, {"effects.surface_tilt.angle": angle})
        assert own.mean_velocity == pytest.approx(built_in.mean_velocity, rel=ROUNDING)
        assert abs(own.mean_velocity / level.mean_velocity - 1.0) > 0.01
        assert own.summary()["events"] == built_in.summary()["events"]


@by_method
def test_a_drag_by_velocity_is_more_linear_drag(method):
    @cfunc(SIGNATURE)
    def drag(state_, parameters, wrench_):
        state, wrench = carray(state_, 9), carray(wrench_, 3)
        wrench[:2] = -parameters[0] * state[4:6]
        wrench[2] = 0.0

    register(drag, parameter("c", low=0.0, unit="N s/m"))
    keys = {**PULSES, "solver.method": method}
    own = run(keys, {"effects.own.c": 5e-6})
    more = run(keys, {"drag.linear": Scenario().drag.linear + 5e-6})
    assert own.mean_velocity == pytest.approx(more.mean_velocity, rel=ROUNDING)
    assert abs(own.mean_velocity / run(keys).mean_velocity - 1.0) > 0.01


PRESSED = WEIGHT + ADHESION
RISE = 0.1  # s, of a force from zero to the one at which rest ends


@by_method
@pytest.mark.parametrize(
    ("component", "needed", "event"),
    [
        (0, 0.2 * PRESSED, "slip_start"),  # the friction limit; before it, no end lifts
        (0, -0.2 * PRESSED, "slip_start"),
        (1, PRESSED, "tip"),  # both ends, and by rounding one of them first
        (2, 0.5 * LENGTH * PRESSED, "tip"),  # nose-down, about the front's lower corner
        (2, -0.5 * LENGTH * PRESSED, "tip"),
    ],
)
def test_rest_ends_where_a_rising_force_says(method, component, needed, event):
    def rising(state, parameters):
        wrench = [0.0, 0.0, 0.0]
        wrench[component] = parameters[0] * needed * state.t / RISE
        return wrench

    register(rising)
    keys = {**still_for(1.2 * RISE), "effects.own.k": 1.0, "solver.method": method}
    seen = run(keys, rate="events")
    names = [seen.event_names[kind] for kind in seen.event]
    assert names[0] == event
    # The place of an event, 1e-12 of a look; the reaction it is taken from, 1e-16 of the force.
    assert seen.t[0] == pytest.approx(RISE, rel=1e-10)
    held = run(keys, {"effects.own.k": 0.8}, rate="events")
    assert held.t.size == 0


@by_method
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_a_constant_force_slides_the_block_along_a_parabola(method, direction):
    force = 0.5 * PRESSED  # its torque about the lower edge, with friction's, tips nothing

    def push(state, parameters):
        return parameters[0] * force, 0.0, 0.0

    register(push)
    keys = {**still_for(0.05), "drag.linear": 0.0, "drive.direction": direction}
    keys |= {"solver.method": method}
    for sign in (1.0, -1.0):
        seen = run(keys, {"effects.own.k": sign}, rate=1e3)
        acceleration = sign * (force - 0.145 * PRESSED) / MASS
        # A polynomial of second order in time is exact for both methods.
        assert seen.x == pytest.approx(0.5 * acceleration * seen.t**2, rel=1e-9, abs=1e-18)
        assert seen.vx == pytest.approx(acceleration * seen.t, rel=1e-9, abs=1e-18)


def test_in_flight_force_and_torque_move_the_body_freely():
    # 1 mm above the surface or more, so that nothing touches again.
    lift, torque = 3.0 * PRESSED, 1e-12

    def away(state, parameters):
        return 0.0, lift, torque

    register(away)
    keys = {**still_for(0.02), "effects.own.k": 1.0, "drag.linear": 0.0, "drag.rotational": 0.0}
    seen = run(keys, rate=1e3)
    inertia = MASS * (LENGTH**2 + HEIGHT**2) / 12
    t = seen.t[1:]
    assert seen.z[1:] - seen.z[0] == pytest.approx(0.5 * (lift - WEIGHT) / MASS * t**2, rel=1e-9)
    assert seen.theta[1:] == pytest.approx(0.5 * torque / inertia * t**2, rel=1e-9)
    assert seen.theta[-1] > 0.5


# What the function is told.


@by_method
@pytest.mark.parametrize("direction", ["+x", "-x"])
def test_the_function_is_told_what_a_recording_says(method, direction):
    told = {}

    def listen(state, parameters):
        assert parameters == (0.25, 0.5)
        told[state.t] = state
        return 0.0, 0.0, 0.0

    register(listen, parameter("a"), parameter("b", default=0.5))
    keys = {**PULSES, "solver.method": method, "drive.direction": direction}
    seen = run(keys, {"effects.own.a": 0.25}, rate=2e3)
    compared = 0
    for row in np.flatnonzero(seen.contact):  # in flight a recording asks for no force
        if seen.t[row] not in told:
            continue  # the clock of a stretch and that of the recording differ by a rounding
        state = told[seen.t[row]]
        compared += 1
        names = ("x", "z", "theta", "vx", "vz", "omega")
        recorded = [getattr(seen, name)[row] for name in names]
        assert [getattr(state, name) for name in names] == pytest.approx(
            recorded, rel=1e-12, abs=1e-18
        )
        assert (state.Bx, state.Bz) == pytest.approx((seen.bx[row], seen.bz[row]), rel=1e-12)
    assert compared > 50
    times = np.array(list(told))
    assert times.min() >= 0.0
    assert times.max() <= seen.scenario.duration * (1 + 1e-12)


# One function in three languages.

C_SOURCE = """
void wrench(const double* state, const double* parameters, double* out) {
    out[0] = -parameters[0] * state[4] + parameters[1] * state[7] * state[3];
    out[1] = -parameters[0] * state[5] + parameters[1] * state[8] * state[1];
    out[2] = -parameters[1] * 1e-9 * state[6] * (state[0] + state[2]);
}
"""


@cfunc(SIGNATURE)
def numba_wrench(state, parameters, out):
    out[0] = -parameters[0] * state[4] + parameters[1] * state[7] * state[3]
    out[1] = -parameters[0] * state[5] + parameters[1] * state[8] * state[1]
    out[2] = -parameters[1] * 1e-9 * state[6] * (state[0] + state[2])


def python_wrench(state, parameters):
    a, b = parameters
    return (
        -a * state.vx + b * state.Bx * state.theta,
        -a * state.vz + b * state.Bz * state.x,
        -b * 1e-9 * state.omega * (state.t + state.z),
    )


@pytest.fixture(scope="module")
def c_library(tmp_path_factory):
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("there is no C compiler")
    folder = tmp_path_factory.mktemp("c")
    (folder / "wrench.c").write_text(C_SOURCE)
    # No fused multiply-add, which the others do not have.
    subprocess.run(
        [compiler, "-O2", "-ffp-contract=off", "-shared", "-fPIC", "-o", "wrench.so", "wrench.c"],
        cwd=folder,
        check=True,
    )
    return ctypes.CDLL(str(folder / "wrench.so"))


CALLBACK = ctypes.CFUNCTYPE(None, *3 * [ctypes.POINTER(ctypes.c_double)])


@CALLBACK
def ctypes_callback(state, parameters, out):
    out[0], out[1], out[2] = python_wrench(stickslip.user_effects.State(*state[:9]), parameters[:2])


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


def test_the_function_is_kept_as_long_as_it_is_in_use():
    class Force:
        def __call__(self, state, parameters):
            return parameters[0] * 1e-7, 0.0, 0.0

    register(Force())
    core = scenario(PULSES, {"effects.own.k": 1.0}).to_core()
    expected = _core.simulate_batch([core])[0].mean_velocity
    gc.collect()
    assert _core.simulate_batch([core])[0].mean_velocity == expected
    unregister_effect("own")
    gc.collect()
    assert _core.simulate_batch([core])[0].mean_velocity == expected


# Everywhere an effect of the model's own works.


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
    unregister_effect("own")
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
    assert Scenario.from_toml(tmp_path / "own.toml") == changed
    with pytest.raises(ScenarioError, match=r"effects\.own\.k = 2\.0: allowed is a number from"):
        changed.replace({"effects.own.k": 2.0})
    with pytest.raises(ScenarioError, match=r'did you mean "effects\.own\.length"'):
        changed.replace({"effects.own.lenght": 1e-3})

    text = CliRunner().invoke(command, ["effects", "own"]).output
    assert "[effects.own]" in text
    assert "k: of a test; a number from -1 to 1 N; default 0.0" in text
    assert "length = 0.001" in CliRunner().invoke(command, ["keys", "effects.own"]).output

    unregister_effect("own")
    assert stickslip.effects() == before
    assert Scenario.keys() == keys
    with pytest.raises(ScenarioError, match="has to be registered first"):
        Scenario.from_toml(tmp_path / "own.toml")
    with pytest.raises(ValueError, match=r"effects\.own\.k: there is no such numeric key"):
        simulate(changed)


@pytest.mark.parametrize("function", [numba_wrench, python_wrench], ids=["numba", "python"])
def test_a_sweep_is_bit_identical_on_any_number_of_threads(function, tmp_path):
    register(function, parameter("a", low=0.0), parameter("b"))
    keys = {"effects.own.a": np.linspace(0.0, 8e-6, 5), "effects.own.b": [0.0, 3e-5]}
    file = tmp_path / "sweep.nc"
    one = sweep(scenario(PULSES), keys, jobs=1, out=file)
    two = sweep(scenario(PULSES), keys, jobs=2)
    xarray.testing.assert_identical(one, two)
    assert (one.status == 0).all()
    assert one.sizes["own_a"] == 5
    assert one.own_a.attrs["key"] == "effects.own.a"
    for a, row in zip(keys["effects.own.a"], one.mean_velocity.values, strict=True):
        alone = [run(PULSES, {"effects.own.a": a, "effects.own.b": b}) for b in (0.0, 3e-5)]
        assert [each.mean_velocity for each in alone] == list(row)
    plain = run(PULSES).mean_velocity
    assert one.mean_velocity.values[0, 0] == plain
    assert np.unique(one.mean_velocity.values).size == 10

    scenarios = [scenario(PULSES, {"effects.own.a": a}) for a in keys["effects.own.a"]]
    for threads in (1, 2):
        runs = simulate_batch(scenarios, threads=threads)
        assert [each.mean_velocity for each in runs] == list(one.mean_velocity.values[:, 0])


def test_its_names_in_a_dataset_take_no_others_place(tmp_path):
    names = {key: short_name(key) for key in known_keys()}
    register(nothing, parameter("velocity"), parameter("frequency"), name="mean")
    register(nothing, parameter("frequency"), name="drive")
    register(nothing, parameter("time_time"), name="edge")
    assert {key: short_name(key) for key in names} == names
    everything = [short_name(key) for key in known_keys()]
    assert len(set(everything)) == len(everything)
    assert short_name("effects.mean.frequency") == "mean_frequency"
    keys = {"effects.mean.velocity": [0.0, 1.0]}
    seen = sweep(scenario(PULSES), keys, jobs=1, out=tmp_path / "sweep.nc")
    assert seen.mean_velocity.dims == ("effects.mean.velocity",)
    read = sweep(scenario(PULSES), keys, jobs=1, out=tmp_path / "sweep.nc", resume=True)
    assert np.array_equal(read.mean_velocity, seen.mean_velocity)


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
    xarray.testing.assert_identical(there, sweep(scenario(PULSES), keys, jobs=1))


# What goes wrong.


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
    for jobs in (1, 2):
        with pytest.raises(BoomError) as caught:
            sweep(scenario(PULSES), {"effects.own.k": [0.0, 0.5, 1.0]}, jobs=jobs)
        assert caught.traceback[-1].name == "fails"
    # It is over with that: nothing is left behind for the next run.
    assert run(PULSES).ok


@by_method
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_force_that_is_not_finite_is_a_status(method, bad):
    @cfunc(SIGNATURE)
    def broken(state, parameters, wrench):
        wrench[0] = wrench[1] = wrench[2] = 0.0
        if state[0] > 0.06 and parameters[0] > 0.5:
            wrench[2] = bad

    register(broken)
    failed = simulate(scenario(PULSES, {"effects.own.k": 1.0, "solver.method": method}))
    assert failed.status == "not_finite"
    assert failed.message.startswith("at t = 0.06")
    assert "the function of effect own gave a force or torque that is not a" in failed.message
    seen = sweep(scenario(PULSES, {"solver.method": method}), {"effects.own.k": [0.4, 0.9]}, jobs=2)
    assert list(seen.status.values == 0) == [True, False]
    assert np.isnan(seen.mean_velocity.values[1])


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


def test_a_function_may_return_anything_of_three_numbers():
    register(lambda state, parameters: np.array([1e-7, 0.0, 0.0]) * parameters[0], name="array")
    register(lambda state, parameters: [1e-7 * parameters[0], 0, 0], name="list")
    array, listed = (run(PULSES, {f"effects.{name}.k": 1.0}) for name in ("array", "list"))
    assert array.mean_velocity == listed.mean_velocity


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


def test_registering_the_same_again_is_fine():
    register(nothing)
    register(nothing)
    register(numba_wrench, name="compiled")
    register(numba_wrench.address, name="compiled")
    assert _core.registered_effects() == ["own", "compiled"]


def one_pointer(argument):
    return ctypes.CFUNCTYPE(None, argument)(lambda *arguments: None)


@cfunc("float64(float64)")
def of_one_number(x):
    return x


class Addressed:
    def __init__(self, address):
        self.address = address


REFUSED = {
    "built-in": ({"name": "surface_tilt"}, ValueError, "the model has one of this name itself"),
    "another": ({"name": "taken"}, ValueError, "another definition; unregister_effect"),
    "no word": ({"name": "my effect"}, ValueError, "letters, digits and _"),
    "no name": ({"name": ""}, ValueError, "letters, digits and _"),
    "number": ({"name": 3}, TypeError, "allowed is a text"),
    "meaning": ({"meaning": None}, TypeError, "allowed is a text"),
    "source": ({"source": 1}, TypeError, "allowed is a text"),
    "no parameter": ({"parameters": []}, ValueError, "needs a parameter"),
    "not a list": ({"parameters": 3}, TypeError, "a list of EffectParameter"),
    "not one": ({"parameters": ["k"]}, TypeError, "allowed is an EffectParameter"),
    "twice": ({"parameters": 2 * [parameter()]}, ValueError, '"k": is given twice'),
    "parameter word": ({"parameters": [parameter("a.b")]}, ValueError, "letters, digits and _"),
    "order": ({"parameters": [parameter(low=1, high=0)]}, ValueError, "low below the high"),
    "endless": ({"parameters": [parameter(high=math.inf)]}, ValueError, "finite ends"),
    "default": ({"parameters": [parameter(default=2)]}, ValueError, "outside its range"),
    "nan": ({"parameters": [parameter(default=math.nan)]}, ValueError, "outside its range"),
    "bool": ({"parameters": [parameter(low=False)]}, TypeError, "allowed is a number"),
    "unit": ({"parameters": [parameter(unit=1)]}, TypeError, "unit = 1: allowed is a text"),
    "no function": ({"function": None}, TypeError, "allowed is an address"),
    "text": ({"function": "f"}, TypeError, "allowed is an address"),
    "true": ({"function": True}, TypeError, "address = true"),
    "null": ({"function": 0}, ValueError, "there can be no function"),
    "negative": ({"function": -8}, ValueError, "there can be no function"),
    "huge": ({"function": 2**64}, ValueError, "there can be no function"),
    "address": ({"function": Addressed("here")}, TypeError, "allowed is an integer"),
    "nothing there": ({"function": Addressed(0)}, ValueError, "there can be no function"),
    "arguments": ({"function": one_pointer(ctypes.c_void_p)}, TypeError, "other arguments"),
    "numbers": ({"function": of_one_number}, TypeError, "other arguments"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_refused_is_refused_in_one_line(case):
    register(nothing, name="taken")
    before = stickslip.effects()
    changes, error, text = REFUSED[case]
    given = {"name": "own", "function": numba_wrench, "parameters": [parameter()], "meaning": "m"}
    given |= changes
    with pytest.raises(error) as caught:
        register_effect(given.pop("name"), given.pop("function"), given.pop("parameters"), **given)
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "effect" in str(caught.value)
    assert stickslip.effects() == before


def test_what_is_not_registered_cannot_be_taken_back():
    for name in ("own", "surface_tilt", 3):
        with pytest.raises(ValueError, match="is not registered"):
            unregister_effect(name)


def test_a_new_definition_comes_after_the_old_one_is_gone():
    register(lambda state, parameters: (1e-7, 0.0, 0.0))
    pushed = run(PULSES, {"effects.own.k": 1.0}).mean_velocity
    unregister_effect("own")
    register(nothing)
    assert run(PULSES, {"effects.own.k": 1.0}).mean_velocity == pytest.approx(
        run(PULSES).mean_velocity, rel=ROUNDING
    )
    assert pushed > 1.001 * run(PULSES).mean_velocity


def test_rest_without_field_stays_rest():
    # The function is called, and gives nothing: the block must not begin to move by it.
    register(nothing)
    still = run(NO_FIELD, {"effects.own.k": 1.0}, rate=1e3, pulses=2)
    assert np.all(still.x == still.x[0])
    assert still.normal_force == pytest.approx(PRESSED, rel=1e-14)
