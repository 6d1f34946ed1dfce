"""Effects of the user's own everywhere an effect of the model's own works."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
import xarray
from click.testing import CliRunner

import stickslip
from helpers import run, scenario
from own_effects import (
    PULSES,
    ROUNDING,
    by_method,
    nothing,
    nothing_stays,  # noqa: F401 (around every test here)
    numba_wrench,
    parameter,
    register,
    unregister,
)
from stickslip import (
    Scenario,
    ScenarioError,
    _core,
    simulate,
    sweep,
)
from stickslip.cli.commands import stickslip as command


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
    assert Scenario.from_toml(tmp_path / "own.toml") == changed
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
        Scenario.from_toml(tmp_path / "own.toml")
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
