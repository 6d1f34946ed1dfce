"""Rows of the score: problems that are diagnosed in parts, and files of rows.

A row is a line of JSON: the `class` and the name of the `problem`, with its `seed` if it is drawn;
the `truth`, causes that are hidden, and whether they are `listed`; the verdict `said`, its `causes`
and the `outcome`; `sizes` of right models, each true and estimated with the ends of 95 %; `width`,
of the cause's interval over that of a fit with the truth's causes and no discrepancy; the p-value
`p` of the misfit, `cpu` seconds, and the `engine`. A row without an answer has a `state`. `far` are
parameters far from a known size, `also` causes that may act besides, `alike` says whether two logs
have the same inputs, `by` whether readings alone tell the cause or what is stated of the constants.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import multiprocessing
import pickle
import re
import subprocess
import time
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from blind.seeds import used
from causes.make import TRUTH
from scores import Row, answer
from stale import code, digest

from score.problems import CLASSES, SLOW, Asked, Problem, of_causes
from stickslip import Diagnosis, ScenarioError
from stickslip.diagnosis.decision.candidate import Candidate

HERE = Path(__file__).resolve().parent
ROWS = HERE / "rows.jsonl"
KEPT = HERE.parents[1] / "build" / "kept"
"""What the decision took of each problem, a folder for each engine."""
FAR = 3.0
"""Standard deviations. Chosen: an estimate farther from what is known than that is wrong."""
WORD = 200  # characters of a refusal that are kept
SIZE = ["true", "estimate", "sd", "low", "high"]  # of a row's sizes


def lines(path: Path) -> Iterator[Row]:
    """Rows of a file that is appended to, without those that were not written to their end."""
    for line in path.read_text().splitlines() if path.exists() else ():
        with contextlib.suppress(json.JSONDecodeError):
            yield json.loads(line)


def append(path: Path, row: Row) -> None:
    """Append a row, on a line of its own after one that was cut off."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a+b") as file:
        cut = file.tell() and file.seek(-1, 2) and file.read() != b"\n"
        file.write(b"\n" * bool(cut) + json.dumps(row).encode() + b"\n")


def engine() -> dict[str, str]:
    """The commit, the sum of the golden verdicts, and that of the code: rows of one are alike."""
    asked = ("git", "-C", str(HERE), "rev-parse", "--short", "HEAD")
    commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    return {"commit": commit, "golden": digest(), "code": code()}


def of_tool(path: Path) -> list[Row]:
    """Rows of a tool's answers to the benchmark of causes."""
    truths = json.loads(TRUTH.read_text())
    groups = {each.name: each.group for walkers in (False, True) for each in of_causes(walkers)}
    return [
        {"class": groups[name], "problem": name, "listed": truths[name]["listed"], **one,
         "truth": [truths[name]["cause"]] * bool(truths[name]["cause"])}
        for name, one in json.loads(path.read_text()).items()
    ]  # fmt: skip


def read(path: Path) -> list[Row]:
    """Rows of a file, or of a tool's answers."""
    return of_tool(path) if path.suffix == ".json" else [*lines(path)]


def newest(rows: Sequence[Row], engine: str) -> list[Row]:
    """The last row of each problem by an engine; of a file without any, by whichever."""
    own = [row for row in rows if engine in row.get("engine", row).values()]
    return list({row["problem"]: row for row in own or rows}.values())


def row_of(problem: Problem, keep: bool = False) -> Row:
    """Diagnose a problem, and keep what the decision took; its row without the engine."""
    head: Row = {"class": problem.group, "problem": problem.name}
    head |= {"seed": problem.seed} if problem.study else {}
    try:
        asked = problem.asked()
    except Exception as error:  # of a value: the cause cannot be as strong
        state = "not made" if isinstance(error, ValueError) else "failed"
        return {**head, "state": state, "text": f"{type(error).__name__}: {error}"[:WORD]}
    head |= {"truth": list(asked.truth), "listed": asked.listed, **asked.more}
    begin = time.process_time()
    try:
        found = asked.diagnosed()
    except ScenarioError as error:  # an answer too
        return {**head, "said": "refused", "causes": [], "text": str(error)[:WORD]}
    except Exception as error:
        return {**head, "state": "failed", "text": f"{type(error).__name__}: {error}"[:WORD]}
    seconds = round(time.process_time() - begin, 2)
    row = {**head, "truth": _told(head["truth"], found), "said": found.verdict.kind,
           "causes": list(asked.causes(found))}  # fmt: skip
    if found.fitted:
        row |= {"p": float(f"{found.findings.test.p_value:.3g}")}
        row |= _sized(row, asked, found)
    row |= {"outcome": answer(row).outcome, "cpu": seconds}
    if keep and found.fitted:
        _keep(row, found)
    return row


def _keep(row: Row, found: Diagnosis) -> None:
    """Keep a row with what the decision took, for `bench rules`; models of functions cannot be."""
    path = KEPT / code() / f"{row['problem'].replace('/', ' ')}.pickle"
    path.parent.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(pickle.PicklingError, AttributeError, TypeError):
        path.write_bytes(pickle.dumps((row, found.findings.models, found.findings.test)))


def _told(truth: list[str], found: Diagnosis) -> list[str]:
    """The truth by the names of what was asked: differences of readings are those of one side."""
    names = {cause.name for cause in found.problem.causes}
    other = (each.replace("[before]", "[after]") for each in truth)
    return [two if one not in names and two in names else one
            for one, two in zip(truth, other, strict=True)]  # fmt: skip


def _sized(row: Row, asked: Asked, found: Diagnosis) -> Row:
    """Sizes of a model that is right, and what lies far from a known size."""
    none = row["said"] == "none" and not row["truth"]
    if not none and answer(row).outcome != "right name":
        return {}
    table = found.params.rename(columns={"value": "estimate"})
    table, more = table.join(found.conf_int()[["low", "high"]]), Row(sizes=[])
    for name in table.index.intersection([*asked.sizes]):
        value = asked.sizes[name]
        true, sd = value if isinstance(value, tuple) else (value, 0.0)
        told = [float(f"{each:.6g}") for each in (true, *table.loc[name, SIZE[1:]])]
        more["sizes"].append({"name": name, **dict(zip(SIZE, told, strict=True))})
        if sd and abs(told[1] - true) > FAR * np.hypot(told[2], sd):
            more["far"] = [*more.get("far", ()), name]
    fit = found.findings.models.get(row["truth"])
    if row["truth"] and fit is not None:
        (first, *_), names = row["truth"], table.index
        own = next((each for each in names if each == first or each.startswith(f"{first}.")), "")
        plain = Candidate(fit, found.findings.models).interval(0.95)
        if own in plain.index and (width := np.ptp(plain.loc[own, ["low", "high"]].to_list())):
            wider = np.ptp(table.loc[own, ["low", "high"]].to_list()) / width
            more["width"] = round(float(wider), 3)
    return more


def in_turns(part: int, parts: int, only: str = "") -> list[Problem]:
    """Problems of a part: of each class every `parts`-th by its rank, the classes in turn.

    Classes begin at different parts, so that no part has the first of each. What takes longer than
    a part usually has comes last.
    """
    found: list[list[Problem]] = []
    for listed in CLASSES:
        groups: dict[str, list[Problem]] = {}
        for each in listed():
            groups.setdefault(each.group, []).append(each)
        found += [own[(part - 1 - len(found) - k) % parts :: parts]
                  for k, own in enumerate(groups.values())]  # fmt: skip
    turns = [each for each in itertools.chain(*itertools.zip_longest(*found))
             if each and re.search(only, f"{each.group}: {each.name}")]  # fmt: skip
    return sorted(turns, key=lambda each: each.name.startswith(SLOW))


def ask(path: Path, problems: Iterable[Problem], minutes: float, jobs: int = 2,
        keep: bool = False) -> None:  # fmt: skip
    """Append rows of problems that have none of the present engine, for some minutes.

    What is not diagnosed by then is given up; a later call begins with it.
    """
    now, ends = engine(), time.monotonic() + 60.0 * minutes
    done = {row["problem"] for row in lines(path) if row["engine"].get("code") == now["code"]}
    left = [each for each in problems if each.name not in done]
    for study in {each.study for each in left} - {""}:
        if said := used(study, (each.seed for each in left if each.study == study)):
            raise SystemExit("\n".join(said))
    # Not by forks: a thread of the core may hold a lock.
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        rows, count = pool.imap_unordered(partial(row_of, keep=keep), left), 0
        with contextlib.suppress(multiprocessing.TimeoutError, StopIteration):
            while True:
                row = rows.next(max(ends - time.monotonic(), 0.0))
                append(path, {**row, "engine": now})
                count += 1
                print(row["problem"], row.get("outcome", row.get("state", "")), flush=True)
        pool.terminate()
    print(f"{count} rows, {len(left) - count} problems left")
