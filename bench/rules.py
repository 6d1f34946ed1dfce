"""``python -m bench rules``: which rules of the diagnosis decide anything, counted on the score.

`decide` takes the verdicts of all problems that `bench score` has diagnosed again, from the models
that it kept, each rule of the decision switched off or moved. `search` diagnoses 40 problems anew,
each rule of the search and of the noise switched off. A rule stays only if at least three problems
are worse without it. Counts are kept in rules.json with their engine.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import multiprocessing
import pickle
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from score.rows import KEPT, in_turns, row_of
from scores import Row, answer, markdown
from stale import code, digest, stale

from stickslip.diagnosis import pipeline
from stickslip.diagnosis.decision import gain, misfit_test, posterior, verdict
from stickslip.diagnosis.fitting import forms, models, options, search
from stickslip.diagnosis.fitting import law_forms as laws

STORED = Path(__file__).with_name("rules.json")
WORTH = {"right name": 3, "right set": 2, "large set": 1, "silent": 1, "rightly silent": 1}
"""Of an outcome; 0 of a wrong set or name."""
DECISION = verdict, posterior, gain, misfit_test
SEARCHED = 40  # problems of `search`: the first of part 1 of 8, which has the classes in turn
LEFT_OUT = "clean", "units", "walkers", "measured"  # that say little of a search, or take long
Patch = tuple[Any, str, Any]
Said = dict[str, tuple[str, str, list[str]]]
"""Outcome, verdict and causes of each problem."""


def numbers() -> Iterator[tuple[str, list[Patch]]]:
    """Each number of the decision, half as large again and a third smaller, in all its modules.

    Of a probability or a share above a half that is what it lacks of 1. Numbers of the test of
    misfit that the decision does not ask were used before, and stay out.
    """
    every = {(key, value) for user in DECISION[:3] for key, value in vars(user).items()
             if key.lstrip("_").isupper() and type(value) in (int, float)}  # fmt: skip
    for key, value in sorted(every):
        for by in (1.5, 1 / 1.5):
            moved = 1.0 - by * (1.0 - value) if 0.5 < value < 1.0 else value * by
            moved = type(value)(float(f"{moved:.3g}"))
            patches = [(user, key, moved) for user in DECISION if vars(user).get(key) == value]
            yield f"`{key}` {value:g} → {moved:g}", patches


@cache
def of_decision() -> dict[str, list[Patch]]:
    """The rules of the decision: patches by words."""
    nothing: Callable[..., list[Any]] = lambda *_, **__: []  # noqa: E731
    rules: dict[str, list[Patch]] = {"share and gain": [(verdict, "_takes_little", nothing)]}
    certain: Callable[..., Any] = lambda *_, **__: gain.Gain(1.0, 0.0, (0.5, 1.5))  # noqa: E731
    rules["held-out gain"] = [(one, "measured", certain) for one in (verdict, gain)]
    return rules | dict(numbers())


@cache
def of_search() -> dict[str, list[Patch]]:
    """The rules of search and noise, each off."""
    values = {
        "wide constants": {"widened": 1.0},
        "three causes": {"most_causes": 2},
        "three leaders": {"leaders": 1}, "bound of far fits": {"margin": math.inf},
    }  # fmt: skip
    rules: dict[str, list[Patch]] = {
        name: [(options.SEARCH, key, value) for key, value in each.items()]
        for name, each in values.items()
    }
    rules |= {
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


def decided(path: Path) -> tuple[str, Said]:
    """A problem that was kept, and what is said of it by the rules, "", and without each of them.

    Nothing where the rules say something else now: of a problem whose answer they do not give.
    """
    row, models, test = pickle.loads(path.read_bytes())
    found: Said = {}
    for rule, patches in {"": [], **of_decision()}.items():
        with patched(patches):
            said = verdict.decide(models, test)
        now = {**row, "said": said.kind, "causes": [*said.causes]}
        if not rule and (now["said"], now["causes"]) != (row["said"], row["causes"]):
            break
        found[rule] = answer(now).outcome, said.kind, sorted(said.causes)
    return row["problem"], found


def diagnosed(task: tuple[str, Any]) -> tuple[str, str, list[str]]:
    """What is said of a problem without a rule of the search."""
    rule, problem = task
    with patched(of_search()[rule] if rule else []):
        row = row_of(problem, keep=False)
    return row.get("outcome", row["class"]), row.get("said", ""), sorted(row.get("causes", ()))


def counted(before: Said, now: Said) -> Row:
    """Problems that are worse, better or otherwise different without a rule."""
    by = {name: WORTH.get(now[name][0], 0) - WORTH.get(before[name][0], 0) for name in now}
    changed = [name for name in now if now[name] != before[name]]
    return {
        "of": len(now), "worse": [name for name in changed if by[name] < 0],
        "better": [name for name in changed if by[name] > 0],
        "other": [name for name in changed if by[name] == 0], "golden": digest(),
    }  # fmt: skip


def decide(pool: Any) -> Iterator[tuple[str, Row]]:
    """Counts of the rules of the decision, of all that is kept of this engine."""
    found = dict(pool.imap_unordered(decided, sorted(KEPT.glob(f"{code()}/*.pickle")), 4))
    kept = {name: each for name, each in found.items() if each}
    if not kept:
        raise SystemExit(f"{KEPT}: nothing of this engine: first `bench score --part 1/8 --keep`")
    before = {name: each[""] for name, each in kept.items()}
    for rule in of_decision():
        yield rule, counted(before, {name: each[rule] for name, each in kept.items()})


def searched(pool: Any, rules: list[str]) -> Iterator[tuple[str, Row]]:
    """Counts of rules of the search, one after another."""
    fit = [each for each in in_turns(1, 8) if not each.group.startswith(LEFT_OUT)]
    problems, before = sorted(fit[:SEARCHED], key=lambda each: each.name), {}
    for rule in ["", *rules]:
        said = pool.map(diagnosed, [(rule, each) for each in problems], 1)
        now = {each.name: one for each, one in zip(problems, said, strict=True)}
        before = before or now
        if rule:
            yield rule, counted(before, now)


def page() -> str:
    """The counts as Markdown, rules that are needed first; others by their names."""
    parts = []
    for step, rows in json.loads(STORED.read_text()).items() if STORED.exists() else ():
        parts += stale(rows.values())
        order = sorted(rows.items(), key=lambda each: (-len(each[1]["worse"]), each[0]))
        kinds = "worse", "better", "other"
        cells = [(name, *(len(row[each]) or "" for each in kinds), row["of"])
                 for name, row in order if any(row[each] for each in kinds)]  # fmt: skip
        idle = ", ".join(name for name, _ in order if name not in {each[0] for each in cells})
        parts += [markdown(f"{step}, without;worse;better;other;of", cells),
                  f"Without any of these no verdict changes: {idle or 'none'}."]  # fmt: skip
    return "\n\n".join(parts)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench rules", description=__doc__)
    parser.add_argument("step", nargs="?", choices=("decide", "search"))
    parser.add_argument("--minutes", type=float, default=15.0, help="begin no rule after this time")
    asked = parser.parse_args()
    stored: dict[str, Any] = json.loads(STORED.read_text()) if STORED.exists() else {}
    if asked.step:
        rules = of_decision() if asked.step == "decide" else of_search()
        rows = stored[asked.step] = {rule: row for rule, row in stored.get(asked.step, {}).items()
                                     if rule in rules}  # fmt: skip
        left = [name for name in rules if rows.get(name, {}).get("golden") != digest()]
        ends = time.monotonic() + 60.0 * asked.minutes
        with multiprocessing.get_context("spawn").Pool(2) as pool:
            found = decide(pool) if asked.step == "decide" else searched(pool, left)
            for rule, row in found:
                rows[rule] = row
                STORED.write_text(json.dumps(stored, indent=1) + "\n")
                if time.monotonic() > ends:
                    break
    print(page())


if __name__ == "__main__":
    main()
