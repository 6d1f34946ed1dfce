"""What a reader is told of a diagnosis: sentences, numbers of the report, files."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from command_line import stickslip
from helpers import run
from made_measurement import write
from stickslip._util.atomic_files import check_folder
from stickslip.diagnosis import Cause
from stickslip.diagnosis.data.conditions import changes, in_words, sorted_by_settings, varied
from stickslip.diagnosis.inference.discrimination import _candidates
from stickslip.diagnosis.inference.evidence import pattern, where_it_lives
from stickslip.diagnosis.inference.ranking import leading, runner_up, set_members
from stickslip.diagnosis.report.cause_words import against
from stickslip.diagnosis.report.words import used_in
from stickslip.facts import Code, Fact
from stickslip.scenario.keys import known_keys
from toy_model import (
    MODE,
    X,
    diagnosis,
    shared_diagnosis,
)


@pytest.fixture(scope="module")
def full(tilted):
    return json.loads((tilted[0] / "found" / "report.json").read_text())


def test_the_facts_are_those_of_the_sentences(full):
    def said(facts):
        return [str(Fact(Code(each["code"]), each["fields"])) for each in facts]

    facts = full["facts"]
    for key in ("reasons", "notes", "left_out", "flat_directions", "changing", "advice"):
        assert said(facts[key]) == full[key]
    assert said(facts["next_experiments"]) == [each["why"] for each in full["next_experiments"]]
    for key in ("runner_up", "where_it_lives"):
        assert "".join(said(facts[key])) == full[key]
    changes = full["velocity_changes"]
    assert said(facts["velocity_changes"].values()) == [
        each["in_words"] for each in changes.values()
    ]
    assert full["reasons"]
    assert full["notes"]


def test_parts_share_the_whole_misfit(full):
    # Without errors that set-ups share, each half of a split and its complement add up to all.
    parts = full["misfit_by_part"]
    total = next(each["data_chi2"] for each in full["ranking"] if not each["causes"])
    for names in (("+x", "-x"), ("low frequency", "high frequency")):
        sums = [parts[name]["conditions"] * parts[name]["recalibrated"] for name in names]
        assert sum(sums) == pytest.approx(total, rel=1e-9)


def test_conditions_carry_what_the_table_says(full):
    # Without errors that set-ups share, each condition has a fall of chi-square of its own.
    def misfit(name):
        return np.array(
            [
                (row["velocity"] - row[name]) ** 2 / (row["sd"] ** 2 + row["model_scatter"] ** 2)
                for row in full["conditions"]
            ]
        )

    fall = misfit("recalibrated") - misfit("extended")
    found = {each["condition"]: each["share"] for each in full["carried_by"]}
    assert list(found) == (np.argsort(-fall)[:3] + 1).tolist()
    total = np.sum(np.maximum(fall, 0.0))
    for number, share in found.items():
        assert share == pytest.approx(fall[number - 1] / total, rel=1e-9)


def test_projection_reduces_the_signal_to_noise(full):
    strength = full["signal_to_noise"]
    chi2 = {tuple(each["causes"]): each["chi2"] for each in full["ranking"]}
    # Of the first of the set, which the extended model has.
    first = full["cause"] if isinstance(full["cause"], str) else full["cause"][0]
    fall = chi2[()] - chi2[first,]
    assert strength["after_absorption"] == pytest.approx(np.sqrt(fall), rel=1e-9)
    # Projection takes away, and noise along what is left adds a normal number of variance one.
    assert strength["after_absorption"] < strength["before_absorption"] + 2.0


def test_the_change_by_a_tilt_is_that_of_the_simulator(full):
    found = full["velocity_changes"]["surface_tilt"]
    drive = {"base": 0.5e-3, "pulses": 6, "frequency": 40.0}
    plain, tilt = (
        run({**keys, "solver.rtol": 1e-6}, **drive).mean_velocity
        for keys in ({}, {"effects.surface_tilt.angle": 0.04})
    )
    way = np.sign(tilt - plain)
    assert all(np.sign(each["change"]) == way for each in found["parts"].values())
    fields = {"direction": "+x" if way > 0 else "-x", "causes": 1}
    shifted = Fact(Code.VELOCITIES_SHIFTED, fields)
    assert found["in_words"] == str(shifted)
    assert full["facts"]["velocity_changes"]["surface_tilt"] == shifted.as_dict()


def test_held_out_predictions_have_the_error_that_is_reported(full):
    held = [row for row in full["conditions"] if row["held_out"]]
    assert len(held) == full["gain"]["n"]
    for key, name in (("mae_before", "recalibrated"), ("mae_after", "extended")):
        error = [abs(row["velocity"] - row[f"{name}_without_it"]) for row in held]
        assert full["gain"][key] == pytest.approx(np.mean(error), rel=1e-12)
    level = np.mean([abs(row["velocity"]) for row in held])
    assert full["held_out_level"] == pytest.approx(level, rel=1e-12)


def test_the_given_scenario_is_there_too(full):
    row = full["conditions"][0]
    drive = {key: row[key] for key in ("direction", "frequency", "base", "pulses")}
    given = run({"solver.rtol": 1e-8}, **drive).mean_velocity
    assert row["given"] == pytest.approx(given, rel=1e-3)


def test_the_cosine_of_a_cause_with_itself_is_one(full):
    cosines = np.array(full["isolability"]["cosines"])
    assert cosines.shape == (len(full["isolability"]["causes"]),) * 2
    alone = np.diag(cosines)
    # A cause that this data cannot show has no direction.
    assert np.all((np.abs(alone - 1.0) < 1e-9) | (alone == 0.0))


def test_the_extended_scenario_says_where_it_is_from(tilted):
    first, *changed = [
        line
        for line in (tilted[0] / "found" / "extended.toml").read_text().splitlines()
        if line[:1] == "#"
    ]
    assert first.startswith("# stickslip diagnose m.toml: ")
    assert any(line.startswith("# contact.kinetic_friction: 0.145 -> ") for line in changed)
    # Its drive is none that was measured, and these lines are to be changed for one that was.
    (drive,) = [line for line in changed if line.startswith("# [drive] is that of the scenario")]
    assert re.search("the measurements set (frequency, direction|direction, frequency):$", drive)


def test_the_page_explains_its_terms(tilted):
    page = (tilted[0] / "found" / "report.html").read_text()
    for words in ("Chi-square: squared", "Starts agree", "same constants"):
        assert words in page
    # A parameter's sign has the meaning that its key has.
    assert known_keys()["effects.surface_tilt.angle"].meaning in page


def test_a_page_defines_the_words_that_it_uses_and_no_others():
    def names(page):
        return [each.name for each in used_in(page)]

    assert names("<p>Nothing was found.</p>") == []
    # The picture and the list of words itself are no text of the page.
    assert names('<svg class="chart">prior</svg><h2>Words</h2><ul>prior</ul>') == []
    # A word that a definition needs is defined too.
    assert names("<p>Its log-evidence.</p>") == ["Prior", "Log-evidence"]


def test_the_page_says_if_nothing_can_be_learnt_from_the_data(tmp_path):
    path = write(tmp_path, {})
    lines = (tmp_path / "velocity.csv").read_text().splitlines()
    (tmp_path / "velocity.csv").write_text("\n".join([lines[0], *lines[1::3]]) + "\n")
    done = stickslip("diagnose", path, cwd=tmp_path)
    assert str(Fact(Code.NO_NOISE, {})) in done.stdout
    assert done.stdout.splitlines()[-1].endswith("report.html, report.json, extended.toml")
    page = (tmp_path / "diagnosis" / "report.html").read_text()
    assert "Nothing was learnt" in page
    for words in ("Probabilities", "Recalibrated constants", "held out for the gain"):
        assert words not in page
    assert "# nothing is changed" in (tmp_path / "diagnosis" / "extended.toml").read_text()


def test_an_impossible_folder_is_refused_before_the_work(tmp_path):
    path = write(tmp_path, {})
    done = stickslip("diagnose", path, "--out", tmp_path / "m.toml" / "found")
    assert done.returncode == 2
    assert "--out" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_checking_a_folder_leaves_nothing_behind(tmp_path):
    check_folder(tmp_path / "a" / "b")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "file").write_text("")
    for bad in (Path("file"), Path("file", "inside")):
        with pytest.raises(OSError, match="cannot write"):
            check_folder(tmp_path / bad)


def part(conditions, recalibrated):
    return {"conditions": conditions, "recalibrated": recalibrated, "extended": None}


def test_the_part_with_the_misfit_is_found_by_contrast():
    said = where_it_lives({"IPP": part(9, 1.1), "OPP": part(9, 7.3)})
    larger = {"part": "OPP", "misfit": 7.3, "other": "IPP", "misfit_of_other": 1.1}
    assert (said.code, said.fields["parts"]) == (Code.MISFIT_UNEVEN, [larger])
    # Below the noise nothing is large, however small the other part is.
    even = where_it_lives({"IPP": part(9, 0.1), "OPP": part(9, 1.9)})
    assert even.code is Code.MISFIT_EVEN


def mixed(faster, slower):
    return Fact(Code.VELOCITIES_MIXED, {"faster": faster, "slower": slower})


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"IPP +x": (1.0, -0.1), "IPP -x": (-1.0, 0.1)}, Fact(Code.VELOCITIES_SLOWER, {})),
        ({"IPP +x": (1.0, 0.1), "IPP -x": (-1.0, -0.1)}, Fact(Code.VELOCITIES_FASTER, {})),
        (
            {"IPP +x": (1.0, -0.1), "IPP -x": (-1.0, -0.1)},
            Fact(Code.VELOCITIES_SHIFTED, {"direction": "-x"}),
        ),
        (
            {"IPP +x": (1.0, 0.1), "OPP +x": (1.0, -0.1), "IPP -x": (-1.0, -0.1)},
            mixed(["IPP +x", "IPP -x"], ["OPP +x"]),
        ),
        ({"IPP +x": (1.0, 0.0), "OPP +x": (-1.0, 0.1)}, mixed([], ["OPP +x"])),
        ({"IPP +x": (1.0, 0.0)}, Fact(Code.VELOCITIES_UNCHANGED, {})),
        ({}, Fact(Code.VELOCITIES_UNCHANGED, {})),
    ],
)
def test_patterns_of_velocity(changed, said):
    parts = {
        word: {"velocity": velocity, "change": change, "noise": 0.01}
        for word, (velocity, change) in changed.items()
    }
    assert pattern(parts) == said


def test_settings_are_said_in_laboratory_units_and_in_the_order_of_a_scenario():
    conditions = [
        {"drive.peak": 2e-3, "drive.frequency": 30.0, "drive.mode": "IPP", "drive.hold": 0.0},
        {"drive.peak": 3e-3, "drive.frequency": 30.0, "drive.mode": "OPP", "drive.hold": 0.0},
    ]
    assert varied(conditions) == ["drive.mode", "drive.peak"]
    assert in_words(conditions[1], varied(conditions)) == "mode OPP, peak 3 mT"
    proposed = {"peak": 2.5e-3, "mode": "IPP", "frequency": 45.0, "hold": 0.0}
    assert changes(proposed, conditions) == "mode IPP, frequency 45 Hz, peak 2.5 mT"


def test_conditions_are_told_apart_by_what_is_not_shown():
    def condition(frequency, peak, hold):
        return {"drive.frequency": frequency, "drive.peak": peak, "drive.hold": hold}

    usual = [condition(f, 2e-3, 1e-3) for f in (20.0, 40.0)]
    others = [condition(30.0, 1e-3, 1e-3), condition(20.0, 1e-3, 0.0)]
    shown = ["drive.frequency"]
    assert sorted_by_settings([others[0], *usual, others[1]], shown, 3) == {
        "peak 2 mT, hold 1 mT": [1, 2],
        "peak 1 mT": [0],
        "peak 1 mT, hold 0 mT": [3],
    }
    assert sorted_by_settings([others[0], *usual, others[1]], shown, 2) == {
        "peak 2 mT, hold 1 mT": [1, 2],
        "other peak or hold": [0, 3],
    }
    assert sorted_by_settings(usual, shown, 2) == {"": [0, 1]}


def test_what_leads_and_what_comes_next():
    found = shared_diagnosis(0, ripple=0.3)
    assert found.verdict.causes == ("ripple",)
    assert leading(found)[0].name == "ripple"
    assert runner_up(found) is None  # the reason of a name says it already
    both = next(
        each
        for each in (shared_diagnosis(seed, wave=0.5, swell=-0.5) for seed in range(20))
        if each.verdict.kind == "pair"
    )
    assert both.verdict.causes == ("swell", "wave")
    assert leading(both)[0].name == both.verdict.fit.name
    assert runner_up(both).code is Code.RUNNER_UP


def test_unexplained_data_have_a_nearest_candidate():
    shape = 0.3 * np.sign(np.sin(25.0 * X + 2.0 * MODE))
    found = diagnosis(2, extra=shape)
    assert found.verdict.kind == "unexplained"
    nearest = min([*found.ranking.singles, *found.ranking.pairs], key=lambda fit: fit.chi2)
    said = runner_up(found)
    assert (said.code, said.fields["name"]) == (Code.NEAREST, nearest.name)


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (2.0, "30% above the stated 2"),
        (4.0, "35% below the stated 4"),
        (0.1, "26 times the stated 0.1"),
        (0.0, "stated as 0"),
        (-2.0, "stated as -2"),
    ],
)
def test_a_constant_is_compared_with_what_was_stated(stated, said):
    # Ratios of 2.6 to what was stated.
    assert against(2.6, stated) == said


def close(name, evidence):
    """What standing looks at of a fit."""
    causes = tuple(Cause(each) for each in name.split(" + ") if each != "none")
    return SimpleNamespace(
        name=name,
        candidate=SimpleNamespace(causes=causes),
        log_evidence=evidence,
        priced_evidence=evidence - (6.7 if len(causes) > 1 else 0.0),
    )


def test_close_pairs_are_not_combined_to_another():
    pairs = [close("a + b", 50.0), close("c + d", 48.5), close("a + c", 30.0)]
    # Which holds a member of the set and one cause more.
    more = close("a + b + e", 49.0)
    several = Fact(Code.SEVERAL_PAIRS, {"pairs": ["a + b", "c + d"]})
    verdict = SimpleNamespace(
        kind="ambiguous", causes=("a", "b", "c", "d"), fit=pairs[0], reasons=(several,)
    )
    found = SimpleNamespace(
        problem=None,
        verdict=verdict,
        null=close("none", 0.0),
        ranking=SimpleNamespace(singles=[close("a", 20.0)], pairs=[*pairs, more]),
        detection=SimpleNamespace(found=True),
    )
    assert [fit.name for fit in set_members(found)] == ["a + b", "c + d"]
    # Experiments are to tell these two apart, and no combination that is not in doubt.
    assert [fit.name for fit in _candidates(found)] == ["a + b", "c + d"]
    # 50 less 6.7 for a second cause, against 30 less the same.
    assert runner_up(found) == Fact(Code.RUNNER_UP, {"name": "a + c", "lead": pytest.approx(20.0)})


def test_stages_are_told_in_order():
    told = []
    diagnosis(0, {"ripple": 0.3}, progress=lambda done, stage: told.append((done, stage)))
    fractions = [done for done, _ in told]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    stages = [stage for _, stage in told]
    assert stages[:3] == ["recalibrating", "testing", "fitting causes"]
    assert stages[-2:] == ["verdict and gain", "done"]
