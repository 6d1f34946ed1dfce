"""Data sets in files, made before the engine that will read them: ``python -m bench blind-freeze``.

`study/` has the data sets of the study, and in a file of its own their answers, which nothing reads
before all of them are diagnosed. `frozen/` has 200 data sets with their answers, and what the
engine before this one found in them: every candidate with its chi-square, log-evidence and
parameters in their units. Verdicts of hard sets differ between two runs of one engine, so fits and
evidences are compared, too.

A line of a `.jsonl.xz` is a data set, with the text of its `files` by name.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import lzma
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from blind.kinds import KINDS, STUDY, plan
from blind.writing import write_case

HERE = Path(__file__).resolve().parent
SETS, ROWS = HERE / "frozen" / "sets.jsonl.xz", HERE / "frozen" / "rows.jsonl"
STUDY_SETS, ANSWERS = HERE / "study" / "sets.jsonl.xz", HERE / "study" / "answers.jsonl.xz"


def sets(path: Path | None = None) -> Iterator[dict[str, Any]]:
    """Data sets with the text of their `files` by name.

    Those of the study have a `name`, the others `kind`, `seed` and `answer`.
    """
    with lzma.open(path or SETS, "rt") as file:
        for line in file:
            yield json.loads(line)


def unpacked(one: dict[str, Any], folder: Path) -> Path:
    """The files of a data set in a folder; the path of its measurement."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in one["files"].items():
        (folder / name).write_text(text)
    return folder / "measurement.toml"


def rows() -> dict[tuple[str, int], dict[str, Any]]:
    """What was found before, by kind and seed."""
    found = (json.loads(line) for line in ROWS.read_text().splitlines())
    return {(each["kind"], each["seed"]): each for each in found}


def answers() -> dict[str, dict[str, Any]]:
    """Answers of the study by the names of its data sets: for what is judged, and not before."""
    return {each["name"]: each["answer"] for each in sets(ANSWERS)}


def name_of(kind: str, seed: int) -> str:
    """A name that says nothing of what is in a data set."""
    return hashlib.sha256(f"{kind} {seed}".encode()).hexdigest()[:8]


def generator_files() -> list[Path]:
    """Files that decide what a data set is; of the reference simulator, those of one plane."""
    own = (
        "catalogue", "generator", "kinds", "model_errors", "noise", "readings", "settings",
        "strength", "truth", "writing",
    )  # fmt: skip
    reference = (
        "circuit", "contact", "drive", "effects", "field", "laws", "simulate", "statics",
        "stepper", "switching",
    )  # fmt: skip
    simulator = HERE.parents[1] / "tests" / "reference"
    return [
        *(HERE / f"{name}.py" for name in own),
        *(simulator / f"{name}.py" for name in reference),
    ]


def checksum(paths: Iterable[Path], more: bytes = b"") -> str:
    """Of the names and contents of files."""
    total = hashlib.sha256(more)
    for path in sorted(paths):
        total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()[:12]


def freeze(minutes: float, kinds: list[str]) -> None:
    """Make what the study still lacks, and begin none after some minutes.

    A data set is kept as soon as it is made, so that a call that was stopped loses one.
    """
    parts = {path: path.with_suffix(".part") for path in (STUDY_SETS, ANSWERS)}
    STUDY_SETS.parent.mkdir(exist_ok=True)
    _joined(parts)
    there = {each["name"] for each in sets(STUDY_SETS)} if STUDY_SETS.exists() else set()
    data, end = checksum(generator_files()), time.monotonic() + 60.0 * minutes
    for kind, seed in plan(STUDY, 1000, kinds, study=True):
        name = name_of(kind, seed)
        if time.monotonic() > end:
            break
        if name in there:
            continue
        begin = time.process_time()
        with tempfile.TemporaryDirectory() as work:
            answer = write_case(Path(work) / "data", kind, seed)
            files = {each.name: each.read_text() for each in sorted(Path(work, "data").iterdir())}
        seconds = round(time.process_time() - begin, 1)
        # The data set last: one without its answer is made again.
        for path, row in (
            (ANSWERS, {"name": name, "answer": {**answer, "data": data}}),
            (STUDY_SETS, {"name": name, "files": files}),
        ):
            with parts[path].open("a") as file:
                file.write(json.dumps(row) + "\n")
        print(f"{name}: {seconds} CPU s", flush=True)
    _joined(parts)


def _joined(parts: dict[Path, Path]) -> None:
    """Move the whole lines of each part into its file, the last one of each name, by the names.

    The order in which they were made would say of which kind each is.
    """
    for path, part in parts.items():
        if not part.exists():
            continue
        text = part.read_text()
        fresh = [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]
        kept = {each["name"]: each for each in (*(sets(path) if path.exists() else ()), *fresh)}
        whole = path.with_suffix(".new")
        with lzma.open(whole, "wt", preset=9) as file:
            file.writelines(json.dumps(kept[name]) + "\n" for name in sorted(kept))
        whole.replace(path)
        part.unlink()


def main() -> None:
    """Make data sets of the study."""
    parser = argparse.ArgumentParser(prog="python -m bench blind-freeze", description=__doc__)
    parser.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    parser.add_argument("--kinds", default=";".join(KINDS), help="separated by semicolons")
    options = parser.parse_args()
    freeze(options.minutes, options.kinds.split(";"))


if __name__ == "__main__":
    main()
