"""The documentation: what its code does and prints, and whether all that is public is on it."""

import doctest
import importlib
import json
import pkgutil
import re
from collections import Counter

import numpy as np
import pytest
from blind import own
from blind.finished import answer_of_change
from blind.scoring import Case, read
from blind.study import lines
from causes.__main__ import ANSWERS
from causes.make import TRUTH
from causes.score import judged
from report_keys import WORDS, reference
from scores import CLAIMS, Answer

import stickslip
from documentation_blocks import DOCS, PAGES, ROOT, blocks, by_name, pages, play
from own_effects import nothing_stays  # noqa: F401
from stickslip import Drive, Scenario, simulate
from stickslip.cli import BAD_INPUT, FAILED, INTERRUPTED
from stickslip.scenario.effects import is_free_shape
from test_reference_agreement import AGREEMENT, SCENARIOS

MEASURED = DOCS / "measured"
STUDY = ROOT / "bench" / "blind" / "study" / "record.jsonl"
LAWS = ROOT / "bench" / "blind" / "laws" / "record.jsonl"
OWN = STUDY.with_name("own.jsonl")


def modules():
    found = pkgutil.walk_packages(stickslip.__path__, "stickslip.")
    left = ("__main__", "_core", "_machines")
    return [each.name for each in found if not each.name.endswith(left)]


def _is_slow(page):
    # Whole diagnoses and searches, films, what learns, and what was measured to take seconds.
    code = [block.text for block in blocks(page) if block.language != "text"]
    return page.stem in ("sweeps", "control", "own-laws", "shaken-walkers") or any(
        word in text
        for text in code
        for word in ("diagnose", "propose_experiments(", "animation(", "optimise(", "gymnasium")
    )


@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=pytest.mark.nightly if _is_slow(page) else ()) for page in PAGES],
    ids=by_name,
)
def test_the_code_of_a_page_runs_and_prints_what_it_says(page):
    if any("import mujoco\n" in block.text for block in blocks(page)):
        pytest.importorskip("mujoco")
    with play(page):
        pass


@pytest.mark.parametrize("name", modules())
def test_examples_in_docstrings(name):
    module = importlib.import_module(name)
    names = {each: getattr(stickslip, each) for each in stickslip.__all__}
    failed, _ = doctest.testmod(module, extraglobs=names, optionflags=doctest.ELLIPSIS)
    assert failed == 0


def test_every_public_name_is_on_one_page_of_the_interface():
    listed = [
        name
        for page in pages(DOCS / "reference" / "api")
        for name in re.findall(r"^\.\. auto\w+:: ([\w.]+)$", page.read_text(), re.MULTILINE)
    ]
    assert len(listed) == len(set(listed))
    names = set(stickslip.__all__) - {"__version__", "events", "instruments", "models", "plot"}
    for home in (stickslip.plot, stickslip.models):
        names |= {f"{home.__name__}.{name}" for name in home.__all__}
    for module, known in {"events": "step", "instruments": "scale"}.items():
        home = getattr(stickslip, module)
        made = {
            name
            for name, each in vars(home).items()
            if getattr(each, "__module__", "") == home.__name__ and not name.startswith("_")
        }
        assert known in made
        names |= {f"stickslip.{module}.{name}" for name in made}
    assert names <= set(listed), names - set(listed)


def test_the_page_for_assistants_has_each_verdict_and_exit_status_and_names_keys():
    text = (DOCS / "agents.md").read_text()
    statuses = {int(each) for each in re.findall(r"^\| (\d+) \|", text, re.MULTILINE)}
    assert statuses == {0, FAILED, BAD_INPUT, INTERRUPTED}
    first = re.findall(r"^\| `([\w-]+)` \| ", text, re.MULTILINE)
    assert first == ["verdict", *WORDS["verdict"]]
    named = {*re.findall(r"`([\w-]+)`", text)} - {*WORDS["verdict"], "sd"}
    assert named <= {*reference()}


def beside_other_tools():
    """Counts of the benchmark of named causes, walkers apart, as the README has them."""
    truths = {name: truth for name, truth in json.loads(TRUTH.read_text()).items()
              if truth["cause"] and not name.startswith("walker")}  # fmt: skip
    yield f"on {len(truths)} questions about logs of five machines"
    for tool, words in (("best-BIC", "least squares, best BIC"), ("stepwise-F", "stepwise F-tests"),
                        ("stickslip", "stickslip")):  # fmt: skip
        answers = json.loads((ANSWERS / f"{tool}.json").read_text())
        said = {listed: [judged(answers[name], truth).outcome for name, truth in truths.items()
                         if truth["listed"] is listed] for listed in (True, False)}  # fmt: skip
        yes, no = said[True], said[False]
        yield (
            f"| {words} | {yes.count('right name')} of {len(yes)} |"
            f" {yes.count('right set') + yes.count('large set')} | {yes.count('wrong name')} |"
            f" {no.count('wrong name')} of {len(no)} | {no.count('wrong set')} |"
        )


def most_of(rows):
    """The commit of most rows of a study, all of one engine by its golden verdicts."""
    rows = list(rows)
    (_,) = {row["state"]["golden"] for row in rows}
    return Counter(row["state"]["commit"] for row in rows).most_common(1)[0][0]


def measured_words():
    """Measured and counted figures, from their files, as the words of each page."""
    speed, peers, real = (
        json.loads((MEASURED / f"{name}.json").read_text()) for name in ("speed", "peers", "real")
    )
    fast = {row["rtol"]: row["simulated_per_cpu_second"] for row in speed["tolerances"]
            if row["method"] == "tsit5"}  # fmt: skip
    scipy, heyoka = (
        sorted(row["ratio"] for row in peers["rows"]
               if row["peer"] == name and row["unit"] == "CPU s / simulated s")
        for name in ("scipy", "heyoka")
    )  # fmt: skip
    creep = {row["who"]: row["drift_mm"] for row in peers["creep"]}
    assert creep["stickslip"] == 0.0
    # 0.0325 ± 0.0031 rad (known: 0.0334)
    offset = real["rows"]["250 drops, heights, listed: yes"]["size"]
    found, error, known = (1e3 * float(each) for each in re.findall(r"[\d.]+", offset))
    # Of tumbler and rollers nothing is known: a claim is at best not contradicted.
    sure = [row for row in real["rows"].values()
            if row["listed"] == "yes" and row["set"] not in ("tumbler", "rollers")]  # fmt: skip
    true = [row for row in sure if row["judgement"] in ("right", "set with the truth")]
    assert not any(row["judgement"].startswith("wrong") for row in real["rows"].values())
    share = {name: row["share"] for name, row in real["rows"].items()}
    untold = json.loads((MEASURED / "untold.json").read_text())
    kinds = untold["kinds"].values()
    made, said, wrongly = (
        len(kinds) * untold["of each"],
        *(sum(row[what] for row in kinds) for what in ("said", "wrongly")),
    )
    stated = sum(not is_free_shape(each.name) for each in stickslip.effects())
    rows = list(lines(OWN))
    # The study is of one engine.
    (commit,) = {row["state"]["commit"] for row in rows}
    listed, unlisted, nothing = (
        [row for row in rows if row["hidden"] == each] for each in ("listed", "unlisted", "none")
    )
    alike = [row for row in unlisted if own.group(row).endswith(" alike")]
    unlike = {
        of_line: [
            row for row in unlisted if row not in alike and (row["kind"] == "line") == of_line
        ]
        for of_line in (True, False)
    }

    def claims_of(some):
        return sum(own.answer(row).claims for row in some) or "none"

    right, sets = (
        sum(own.answer(row).outcome == each for row in listed)
        for each in ("right name", "right set")
    )
    counts = [
        f"as of commit `{commit}`: {len(rows)} made logs and tables",
        f"Of {len(listed)} with a hidden cause that is listed it claims the right one in {right},"
        f" and another in {'none' if claims_of(listed) == right else claims_of(listed) - right}; in"
        f" {sets} more it gives a set of at most three that holds it.",
        f"Of {len(unlisted)} whose cause is not listed it claims another one in"
        f" {claims_of(unlisted)}: in {claims_of(alike)} of {len(alike)} where a listed one acts"
        f" alike, and in {claims_of(unlike[False])} of {len(unlike[False])} logs and"
        f" {claims_of(unlike[True])} of {len(unlike[True])} tables where none does. With nothing"
        f" hidden it claims a cause in {claims_of(nothing)} of {len(nothing)}.",
    ]
    record = read(STUDY)
    judged = most_of(record)
    walkers = [case for case in map(Case, record) if case.counted]
    hiding, other, empty = (
        [case for case in walkers if case.group == each]
        for each in ("listed", "unlisted", "nothing")
    )
    claims = sum(case.any_claim for case in hiding)
    right_ones = sum(case.any_claim and case.causes <= case.all_hidden for case in hiding)
    in_sets = sum(case.told.outcome == "right set" for case in hiding)
    wrong_ones = sum(case.any_claim and not case.place_right for case in other)
    counts_of_walkers = [
        f"{len(record)} sets of walkers, as of commit `{judged}`",
        f"Of {len(hiding)} with hidden causes or constants that are listed it claims such ones in"
        f" {right_ones}, and others in {claims - right_ones or 'none'}; in {in_sets} more it gives"
        " such a set.",
        f"Of {len(other)} whose cause is not listed it claims a listed one in"
        f" {wrong_ones or 'none'}, and of {len(empty)} with nothing hidden in"
        f" {sum(case.any_claim for case in empty) or 'none'}.",
    ]
    cases = [case for case in map(Case, read(LAWS)) if case.counted]
    law, sound = (
        [case for case in cases if case.group == each] for each in ("unlisted", "nothing")
    )
    shaped = [case for case in law if case.right_shape]
    counts_of_laws = [
        f"{len(cases)} sets of 24 velocities, as of commit `{most_of(case.row for case in cases)}`",
        f"Of {len(law)} with such a law the diagnosis says where it acts in"
        f" {sum(case.hook_right for case in law)}, and claims a cause that acts elsewhere in"
        f" {sum(case.any_claim and not case.hook_right for case in law) or 'none'}. In"
        f" {len(shaped)} it tells a curve; in {sum(case.form_among(True) for case in shaped)} of"
        f" these the right form is one of those that have 95 %. Of {len(sound)} with nothing"
        f" hidden it claims a cause in {sum(case.any_claim for case in sound) or 'none'}.",
    ]
    logs = {
        name: list(lines(OWN.with_name(f"{name}.jsonl")))
        for name in ("units", "twins", "late", "clean", "servo")
    }
    servos = [[own.answer(row).outcome for row in logs["servo"] if bool(row["cause"]) == hidden]
              for hidden in (True, False)]  # fmt: skip
    wrong = [row for row in logs["units"] if row["wrong"]]
    bare = sum(row["verdict"] in CLAIMS and not row["told"] for row in wrong)
    told = [Answer(row["verdict"], row["causes"], [row["cause"]]).outcome for row in logs["twins"]]
    off = {line: [row["z"] for row in logs["late"] if row["input"] == line]
           for line in ("held", "line")}  # fmt: skip
    rms = {line: np.sqrt(np.mean(np.square(each))) for line, each in off.items()}
    counts_of_logs = [
        f"Of {len(logs['clean'])} more with nothing hidden it claims a cause in"
        f" {claims_of(logs['clean'])} (commit `{logs['clean'][0]['state']['commit']}`)",
        f"Of {len(servos[0])} servos with a hidden cause {servos[0].count('right name')} are named,"
        f" {servos[0].count('right set')} are in a set of at most three, and"
        f" {servos[0].count('wrong name') or 'none'} gets another name; of {len(servos[1])} without"
        " one"
        f" {claims_of(row for row in logs['servo'] if not row['cause'])} is claimed (commit"
        f" `{logs['servo'][0]['state']['commit']}`)",
        f"Of {len(wrong)} logs in a unit that nobody stated,"
        f" {sum(row['right'] for row in wrong)} are told with the right factor and"
        f" {bare or 'none'} is named without it.",
        f"Of {len(told)} logs of near twins that a distorted sensor has read,"
        f" {told.count('right name')} get the right name, {told.count('right set')} a set of at"
        f" most three that holds it, {told.count('wrong name') or 'none'} a wrong name.",
        f"The delay of an input, told of {sum(map(len, off.values()))} logs, is off by"
        f" {rms['held']:.2f} (held inputs) and {rms['line']:.2f} (lines) of its standard errors",
    ]
    sizes = list(lines(OWN.with_name("intervals.jsonl")))
    of_pairs = list(lines(OWN.with_name("changes.jsonl")))
    differ, same = ([(row, answer_of_change(row).outcome) for row in of_pairs
                     if bool(row["change"]) == some] for some in (True, False))  # fmt: skip
    ends = [outcome for _, outcome in differ]
    counts_of_pairs = (
        f"{len(of_pairs)} simulated pairs of logs ([beside other tools]"
        f"(../accuracy.md#blind-study)): of {len(ends)} with one difference"
        f" {ends.count('right name')} are named, {ends.count('right set')} more are in a set of"
        f" at most three, and {ends.count('wrong name') or 'none'} is named wrongly. Of"
        f" {len(same)} without one,"
        f" {sum(outcome != 'rightly silent' for _, outcome in same) or 'none'} is said to differ;"
        f" in {sum(row['verdict'] == 'unexplained' for row, _ in same)}, with other inputs"
    )
    return {
        "docs/howto/what-changed.md": [counts_of_pairs],
        "README.md": [
            f"within {100 * AGREEMENT:g} % in velocity in each of {len(SCENARIOS)} different walks",
            f"creeps by {1e3 * creep['mujoco, step 40 us, impratio 1']:.1f} um in a second",
            "{:.0f} to {:.0f} times faster than SciPy's".format(*np.round(scipy[::2], -1)),
            f"{heyoka[0]:.1f} to {heyoka[-1]:.1f} times faster than heyoka",
            f"{fast[1e-8]:.0f} simulated seconds per CPU second at the default `rtol` of 1e-8,"
            f" {fast[1e-6]:.0f} at 1e-6",
            *beside_other_tools(),
            *counts,
            counts_of_walkers[1],
            f"That is as of commit `{judged}`.",
            "from 250 drops of a real square the diagnosis found that the angle readings are too"
            f" large by {found:.1f} ± {error:.1f} mrad (known: {known:.1f})",
            f"{stated} optional effects",
        ],
        "docs/accuracy.md": [
            *counts,
            *counts_of_walkers,
            *counts_of_laws,
            *counts_of_logs,
            f"{len(sizes)} sets as of commit `{most_of(sizes)}`:",
            "none is claimed wrongly, with the cause listed or not; "
            f"{len(true)} of {len(sure)} end right or as a set",
        ],
        "docs/howto/diagnose.md": [
            f"[{said} of {made} sets](../accuracy.md#what-data-cannot-tell) made to hide"
            f" something, and in {wrongly} of {made} others",
        ],
        "docs/howto/real-cases.md": [
            f"the asymmetry takes {share['axis, 20 Hz, listed: yes']} of the squared error",
            "the verdict is `dominant`, with "
            + real["rows"]["axis, 20 Hz, listed: yes"]["size"].partition(" N s/m")[0],
            "Means over ten segments name it: "
            + real["rows"]["axis, ten segments, listed: yes"]["size"].partition(" (")[0],
            f"beside it (both take {share['axis, four repeats, listed: yes']}) stays open",
            f"a limit of the angles takes {share['tumbler, listed: no']} of",
            f"they take {share['tanks, listed: yes']} of the squared error",
            f"an uneven surface together take {share['slider, listed: yes']}",
            f"angles are read {found:.1f} ± {error:.1f} mrad too large",
            f"does not see, say {known:.1f})",
        ],
    }


def test_what_the_pages_say_was_measured_is_in_its_file():
    for page, stated in measured_words().items():
        said = " ".join((ROOT / page).read_text().split())
        for words in stated:
            assert words in said, (page, words)


def test_every_count_of_the_blind_study_is_that_of_rows():
    _, _, text = (DOCS / "accuracy.md").read_text().partition("## Blind study")
    said = " ".join(text.partition("\n## ")[0].split())
    for words in measured_words()["docs/accuracy.md"]:
        said = said.replace(words, "")
    assert re.findall(r"(?:\d+ (?:of|sets)|[Oo]f|in) \d+\b(?! %)", said) == []


def test_every_number_that_the_readme_argues_with_was_measured():
    _, _, text = (ROOT / "README.md").read_text().partition("## Why believe it")
    said = " ".join(text.partition("\n## ")[0].split())
    for words in measured_words()["README.md"]:
        said = said.replace(words, "")
    assert re.findall(r".{,20}\d.{,20}", said) == []


def test_the_speeds_of_the_readme_are_those_of_the_film():
    film = Scenario(drive=Drive(frequency=50, base=0.3e-3, pulses=30))  # that of the pictures
    single, pairs = (
        1e3 * simulate(each).mean_velocity
        for each in (film, film.replace({"drive.coils": "pairs"}))
    )
    said = " ".join((ROOT / "README.md").read_text().split())
    assert f"walks at {single:.2g} mm/s (50 Hz, base 0.3 mT)" in said
    assert f"the walk alone makes {pairs:.2g} mm/s" in said


def test_the_answers_of_the_exercises_are_what_is_simulated():
    first = Scenario(drive=Drive(mode="IPP", frequency=100, peak=2.5e-3, base=0.5e-3, pulses=12))
    back = {"drive.frequency": 30, "drive.edge": "fall"}
    said = " ".join((DOCS / "teach.md").read_text().split())
    for words, changes in (
        ("walks at {:.2f} mm/s", {}),
        ("*{:.2f} mm/s: at 100 Hz the coils", {"drive.frequency": 30}),
        ("slides back, at {:.2f} mm/s", back),
        ('(`drive.coils = "pairs"`) at {:.2f} mm/s', back | {"drive.coils": "pairs"}),
        ("walk at {:.1f} mm/s", {"contact.static_friction": 0, "contact.kinetic_friction": 0}),
    ):
        velocity = simulate(first.replace(changes)).mean_velocity
        assert words.format(1e3 * velocity) in said, (words, velocity)


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_a_page_cites_the_paper_as_the_citation_does(page):
    text = " ".join((ROOT / page).read_text().split())
    year = re.search(r"year: (\d+)", (ROOT / "CITATION.cff").read_text())[1]
    assert re.findall(r"Science and Systems[^;.]*?(\d{4})", text) == [year]


def test_the_citation_is_of_this_version():
    text = (ROOT / "CITATION.cff").read_text()
    assert f"\nversion: {stickslip.__version__}\n" in text
    for word in ("cff-version: 1.2.0", "Pawashe", "Floyd", "Sitti", "2008"):
        assert word in text
