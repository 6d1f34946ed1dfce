"""``python -m bench rules``: which rules of the diagnosis decide anything, counted on known truths.

`keep` diagnoses the problems and keeps what the decision takes of each, in build/rules; `decide`
takes the verdicts again, each rule of the decision switched off or moved; `search` diagnoses 40
problems anew, each rule of the search and of the noise switched off. A rule stays only if at least
three problems are worse without it. Counts are kept in rules.json with their engine.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import math
import pickle
from collections.abc import Callable, Iterator
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from problems import PROBLEMS, ROOT
from scores import Answer, markdown, until
from stale import digest

from stickslip.diagnosis import pipeline
from stickslip.diagnosis.decision import verdict as decision
from stickslip.diagnosis.fitting import options

KEPT, STORED = ROOT / "build" / "rules", Path(__file__).with_name("rules.json")
TRUTHS = json.loads((ROOT / "bench" / "causes" / "truth.json").read_text())
WORTH = {"right name": 3, "right set": 2, "large set": 1, "silent": 1, "rightly silent": 1}
"""Of an outcome; 0 of a wrong set or name."""
DECISION = "verdict", "posterior", "gain", "misfit_test"  # modules
SEARCHED = 40  # problems of `search`, evenly over all
Patch = tuple[Any, str, Any]
Said = tuple[str, tuple[str, ...]]
Row = dict[str, Any]


def truth_of(name: str) -> tuple[str, ...] | None:
    """Listed causes that a problem hides; None where that is not known."""
    if name.startswith("toy "):
        return tuple({"weak wave": "wave"}.get(each, each) for each in name[4:].split(" and ")
                     if each in ("wave", "step", "bend", "weak wave"))  # fmt: skip
    known = TRUTHS.get(name)
    return known and ((known["cause"],) if known["cause"] and known["listed"] else ())


ASKED = [name for name in PROBLEMS if truth_of(name) is not None]


def worth(name: str, kind: str, causes: tuple[str, ...]) -> int:
    """Worth of an answer beside the truth."""
    return WORTH.get(Answer(kind, causes, truth_of(name) or ()).outcome, 0)


def _module(name: str) -> Any:
    return import_module(f"stickslip.diagnosis.{name}")


def numbers_of(module: str) -> Iterator[tuple[str, list[Patch]]]:
    """Each number in capitals of a module, half as large again and a third smaller, each user."""
    users = [_module(f"decision.{each}") for each in DECISION]
    for key, value in vars(_module(f"decision.{module}")).items():
        if key.lstrip("_").isupper() and type(value) in (int, float):
            for by in (1.5, 1 / 1.5):
                moved = type(value)(round(value * by, 6))
                patches = [(user, key, moved) for user in users if vars(user).get(key) == value]
                yield f"{module}.{key} = {moved:g}", patches


def of_decision() -> dict[str, list[Patch]]:
    """The rules of the decision: patches by words."""
    verdict, posterior = _module("decision.verdict"), _module("decision.posterior")
    nothing: Callable[..., list[Any]] = lambda *_, **__: []  # noqa: E731
    off = {
        "twins left open": ("_open_twins", nothing), "size at an end": ("_at_end", nothing),
        "pattern in the settings": ("follows_settings", lambda *_: False),
        "nothing less explains": ("_nothing_less", lambda *_: False),
        "proof of what explains": ("_proven", lambda *_: True),
        "share and gain of a claim": ("_takes_little", nothing),
        "all against a discrepancy": ("_against", nothing),
        "own gain of blocks": ("in_blocks", lambda _: False),
        "misfit of both sides": ("chance_of_other_constants", lambda *_: 0.0),
        "held-out gain": ("measured", lambda *_: None),
        "far constants prove": ("FAR_OFF", math.inf),
    }  # fmt: skip
    rules: dict[str, list[Patch]] = {name: [(verdict, *each)] for name, each in off.items()}
    rules["half a lead between twins"] = [(one, "ALIKE", 2.0) for one in (verdict, posterior)]
    return rules | dict(itertools.chain(*map(numbers_of, DECISION)))


def of_search() -> dict[str, list[Patch]]:
    """The rules of search and noise, each off."""
    names = "search", "models", "law_forms", "forms"
    search, models, laws, forms = (_module(f"fitting.{name}") for name in names)
    none: Callable[..., None] = lambda *_, **__: None  # noqa: E731
    values = {
        "second scan": {"doubtful": 0.0}, "fits from rivals' constants": {"rivals": 0},
        "small amplitudes": {"small": ()}, "weaker singles beside": {"comfortable": math.inf},
        "end by chi-square": {"explains": 2.0}, "rounds end far away": {"pays": 2.0},
        "other forms of few": {"other_forms": 99},
        "other forms of what gains": {"refitted": 99.0},
        "draws": {"drawn": 0}, "wide constants": {"widened": 1.0},
        "three causes": {"most_causes": 2},
        "three leaders": {"leaders": 1}, "bound of far fits": {"margin": math.inf},
    }  # fmt: skip
    rules: dict[str, list[Patch]] = {
        name: [(options.SEARCH, key, value) for key, value in each.items()]
        for name, each in values.items()
    }
    rules |= {
        "nested singles": [(search, "_nest_singles", none)],
        "exact fits again": [(search, "_fit_exact_again", none)],
        "what leaves too little": [(search, "_leaves_too_little", lambda *_: False)],
        "promise of a neighbour": [(search, "_may_improve", lambda *_: True)],
        "forms of a law": [(pipeline, "with_forms", lambda each: each)],
        "smaller amplitudes of the leader": [(options.SMOOTH, "smaller", ())],
        "central slopes": [
            (module, "sharpened", unsharpened) for module in (pipeline, search, laws)
        ],
    }
    every = forms.forms
    for gone in [each for each in forms.PRIOR if each != "exact"]:
        kept = [each for each in forms.PRIOR if each != gone]
        rules[f"noise {gone}"] = [
            (module, "forms", lambda problem, wanted=tuple(kept), kept=kept: every(
                problem, [each for each in wanted if each in kept])) for module in (search, models)
        ]  # fmt: skip
    return rules


def unsharpened(_problem: Any, _form: Any, old: Any) -> Any:
    """A fit as it is; a generator, as all that asks for predictions in batches."""
    return old
    yield


@contextlib.contextmanager
def patched(patches: list[Patch]) -> Iterator[None]:
    """Change attributes while the block runs; those of frozen options too."""
    before = [(where, key, vars(where)[key]) for where, key, _ in patches]
    try:
        for where, key, value in patches:
            vars(where)[key] = value
        yield
    finally:
        for where, key, value in before:
            vars(where)[key] = value


def keep(minutes: float) -> None:
    """Diagnose the problems that are not kept yet, and keep models and test of each."""
    KEPT.mkdir(parents=True, exist_ok=True)
    taken: list[Any] = []

    def decide(*given: Any) -> decision.Verdict:
        taken.append(given)
        return decision.decide(*given)

    with patched([(pipeline, "decide", decide)]):
        for name in until(minutes, ASKED):
            path = KEPT / f"{digest()} {name}.pickle"
            if not path.exists():
                taken.clear()
                PROBLEMS[name].diagnosed(1)
                if taken:  # none of a problem of the data
                    path.write_bytes(pickle.dumps(taken))


def kept() -> dict[str, Any]:
    """Models and test of each problem that is kept of the present engine."""
    files = {name: KEPT / f"{digest()} {name}.pickle" for name in ASKED}
    return {name: pickle.loads(path.read_bytes()) for name, path in files.items() if path.exists()}


def retaken(given: dict[str, Any]) -> dict[str, Said]:
    """Verdicts of what is kept, taken again."""
    found = {name: decision.decide(models, test) for name, ((models, test),) in given.items()}
    return {name: (said.kind, said.causes) for name, said in found.items()}


def diagnosed(names: list[str]) -> dict[str, Said]:
    """Verdicts of problems, diagnosed anew."""
    found = {name: PROBLEMS[name].diagnosed(1).verdict for name in names}
    return {name: (said.kind, said.causes) for name, said in found.items()}


def counted(before: dict[str, Said], now: dict[str, Said]) -> Row:
    """Problems that are worse, better or otherwise different without a rule."""
    by = {name: worth(name, *now[name]) - worth(name, *before[name]) for name in now}
    changed = [name for name in now if now[name] != before[name]]
    return {
        "of": len(now), "worse": [name for name in changed if by[name] < 0],
        "better": [name for name in changed if by[name] > 0],
        "other": [name for name in changed if by[name] == 0], "golden": digest(),
    }  # fmt: skip


def table(rows: dict[str, Row]) -> str:
    """The counts as Markdown, the rules that are needed first."""
    order = sorted(rows.items(), key=lambda each: (-len(each[1]["worse"]), each[0]))
    cells = [(name, *(len(row[each]) or "" for each in ("worse", "better", "other")), row["of"])
             for name, row in order]  # fmt: skip
    return markdown("without the rule;worse;better;other;of", cells)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench rules", description=__doc__)
    parser.add_argument("step", nargs="?", choices=("keep", "decide", "search"))
    parser.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    options = parser.parse_args()
    stored: dict[str, Any] = json.loads(STORED.read_text()) if STORED.exists() else {}
    if options.step == "keep":
        keep(options.minutes)
        return
    if options.step:
        rules = of_decision() if options.step == "decide" else of_search()
        given, names = kept(), ASKED[:: math.ceil(len(ASKED) / SEARCHED)]
        ask = partial(retaken, given) if options.step == "decide" else partial(diagnosed, names)
        if options.step == "decide" and len(given) < len(ASKED):
            raise SystemExit(f"{len(given)} of {len(ASKED)} problems are kept: first `keep`")
        rows, before = stored.setdefault(options.step, {}), ask()
        stale = [name for name in rules if rows.get(name, {}).get("golden") != digest()]
        for name in until(options.minutes, stale if options.step == "search" else rules):
            with patched(rules[name]):
                rows[name] = counted(before, ask())
            STORED.write_text(json.dumps(stored, indent=1) + "\n")
    for step, rows in stored.items():
        print(f"\n{step}\n", table(rows), sep="\n")


if __name__ == "__main__":
    main()
