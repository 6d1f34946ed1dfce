"""Lists and files of `python -m bench`, counts of `lines`."""

import argparse
import importlib.util
import json
import runpy
import subprocess
import sys
from pathlib import Path

import diagnoses
import lines
import measure
import now
import numpy as np
import pytest
import stale
from score import rows as score
from works import WORKS

ROOT = Path(__file__).resolve().parents[1]


def test_every_file_belongs_to_one_wing():
    wings = [path for pattern, _ in lines.WINGS.values() for path in lines.files(pattern)]
    every = lines.files(r"(python|cpp/(?!web/)|cmake|tests|bench)/?.*\.(py|h|[hc]pp)")
    assert sorted(wings) == sorted(every)


def test_no_wing_is_above_its_budget():
    above = {wing: size for wing, size in lines.sizes().items() if size[0] > lines.OVER * size[1]}
    assert not above, f"lines and budget, of which {lines.OVER - 1:.0%} more are allowed: {above}"
    assert lines.circles() == []


@pytest.mark.nightly
def test_lines_counts_what_it_says(capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["lines", "--list"])
    lines.main()
    said = capsys.readouterr().out
    assert "words of documentation" in said
    assert "longest functions:" in said


def test_a_circle_of_imports_is_found_through_types_too(tmp_path, monkeypatch):
    home = tmp_path / "python" / "stickslip"
    for path, text in {
        "a/one.py": "from stickslip.b import two",
        "b/two.py": "if TYPE_CHECKING:\n    from stickslip.b.three import Three",
        "b/three.py": "def f():\n    from stickslip.a.one import g",
        "b/four.py": "from stickslip.b.two import h",
    }.items():
        (home / path).parent.mkdir(parents=True, exist_ok=True)
        (home / path).write_text(text + "\n")
    monkeypatch.setattr(lines, "ROOT", tmp_path)
    assert lines.circles() == [{"a.one", "b.two", "b.three"}]


def test_the_interval_of_a_median_holds_it_in_19_of_20_cases():
    # Of 21 samples the 6th and the 16th: P(5 or fewer of 21 below) is 0.0133, of 6 or fewer 0.039.
    assert measure.figure_of(range(21)) == (10, 5, 15, 21)
    assert measure.figure_of([3.0]) == (3.0, 3.0, 3.0, 1)
    draws = np.random.default_rng(1).exponential(size=(4000, 40))
    figures = [measure.figure_of(row) for row in draws]
    holds = np.mean([each.low <= np.log(2.0) <= each.high for each in figures])
    assert 0.945 < holds < 0.975


def test_samples_end_where_every_ratio_is_known():
    draws = np.random.default_rng(2)
    for spread, fewest, most in ((1e-3, 21, 21), (0.05, 30, 400), (1.0, 500, 500)):
        works = [lambda spread=spread: draws.lognormal(0.0, spread), lambda: 2.0]
        samples = list(measure.in_turn(works, 21, 500))
        assert fewest <= len(samples) <= most
        ratio = measure.ratios(samples)
        assert ratio.low <= ratio.median <= ratio.high
        assert ratio.median == pytest.approx(0.5, rel=max(spread, 1e-3))
        assert (ratio.width <= measure.WIDTH) is (len(samples) < 500)


@pytest.mark.parametrize("name", [each for each in WORKS if each not in ("points", "long")])
def test_a_work_moves_and_counts_what_it_says(name):
    simulated, velocities = WORKS[name].call(1e-4)
    if name in ("bare steps", "replaced"):
        assert (simulated, velocities) == (0.0, [])
    else:
        assert simulated > 0.4
        assert np.count_nonzero(velocities) >= 0.9 * len(velocities) > 0
    if name in ("swept", "modes", "apart", "alike"):
        assert len(velocities) == WORKS[name].count


def test_parts_of_now_go_on_where_they_ran_out_of_time(tmp_path, monkeypatch):
    path, made = tmp_path / "now.json", []

    def counted(done, budget):
        for name in "abc":
            if name not in done:
                budget.check()
                made.append(name)
                yield name, now.number_row(len(made), "-")
                if name == "b":
                    budget.ends = 0.0

    monkeypatch.setitem(now.PARTS, "tables", counted)
    now.measured("tables", path, now.Budget(float("inf")))
    part = now.read(path)["tables"]
    assert (list(part["rows"]), part["complete"]) == (["a", "b"], False)
    now.measured("tables", path, now.Budget(float("inf")))
    assert made == ["a", "b", "c"]
    assert now.read(path)["tables"]["complete"]
    # A complete part begins anew, and so does one of other sources.
    for _ in range(2):
        now.measured("tables", path, now.Budget(float("inf")))
        monkeypatch.setattr(now, "commit", lambda: "other")
    assert made == [*"abcab", *"ab"]


GOLDEN = "{GOLDEN}"
OLD = {"class": "logs, nothing", "problem": "axis-00", "truth": [], "listed": True, "said": "none",
       "causes": [], "cpu": 1.0, "engine": {"golden": GOLDEN}}  # fmt: skip
ANSWER = {"said": "none", "causes": [], "cpu": 1.0}
PART = {"complete": True, "rows": {"a": now.number_row(1.0, "-"), "b": now.number_row(2.0, "-")}}
SHOWN = [
    ("score", ["score", "--rows", "{}.jsonl"], OLD, 1),
    ("score", ["score", "--rows", "{}.json"], {"axis-00": {**ANSWER, "golden": GOLDEN}}, 1),
    ("now", ["now", "diagnosis", "--out", "{}.json"], {"tables": {**PART, "golden": GOLDEN}}, 2),
]  # fmt: skip


@pytest.mark.parametrize(("name", "arguments", "record", "rows"), SHOWN)
def test_figures_of_other_verdicts_are_said_to_be_stale(
    name, arguments, record, rows, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(stale, "VERDICTS", tmp_path / "verdicts.jsonl")
    monkeypatch.setitem(now.PARTS, "diagnosis", lambda done, budget: ())
    monkeypatch.setattr(sys, "argv", [each.format(tmp_path / "rows") for each in arguments])
    path = Path(sys.argv[-1])
    module = runpy.run_path(str(ROOT / "bench" / "__main__.py"))["PROGRAMS"][name][0]
    main = importlib.import_module(f"{module}.__main__" if name != "now" else module).main

    def said():
        main()
        return [each for each in capsys.readouterr().out.splitlines() if "stale" in each]

    stale.VERDICTS.write_text('{"name": "a"}\n')
    path.write_text(json.dumps(record).replace(GOLDEN, stale.digest()))
    assert said() == []
    stale.VERDICTS.write_text('{"name": "b"}\n')
    (after,) = said()
    assert f"stale: {rows} of {rows} rows" in after
    assert stale.digest() in after


def test_what_is_made_states_the_verdicts_of_its_engine(tmp_path, monkeypatch):
    monkeypatch.setattr(stale, "VERDICTS", tmp_path / "verdicts.jsonl")
    stale.VERDICTS.write_text('{"name": "a"}\n')
    monkeypatch.setitem(now.PARTS, "tables", lambda done, budget: [("a", now.number_row(1, "-"))])
    now.measured("tables", tmp_path / "now.json", now.Budget(float("inf")))
    # printf '[["a", null, null]]' | sha256sum
    made = (now.read(tmp_path / "now.json")["tables"], score.engine())
    assert [each["golden"] for each in made] == ["986c3a541fe3"] * 2


def test_a_program_without_leave_writes_what_git_ignores(monkeypatch):
    parser = argparse.ArgumentParser()
    measure.add_out(parser, "speed")
    ignored, shown = (parser.parse_args(each).out for each in ([], ["--write"]))
    assert lines.files(str(shown.relative_to(ROOT))) == [shown]
    asked = ["git", "-C", str(ROOT), "check-ignore", "--quiet", str(ignored)]
    assert subprocess.run(asked, check=False).returncode == 0


def test_sound_tables_have_nothing_to_find():
    found = [diagnoses.sound_table(seed) for seed in range(12)]
    assert sum(kind == "none" for kind, *_ in found) >= 10
    assert len({p_value for _, p_value, _ in found}) == len(found)
    assert all(0.0 < p_value <= 1.0 and seconds > 0.0 for _, p_value, seconds in found)


def test_shares_have_their_interval():
    row = now.share_row(3, 20)
    assert (row["median"], row["n"]) == (0.15, 20)
    assert row["low"] < 0.06 < 0.34 < row["high"]


def test_each_program_of_the_list_is_there(capsys):
    bench = runpy.run_path(str(ROOT / "bench" / "__main__.py"))
    assert bench["main"](["list"]) == 0
    said = capsys.readouterr().out
    for name, (module, text) in bench["PROGRAMS"].items():
        assert f"{name:<14}{text}" in said
        assert importlib.util.find_spec(module) is not None
    assert bench["main"](["lost"]) == 2
