"""The documentation: what its code does and prints, and whether all that is public is on it."""

import doctest
import importlib
import json
import pkgutil
import re
from collections import Counter

import numpy as np
import pytest
from causes.__main__ import ANSWERS
from report_keys import WORDS, reference
from score.rows import HERE, read
from scores import answer, counts

import stickslip
from documentation_blocks import DOCS, PAGES, ROOT, blocks, by_name, pages, play
from own_effects import nothing_stays  # noqa: F401
from stickslip import Drive, Scenario, simulate
from stickslip.cli import BAD_INPUT, FAILED, INTERRUPTED
from stickslip.scenario.effects import is_free_shape
from test_reference_agreement import AGREEMENT, SCENARIOS

MEASURED = DOCS / "measured"
EARLIER = read(HERE / "earlier.jsonl")


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
    for tool, words in (("best-BIC", "least squares, best BIC"), ("stepwise-F", "stepwise F-tests"),
                        ("stickslip", "stickslip")):  # fmt: skip
        rows = EARLIER if tool == "stickslip" else read(ANSWERS / f"{tool}.json")
        yes, no = (outcomes(f"logs, {which}", rows) for which in ("listed", "not listed"))
        yield f"on {yes.total() + no.total()} questions about logs of five machines"
        yield (
            f"| {words} | {yes['right name']} of {yes.total()} |"
            f" {yes['right set'] + yes['large set']} | {yes['wrong name']} |"
            f" {no['wrong name']} of {no.total()} | {no['wrong set']} |"
        )


def of_class(name, rows=EARLIER):
    return [row for row in rows
            if f"{row['class']}, ".startswith(f"{name}, ") and "state" not in row]  # fmt: skip


def outcomes(name, rows=EARLIER):
    return Counter(answer(row).outcome for row in of_class(name, rows))


def claims(rows):
    return sum(answer(row).claims for row in rows) or "none"


def most_of(rows):
    """The commit of most rows of a study, all of one engine by its golden verdicts."""
    rows = list(rows)
    (_,) = {row["engine"]["golden"] for row in rows}
    return Counter(row["engine"]["commit"] for row in rows).most_common(1)[0][0]


def counts_of_own():
    """Sentences on models of one's own, which are of one engine."""
    rows = of_class("own")
    (commit,) = {row["engine"]["commit"] for row in rows}
    listed, unlisted = outcomes("own, listed"), of_class("own, not listed")
    alike, unlike = (of_class(f"own, not listed, {each}") for each in ("alike", "unlike"))
    lines = of_class("own, not listed, unlike, few repeats")
    nothing = of_class("own, nothing")
    return [
        f"as of commit `{commit}`: {len(rows)} made logs and tables",
        f"Of {listed.total()} with a hidden cause that is listed it claims the right one in"
        f" {listed['right name']}, and another in {listed['wrong name'] or 'none'}; in"
        f" {listed['right set']} more it gives a set of at most three that holds it.",
        f"Of {len(unlisted)} whose cause is not listed it claims another one in"
        f" {claims(unlisted)}: in {claims(alike)} of {len(alike)} where a listed one acts"
        f" alike, and in {claims(row for row in unlike if row not in lines)} of"
        f" {len(unlike) - len(lines)} logs and {claims(lines)} of {len(lines)} tables where none"
        f" does. With nothing hidden it claims a cause in {claims(nothing)} of {len(nothing)}.",
    ]


def counts_of_walkers_and_laws():
    hiding, other = outcomes("walkers, listed"), outcomes("walkers, not listed")
    rows, empty = of_class("walkers"), of_class("walkers, nothing")
    yield f"{len(rows)} sets of walkers, as of commit `{most_of(rows)}`"
    yield (
        f"Of {hiding.total()} with hidden causes or constants that are listed it claims such ones"
        f" in {hiding['right name']}, and others in {hiding['wrong name'] or 'none'}; in"
        f" {hiding['right set']} more it gives such a set."
    )
    yield (
        f"Of {other.total()} whose cause is not listed it claims a listed one in"
        f" {other['wrong name'] or 'none'}, and of {len(empty)} with nothing hidden in"
        f" {claims(empty)}."
    )
    laws, sound = outcomes("laws, a law"), of_class("laws, nothing")
    rows = of_class("laws")
    yield f"{len(rows)} sets of 24 velocities, as of commit `{most_of(rows)}`"
    yield (
        f"Of {laws.total()} with such a law it claims where it acts in {laws['right name']}, and a"
        f" cause that acts elsewhere in {laws['wrong name'] or 'none'}; of {len(sound)} with"
        f" nothing hidden it claims a cause in {claims(sound)}."
    )


def counts_of_logs():
    clean, servos = of_class("clean"), outcomes("servo, listed")
    idle, twins = of_class("servo, nothing"), outcomes("twins")
    yield (
        f"Of {len(clean)} more with nothing hidden it claims a cause in"
        f" {claims(clean)} (commit `{clean[0]['engine']['commit']}`)"
    )
    yield (
        f"Of {servos.total()} servos with a hidden cause {servos['right name']} are named,"
        f" {servos['right set']} are in a set of at most three, and"
        f" {servos['wrong name'] or 'none'} gets another name; of {len(idle)} without one"
        f" {claims(idle)} is claimed (commit `{idle[0]['engine']['commit']}`)"
    )
    units = sum((outcomes(f"units not stated, {each}")
                 for each in ("time", "reading", "input", "constant")), Counter())  # fmt: skip
    yield (
        f"Of {units.total()} logs in a unit that nobody stated, {units['right name']} are told"
        f" with the right factor and {units['wrong name'] or 'none'} is named without it."
    )
    yield (
        f"Of {twins.total()} logs of near twins that a distorted sensor has read,"
        f" {twins['right name']} get the right name, {twins['right set']} a set of at"
        f" most three that holds it, {twins['wrong name'] or 'none'} a wrong name."
    )
    rms = {
        kind: np.sqrt(np.mean([((one["estimate"] - one["true"]) / one["sd"]) ** 2
                               for row in of_class(f"late, {kind}") for one in row["sizes"]]))
        for kind in ("held", "line")
    }  # fmt: skip
    yield (
        f"The delay of an input, told of {len(of_class('late'))} logs, is off by"
        f" {rms['held']:.2f} (held inputs) and {rms['line']:.2f} (lines) of its standard errors"
    )
    sizes = counts(of_class("intervals"), {})
    yield (
        f"Of {sizes['sizes']} sizes beside an error of the model {sizes['held']} lie in their"
        " 95 % intervals"
    )


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
    own, counts_of_walkers = counts_of_own(), list(counts_of_walkers_and_laws())
    pairs, same = outcomes("pairs, a change"), of_class("pairs, no change")
    counts_of_pairs = (
        f"{pairs.total() + len(same)} simulated pairs of logs: of {pairs.total()} with one"
        f" difference {pairs['right name']} are named, {pairs['right set']} more are in a set of"
        f" at most three, and {pairs['wrong name'] or 'none'} is named wrongly. Of"
        f" {len(same)} without one,"
        f" {sum(answer(row).outcome != 'rightly silent' for row in same) or 'none'} is said to"
        f" differ; in {sum(row['said'] == 'unexplained' for row in same)}, with other inputs"
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
            *own,
            counts_of_walkers[1],
            f"That is as of commit `{most_of(of_class('walkers'))}`.",
            "from 250 drops of a real square the diagnosis found that the angle readings are too"
            f" large by {found:.1f} ± {error:.1f} mrad (known: {known:.1f})",
            f"{stated} optional effects",
        ],
        "docs/accuracy.md": [
            *own,
            *counts_of_walkers,
            *counts_of_logs(),
            "none is claimed wrongly, with the cause listed or not; "
            f"{len(true)} of {len(sure)} end right or as a set",
        ],
        "docs/howto/diagnose.md": [
            f"[{said} of {made} sets](../accuracy.md#what-data-cannot-tell) made to hide"
            f" something, and in {wrongly} of {made} others",
        ],
        "docs/howto/real-cases.md": [
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
