"""Names that Python code or a file has wrong: what was probably meant is said."""

import re

import pytest

from stickslip import Scenario, ScenarioError, Waveform, reproduce
from stickslip.diagnosis import Cause, Parameter, Table, diagnose_model
from stickslip.scenario.keys import known_keys, meant, nearest, suggestion
from stickslip.scenario.priors import Prior


def cause(_):
    slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    table = Table({"x": [1.0]}, [1.0], sd=0.1)
    diagnose_model(lambda at, p: p["slope"] * at["x"], table, [slope], [Cause("a", frees="slop")])


WRONG = {
    "coil": (lambda _: Waveform.hold(0.1, {"clmap": 1.0}), "clamp"),
    "key": (lambda _: Scenario().replace({"frequency": 3.0}), "drive.frequency"),
    "key in another case": (lambda _: Scenario().get("DRIVE.EDGE"), "drive.edge"),
    "word": (lambda _: Scenario().replace({"drive.clamp": "dwon"}), "down"),
    "effect": (lambda _: Scenario(effects={"surface_tlt": {}}), "surface_tilt"),
    "cause": (cause, "slope"),
    "figure": (lambda _: reproduce(only=["fig112"]), "fig12"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_name_is_refused_with_what_was_meant(tmp_path, name):
    wrong, wanted = WRONG[name]
    with pytest.raises(ValueError, match=rf'did you mean "{re.escape(wanted)}"\?'):
        wrong(tmp_path)


def test_every_key_is_the_nearest_to_itself_and_to_its_capitals():
    for key in known_keys():
        assert nearest(key, known_keys()) == key
        assert nearest(key.upper(), known_keys()) == key


def test_a_word_of_a_key_with_a_letter_twice_is_recognised():
    tried = 0
    for key in known_keys().values():
        if key.kind != "word":
            continue
        for word in key.words:
            wrong = word + word[-1]
            with pytest.raises(ScenarioError) as caught:
                Scenario().replace({key.name: wrong})
            assert meant(wrong, key.words) in str(caught.value)
            tried += meant(wrong, key.words) != ""
    assert tried > 3


def test_nothing_is_meant_where_nothing_is_like_it():
    assert nearest("wxyz", ["one", "two"]) is None
    assert meant("wxyz", ["one", "two"]) == ""
    assert meant(3, ["one", "two"]) == ""
    assert suggestion("wxyz", ["one", "two"]) == 'known are "one", "two"'
    assert suggestion("wxyz", ["one", "two"], ["one"]) == 'known are "one"'
