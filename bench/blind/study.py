"""The flow of the study: data sets and their answers, what is said of them, the record.

A folder has `sets.jsonl.xz`, a data set a line with the text of its files by name;
`answers.jsonl.xz`, which nothing reads before all sets are diagnosed; `said.jsonl`, what was said
of each set by which state of the engine; `record.jsonl`, the same with the answers.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import lzma
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scores import until
from stale import digest

import stickslip
from blind.seeds import used
from blind.writing import write_case, write_more
from stickslip import Cause, Diagnosis, diagnose, read_measurement
from stickslip.diagnosis.report.sections.size import law_of

Row = dict[str, Any]
Array = NDArray[np.float64]

HERE = Path(__file__).resolve().parent
SETS, ANSWERS, SAID, RECORD = "sets.jsonl.xz", "answers.jsonl.xz", "said.jsonl", "record.jsonl"


def sets(path: Path) -> Iterator[Row]:
    """Lines of a file of data sets or answers; none of a file that is not there."""
    if path.exists():
        with lzma.open(path, "rt") as file:
            for line in file:
                yield json.loads(line)


def lines(path: Path) -> Iterator[Row]:
    """Rows of a file that is appended to, without those that were not written to their end."""
    for line in path.read_text().splitlines() if path.exists() else ():
        with contextlib.suppress(json.JSONDecodeError):
            yield json.loads(line)


def append(path: Path, row: Row) -> None:
    """Append a row, on a line of its own after one that was cut off."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a") as file:
        cut = file.tell() and not path.read_text().endswith("\n")
        file.write(("\n" if cut else "") + json.dumps(row) + "\n")


def refuse_used(study: str, seeds: Iterable[int]) -> None:
    """End the program where a set of them is not to be judged."""
    if said := used(study, seeds):
        raise SystemExit("\n".join(said))


def in_parts(
    path: Path, minutes: float, seeds: Iterable[int], judged: Callable[[int], Row]
) -> list[Row]:
    """Rows of the seeds by the present engine: those of a file, and others judged and appended.

    Parameters
    ----------
    path : Path
        Its stem is the name of the study, whose seeds must not be used up.
    minutes : float
        No set is begun after this time.
    seeds : iterable of int
    judged : callable
        The row of a seed: what is hidden and what was said.
    """
    now = state()
    rows = [row for row in lines(path) if row["state"].get("golden") == now["golden"]]
    seeds, done = list(seeds), {row["seed"] for row in rows}
    left = [seed for seed in seeds if seed not in done]
    refuse_used(path.stem, left)
    for seed in until(minutes, left):
        begin = time.process_time()
        row = judged(seed)
        seconds = round(time.process_time() - begin, 2)
        rows.append({"seed": seed, **row, "cpu_seconds": seconds, "state": now})
        append(path, rows[-1])
    return [row for row in rows if row["seed"] in seeds]


def unpacked(one: Row, folder: Path) -> Path:
    """The files of a data set in a folder; the path of its measurement."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in one["files"].items():
        (folder / name).write_text(text)
    return folder / "measurement.toml"


def generator_files() -> list[Path]:
    """Files that decide what a data set is; of the reference simulator, those of one plane."""
    own = (
        "catalogue", "generator", "kinds", "model_errors", "noise", "readings", "settings",
        "strength", "truth", "writing",
    )  # fmt: skip
    reference = (
        "circuit", "contact", "drive", "effects", "field", "laws", "shaken", "simulate",
        "stepper",
    )  # fmt: skip
    simulator = HERE.parents[1] / "tests" / "reference"
    return [
        *(HERE / f"{name}.py" for name in own),
        *(simulator / f"{name}.py" for name in reference),
    ]


def _checksum(paths: Iterable[Path]) -> str:
    """SHA-256 of names and contents of files, its first 12 hex digits."""
    total = hashlib.sha256()
    for path in sorted(paths):
        total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()[:12]


def state() -> dict[str, str]:
    """Which engine and which generator made a row: version, commit, sums of what decides.

    Of the engine this is the sum of its golden verdicts, which `python -m bench golden` has to have
    compared: two builds of one source differ in their bytes, and most changes change no verdict.
    """
    asked = ("git", "-C", str(HERE), "rev-parse", "--short", "HEAD")
    commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    data = _checksum(generator_files())
    return {"version": stickslip.__version__, "commit": commit, "data": data, "golden": digest()}


def name_of(kind: str, seed: int) -> str:
    """A name that says nothing of what is in a data set."""
    return hashlib.sha256(f"{kind} {seed}".encode()).hexdigest()[:8]


def make(folder: Path, asked: Iterable[tuple[str, int]], minutes: float) -> None:
    """Make the data sets that a folder still lacks, and begin none after some minutes.

    A data set is kept as soon as it is made, and the files are packed at the end by the names: the
    order in which they were made would say of which kind each is.
    """
    folder.mkdir(parents=True, exist_ok=True)
    parts = {folder / name: folder / f"{name}.part" for name in (ANSWERS, SETS)}
    pack(parts)
    there = {each["name"] for each in sets(folder / SETS)}
    data = _checksum(generator_files())
    left = [each for each in asked if name_of(*each) not in there]
    refuse_used("walkers", (seed for _, seed in left))
    for kind, seed in until(minutes, left):
        name = name_of(kind, seed)
        begin = time.process_time()
        with tempfile.TemporaryDirectory() as work:
            answer = {**write_case(Path(work) / "data", kind, seed), "data": data}
            files = {each.name: each.read_text() for each in sorted(Path(work, "data").iterdir())}
        # The data set last: one without its answer is made again.
        append(parts[folder / ANSWERS], {"name": name, "answer": answer})
        append(parts[folder / SETS], {"name": name, "files": files})
        print(f"{name}: {time.process_time() - begin:.1f} CPU s", flush=True)
    pack(parts)


def pack(parts: dict[Path, Path]) -> None:
    """Move the rows of each part into its file, the last one of each name."""
    for path, part in parts.items():
        if part.exists():
            kept = {each["name"]: each for each in (*sets(path), *lines(part))}
            whole = path.with_suffix(".new")
            with lzma.open(whole, "wt", preset=9) as file:
                file.writelines(json.dumps(kept[name]) + "\n" for name in sorted(kept))
            whole.replace(path)
            part.unlink()


def said(folder: Path, now: dict[str, str]) -> dict[str, Row]:
    """Rows of the present engine and generator by the names of their data sets."""
    return {
        row["name"]: row
        for row in lines(folder / SAID)
        if all(row["state"].get(key) == now[key] for key in ("golden", "data"))
    }


def diagnose_sets(folder: Path, minutes: float, part: int = 1, parts: int = 1) -> None:
    """Diagnose what has no row yet, every `parts`-th data set from the `part`-th on."""
    now = state()
    done = said(folder, now)
    mine = list(sets(folder / SETS))[part - 1 :: parts]
    for one in until(minutes, (each for each in mine if each["name"] not in done)):
        with tempfile.TemporaryDirectory() as work:
            row = diagnosed(unpacked(one, Path(work) / "data"))
        append(folder / SAID, {"name": one["name"], "state": now, **row})
        # Nothing of the verdict is shown before all are judged.
        print(f"{one['name']}: {row['cpu_seconds']:.0f} CPU s", flush=True)


def judge(folder: Path) -> list[Row]:
    """Open the answers of what was diagnosed, and write the record; its rows."""
    rows, record = said(folder, state()), []
    if not rows:
        raise SystemExit(f"{folder / SAID}: no row of this engine; {RECORD} stays as it is")
    answers = {each["name"]: each["answer"] for each in sets(folder / ANSWERS)}
    for one in sets(folder / SETS):
        row = rows.get(one["name"])
        if row is not None:
            with tempfile.TemporaryDirectory() as work:
                path = unpacked(one, Path(work) / "data")
                more = Path(work) / "more"
                record.append({"answer": answers[one["name"]], **row})
                record[-1] |= _by_answer(record[-1], path, more)
    (folder / RECORD).write_text("".join(json.dumps(row) + "\n" for row in record))
    return record


def _by_answer(row: Row, path: Path, more: Path) -> Row:
    """What is said of near twins that were measured again at the proposed experiments."""
    drives = [each["drive"] for each in row["next_experiments"]]
    if row["answer"]["kind"] != "near twins" or not drives:
        return {}
    write_more(path.parent, more, row["answer"], drives)
    return {"followed": diagnosed(more / path.name)["said"]}


def diagnosed(path: Path) -> Row:
    """Diagnosis of a data set from its files alone: the parts that the counts need."""
    start = time.process_time()
    result = diagnose(read_measurement(path), threads=1)
    seconds, gain, whole = time.process_time() - start, result.gain, result.as_dict()
    laws = {
        each.name: _effect(each)
        for each in result.problem.causes
        if each.has_knots and each.name in result.verdict.causes
    }
    # By the normal law the error that is left has a mean of 0.80 errors.
    middle, sd = np.sqrt(2.0 / np.pi), np.sqrt((1.0 - 2.0 / np.pi) / len(result.problem.y))
    likely = sorted(whole["probabilities"].items(), key=lambda item: -item[1])[:5]
    parameters = {
        name: {key: each[key] for key in ("value", "sd", "unit")}
        for name, each in whole["parameters"].items()
    }
    return {
        "said": {
            **{key: whole[key] for key in ("verdict", "cause", "p_value", "gain")},
            "laws": laws, "open_set": _law(result, laws), "parameters": parameters,
            "probabilities": dict(likely),
        },
        "reasons": [each.code for each in result.verdict.reasons],
        "gain": None if gain is None else {"p_value": norm.sf((gain.after - middle) / sd)},
        "cpu_seconds": round(seconds, 1),
        "next_experiments": whole["next_experiments"],
    }  # fmt: skip


def _effect(law: Cause) -> str:
    """Where a law of the simulator acts."""
    assert law.curve is not None
    return next(iter(law.curve.statement.fixed)).split(".")[1]


def _law(result: Diagnosis, laws: dict[str, str]) -> Row | None:
    """The claimed law of another shape: its curve with the ends of 95 %, and its forms."""
    law = law_of(result.best) if result.verdict.claims else None
    if law is None:
        return None
    return {
        "effect": laws[law["name"]],
        "curve": {"argument": law["at"], "low": law["low"], "high": law["high"]},
        "form": law["form"], "forms": law["forms"],
    }  # fmt: skip
