"""Laws of the user's own, `[laws.NAME]`: their bits, their ways, and what is refused."""

import pickle

import numpy as np
import pytest

from helpers import ADHESION, energy, run, scenario, still_for
from stickslip import (
    Law,
    Scenario,
    ScenarioError,
    Simulator,
    _core,
    load,
    simulate,
    simulate_batch,
    sweep,
)
from ways_to_run import pieces

OPP = {"drive.mode": "OPP", "drive.hold": 2.5e-3, "drive.base": 0.0, "drive.pulses": 4}
IPP = {"drive.base": 0.5e-3, "drive.pulses": 4}
LINEAR = 1e-5  # N s/m, the drag by default

# Each named law beside its own: keys, and the law.
NAMED = {
    "stribeck": (
        {"effects.stribeck_friction.velocity": 5e-3},
        Law(quantity="sliding_friction", over="slip_speed", form="gaussian",
            amount=0.2 - 0.145, scale=5e-3),
    ),
    "viscous": (
        {"effects.viscous_friction.coefficient": 20.0},
        Law(quantity="sliding_friction", over="slip_speed", form="line", amount=20.0, scale=1.0),
    ),
    "anisotropy": (
        {"effects.friction_anisotropy.fraction": 0.15},
        Law(quantity="friction", over="way", form="line", fraction=0.15),
    ),
    "patches": (
        {"effects.friction_patches.amplitude": 0.15, "effects.friction_patches.period": 1e-4},
        Law(quantity="friction", over="place", form="wave",
            fraction=0.15, scale=1e-4 / (2.0 * np.pi)),
    ),
    "angle adhesion": (
        {"effects.angle_adhesion.strength": 0.9},
        Law(quantity="adhesion", over="tilt", form="sine_squared", fraction=-0.9),
    ),
    "ageing": (
        {"effects.adhesion_ageing.rate": 0.15},
        Law(quantity="adhesion", over="age", form="logarithm", fraction=0.15, scale=1e-3),
    ),
    "angle drag": (
        {"effects.angle_drag.strength": 20.0},
        Law(quantity="drag", over="tilt", form="cosine_squared", amount=20.0 * LINEAR),
    ),
    "quadratic drag": (
        {"effects.quadratic_drag.coefficient": 1e-3},
        Law(quantity="drag", over="speed", form="line", amount=1e-3, scale=1.0),
    ),
}  # fmt: skip

SCALES = {"slip_speed": 0.01, "place": 1e-5, "tilt": 0.5, "load": 4e-7, "time": 0.05, "age": 0.01,
          "speed": 0.01, "rate": 200.0}  # fmt: skip
OVER = {
    "friction": ("way", "place", "tilt", "load", "time"),
    "sliding_friction": ("slip_speed",),
    "adhesion": ("tilt", "time", "age", "speed", "rate"),
}
OVER |= dict.fromkeys(("drag", "rotational_drag", "fluid"), OVER["adhesion"])
FORMS = ("line", "square", "sine_squared", "cosine_squared", "gaussian", "exponential",
         "logarithm", "saturation", "wave", "curve")  # fmt: skip
UNITS = {"friction": 0.1, "sliding_friction": 0.1, "adhesion": ADHESION, "drag": LINEAR,
         "rotational_drag": 1e-13}  # fmt: skip


def drawn(random):
    """A law that is allowed with the constants by default."""
    while True:
        quantity = str(random.choice(list(OVER)))
        over, form = str(random.choice(OVER[quantity])), str(random.choice(FORMS))
        law = {"quantity": quantity, "over": over, "form": form}
        if random.random() < 0.5:
            law["amount"] = UNITS.get(quantity, 1.0) * random.uniform(-0.5, 2.0)
        else:
            law["fraction"] = random.uniform(-0.9, 1.5)
        if over != "way" and form not in ("sine_squared", "cosine_squared"):
            law["scale"] = SCALES[over] * 10.0 ** random.uniform(-1.0, 1.0)
        if form == "curve":
            law["knots"] = random.uniform(-1.0, 2.0, 5).tolist()
        try:
            return Scenario(laws={"drawn": law}).laws["drawn"]
        except ScenarioError:
            continue


LAWS = [drawn(np.random.default_rng(seed)) for seed in range(300)]


def with_laws(keys, *laws):
    return scenario(keys).replace({f"laws.own_{k}": law for k, law in enumerate(laws)})


def test_these_are_all_named_laws():
    assert {key.split(".")[1] for keys, _ in NAMED.values() for key in keys} == {*_core.named_laws}


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("drive", [IPP, OPP], ids=["IPP", "OPP"])
@pytest.mark.parametrize(("keys", "law"), NAMED.values(), ids=NAMED)
def test_a_law_of_ones_own_has_the_bits_of_the_named_one(keys, law, drive, direction):
    base = scenario(drive, {"drive.direction": direction})
    named, own = simulate(base.replace(keys)), simulate(base.replace({"laws.own": law}))
    assert own.ok
    assert own.summary() == named.summary()
    assert own.final_state == named.final_state
    assert own.summary() != simulate(base).summary()


def test_random_laws_have_one_answer_in_every_way():
    # Some have two laws, and drives alternate, so that packs have laws of many kinds.
    cases = []
    for k, law in enumerate(LAWS):
        try:
            cases.append(with_laws((IPP, OPP)[k % 2], law, *LAWS[k + 1 : k + 2]))
        except ScenarioError:  # two that only together bring a quantity below zero
            cases.append(with_laws((IPP, OPP)[k % 2], law))
    alone = [simulate(each) for each in cases]
    assert all(each.ok for each in alone), [each.message for each in alone if not each.ok]
    for one, other in zip(alone, simulate_batch(cases, threads=2), strict=True):
        assert other.summary() == one.summary()
        assert other.final_state == one.final_state
    for one, case in list(zip(alone, cases, strict=True))[::3]:
        simulator = Simulator(case)
        for first, last, duration in pieces(case):
            state = simulator.step(last, duration, "linear", first)
        assert state == one.final_state


def test_random_laws_are_the_same_in_the_whole_plane():
    # The push is so small that it moves nothing by itself; see effect_table.PUSHES.
    push = {"effects.ambient_field.By": 1e-15, "solver.rtol": 1e-10}
    off = []
    for k, law in enumerate(LAWS[::5]):
        case = with_laws((IPP, OPP)[k % 2], law).replace({"solver.rtol": 1e-10})
        one, other = simulate(case), simulate(case.replace(push))
        assert one.ok
        assert other.ok
        off.append(abs(one.mean_velocity - other.mean_velocity))
    # Of 2 mm/s; without laws the two programs differ by 2e-10. Contacts that rounding decides may
    # differ by more.
    assert np.median(off) < 1e-9
    assert np.mean(np.array(off) < 1e-7) >= 0.95


def test_friction_and_drag_never_give_energy():
    random = np.random.default_rng(5)
    for law in LAWS:
        start = {"initial.z": 2e-4, "initial.theta": random.uniform(-3.0, 3.0),
                 "initial.vx": random.uniform(-0.05, 0.05), "initial.vz": random.uniform(0, 0.05),
                 "initial.omega": random.uniform(-500.0, 500.0)}  # fmt: skip
        of = run(still_for(0.05), start, {"laws.own": law}, rate=2e4)
        gained = np.diff(energy(of))
        # Positions are known to 1e-8 of the robot's size, and its weight acts over them.
        assert gained.max() < 1e-7 * energy(of)[0], law
        slip = np.nan_to_num(of.slip_velocity)
        assert np.max(of.friction_force * slip) <= 1e-12 * ADHESION, law


def test_a_robot_that_faces_the_other_way_meets_the_same_place():
    # A step of friction at x = 0 that only one of two ways reaches.
    wall = Law(quantity="friction", over="place", form="curve", fraction=1.0, scale=4e-4,
               knots=(0.0, 0.0, 0.0, 0.0, 1.0))  # fmt: skip
    forward = scenario(IPP, {"drive.pulses": 20})
    back = forward.replace({"drive.direction": "-x"})
    plain = simulate(forward).mean_velocity
    assert simulate(back.replace({"laws.wall": wall})).mean_velocity == pytest.approx(-plain, 1e-6)
    assert simulate(forward.replace({"laws.wall": wall})).mean_velocity < 0.95 * plain


WEAR = Law(quantity="friction", over="time", form="exponential", fraction=0.5, scale=0.05)
BEND = Law(quantity="drag", over="speed", form="curve", fraction=1.0, scale=0.02,
           knots=(0.0, 0.1, 0.2, 0.1, 0.0))  # fmt: skip


def test_a_scenario_keeps_its_laws(tmp_path):
    made = Scenario(laws={"wear": WEAR, "bend": BEND})
    assert dict(made.laws) == {"bend": BEND, "wear": WEAR}
    made.to_toml(tmp_path / "own.toml")
    for each in (load(tmp_path / "own.toml"), pickle.loads(pickle.dumps(made)), made.replace({})):
        assert each == made
        assert hash(each) == hash(made)
    by_keys = Scenario().replace({
        "laws.wear.scale": 0.05, "laws.wear.form": "exponential", "laws.wear.over": "time",
        "laws.wear.fraction": 0.5, "laws.wear.quantity": "friction",
    })  # fmt: skip
    assert by_keys == Scenario(laws={"wear": WEAR}) != made
    assert made.replace({"laws.bend": None}) == by_keys
    assert made.replace({"laws.bend.knot_3": 0.3}).laws["bend"].knots[2] == 0.3
    assert eval(repr(made.laws["bend"])) == made.laws["bend"] == BEND
    assert "laws.wear" in made._repr_html_()
    other = by_keys.replace({"laws.wear.scale": 0.1})
    assert Simulator(other).snapshot().to_bytes() != Simulator(by_keys).snapshot().to_bytes()


def test_the_numbers_of_a_law_are_keys():
    base = scenario(IPP).replace({"laws.wear": WEAR, "laws.bend": BEND})
    for key, values in {"laws.wear.fraction": [0.0, 0.2], "laws.bend.knot_2": [0.1, 0.4]}.items():
        found = sweep(base, {key: values})["mean_velocity"].values
        alone = [simulate(base.replace({key: value})).mean_velocity for value in values]
        assert found.tolist() == alone
        assert alone[0] != alone[1]
    assert base.get("laws.wear.scale") == 0.05
    prior = base.with_uncertain({"laws.wear.fraction": {"mean": 0.5, "sd": 0.1}})
    assert len({each.get("laws.wear.fraction") for each in prior.draws(3)}) == 3


def test_knots_are_any_five_numbers():
    knots = np.array(BEND.knots, dtype=np.float32)
    for given in (knots, list(knots), iter(knots)):
        law = Law(**{**vars(BEND), "knots": given})
        assert hash(law) == hash(Scenario(laws={"own": law}).laws["own"])
        assert Scenario(laws={"own": {**vars(BEND), "knots": knots}}).laws["own"] == law
    with pytest.raises(ScenarioError, match="allowed is a list of five numbers"):
        Law(**{**vars(BEND), "knots": 0.1})


def test_a_sweep_may_make_a_law():
    keys = {f"laws.own.{key}": value for key, value in vars(WEAR).items() if value is not None}
    alone = simulate(scenario(IPP, {"laws.own": WEAR})).mean_velocity
    for vary in ({key: [value] for key, value in keys.items()}, [keys]):
        assert sweep(scenario(IPP), vary)["mean_velocity"].values.ravel().tolist() == [alone]


def test_what_is_absent_leaves_the_bits():
    plain = run(OPP).summary()
    assert run(OPP, {"laws.wear": {**vars(WEAR), "fraction": 0.0}}).summary() == plain
    assert run(OPP, {"laws.bend": {**vars(BEND), "knots": [0.0] * 5}}).summary() == plain


def test_a_law_that_damps_too_fast_is_named():
    stiff = {"quantity": "drag", "over": "time", "form": "line", "amount": 1.0, "scale": 1e-6}
    of = simulate(scenario(IPP, {"laws.stiff": stiff, "solver.max_steps": 500}))
    assert of.status == "too_many_steps"
    assert "laws.stiff.amount = 1 damps a motion in" in of.message


REFUSED = [
    ({"quantity": "fricton"}, '"friction", "sliding_friction"'),
    ({"over": "speed"}, '"way", "place", "tilt", "load", "time", as a contact that sticks'),
    ({"quantity": "sliding_friction"}, '"slip_speed", as over all else'),
    ({"quantity": "adhesion", "over": "load"}, "as it has no slip and no load"),
    ({"form": "cube"}, 'laws.own.form = "cube"'),
    ({"form": "sine_squared", "scale": None}, 'over = "tilt"'),
    ({"over": "tilt", "form": "sine_squared"}, "no scale"),
    ({"over": "way", "scale": None}, '"line", as there are two ways'),
    ({"over": "load", "form": "line"}, "the load of an impact has no bound"),
    ({"scale": 0.0}, "laws.own.scale = 0.0: allowed is a number above 0 up to 1e+09"),
    ({"scale": None}, "laws.own.scale is missing"),
    ({"fraction": None}, "laws.own: fraction or amount is missing"),
    ({"amount": 0.1}, "one of fraction and amount"),
    ({"fraction": -1.1}, "laws.own.fraction = -1.1"),
    ({"fraction": float("nan")}, "laws.own.fraction = nan"),
    ({"scale": 1e-12}, "allowed is at least 1e-09 s"),
    ({"fraction": None, "amount": 101.0}, "allowed is from -100 to 100"),
    ({"fraction": None, "amount": -0.15}, "one that leaves friction, 0.145 without laws"),
    ({"quantity": "fluid", "fraction": None, "amount": 1e-5}, "two units"),
    ({"quantity": "sliding_friction", "over": "slip_speed"}, "is not above static friction, 0.2"),
    ({"form": "curve"}, "laws.own.knots are missing"),
    ({"knots": [0.0] * 5}, 'laws.own.knots with laws.own.form = "exponential"'),
    ({"form": "curve", "knots": [0.0] * 4}, "a list of five numbers"),
    ({"form": "curve", "knots": "01234"}, "a list of five numbers"),
    ({"form": "curve", "knots": [0.0, 0.0, "x", 0.0, 0.0]}, 'laws.own.knot_3 = "x"'),
    ({"form": "curve", "knots": [10**400] * 5}, "laws.own.knot_1 = 1000"),
    ({"form": "curve", "knots": [0.0] * 5, "knot_2": 1.0}, "laws.own.knot_2 beside laws.own.knots"),
    ({"form": "curve", "knot_2": 1.0, "knots": [0.0] * 5}, "laws.own.knot_2 beside laws.own.knots"),
    (dict.fromkeys(vars(WEAR)), "a law with quantity, over, form and their numbers"),
    ({"fractoin": 0.5}, 'did you mean "laws.own.fraction"'),
    ({"quantity": 1.0}, "laws.own.quantity = 1"),
    ({"scale": "long"}, "laws.own.scale"),
]  # fmt: skip


NAMES = {
    **dict.fromkeys(["2nd", "a-b", "", "gr\xf6\xdfe", "a\n"], "the name of a law has letters"),
    "eddy_lag": "there is an effect of this name",
    1: "whose name is a word",
}


HERE = Scenario(laws={"wear": WEAR})
SPREAD = {"mean": 0.5, "sd": 0.1}
ABSENT = [
    (lambda: Scenario().get("laws.wear.fraction"), "there is no law laws.wear here"),
    (lambda: HERE.get("laws.wear.amount"), "laws.wear.amount: the law has no amount"),
    (lambda: HERE.get("laws.wear"), 'known are "laws.wear.quantity"'),
    (lambda: Scenario().replace({"laws.wear.fraction": 0.1}), "laws.wear.quantity is missing"),
    (lambda: HERE.replace({"laws.waer.fraction": 0.1}), 'did you mean "laws.wear"?'),
    (lambda: HERE.replace({"laws.wear.knots": BEND.knots}), "laws.wear.knot_1 to laws.wear.knot_5"),
    (lambda: HERE.replace({"laws.a.b.fraction": 0.1}), "the name of a law has letters"),
    (lambda: HERE.replace({"law.wear.fraction": 0.1}), '"effects", "laws"'),
    (lambda: Scenario(laws=vars(WEAR)), "a table [laws.NAME] for each law"),
    (lambda: sweep(Scenario(), {"laws.wear.fraction": [0.1]}), "laws.wear.quantity is missing"),
    (lambda: HERE.with_uncertain({"laws.waer.fraction": SPREAD}), "[uncertain]: laws.waer"),
    (lambda: HERE.with_uncertain({"laws.wear.amount": SPREAD}), "the law has no amount"),
    (lambda: HERE.with_uncertain({"laws.wear.fraction": SPREAD}).replace({"laws.wear": None}),
     "[uncertain]: laws.wear.fraction: there is no law laws.wear here"),
]  # fmt: skip


EVERY = [
    *((lambda change=change: Scenario(laws={"own": {**vars(WEAR), **change}}), said)
      for change, said in REFUSED),
    *((lambda name=name: Scenario(laws={name: WEAR}), said) for name, said in NAMES.items()),
    *ABSENT,
]  # fmt: skip


@pytest.mark.parametrize(("made", "said"), EVERY)
def test_what_has_no_meaning_or_is_not_there_is_refused_in_one_line(made, said):
    with pytest.raises(ScenarioError) as error:
        made()
    assert said in str(error.value)
    assert "\n" not in str(error.value)
