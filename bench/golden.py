"""``python -m bench golden``: whether the diagnosis says what it said, of the problems beside.

What this package says is set beside the stored file, at the tolerances below; with ``--against``
beside an earlier commit that is built on this machine, to the last bit. ``--renew`` writes the
stored file anew, and prints what a commit of it has to list. The status is 1 where they differ.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from problems import PROBLEMS, ROOT
from stale import VERDICTS

import stickslip

ELSEWHERE = VERDICTS.with_name("verdicts_elsewhere.jsonl")
"""Where the rounding of some machines leads a descent to another end: these numbers count as well.
"""
VARIES = ("version",)
"""Keys that tell of the package and not of the data."""
MOST = 6
"""Items of a list that the stored file keeps, at even distances. Chosen: it has 200 readings of a
log, of which each that moves moves with others."""


class Tolerance(NamedTuple):
    """How far a number may be from the stored one, by words of its path.

    It may be `absolute`, and parts `relative` of itself and `of_sd` of the `sd` beside it.
    """

    words: str
    absolute: float = 1e-12
    relative: float = 0.0
    of_sd: float = 0.0


# Another machine rounds otherwise, so that a descent ends elsewhere within what counts as its end.
# The first that is found holds; counts and words have to be the same.
TOLERANCES = (
    # Logarithms of likelihoods: far below those that decide, of 1 or more; then what they make.
    Tolerance("log_evidence|difference|lead", 0.05, 0.01),
    Tolerance("odds|more|separation", 0.0, 0.1),
    Tolerance("probability|probabilities|among_causes|in_all|left|forms|share|cosines?", 0.02),
    Tolerance("p|p_value|tests", 0.02),  # of chi-square, whose error is a part of its own
    Tolerance("chi2|chi2_per_condition|kappa", 0.02, 0.01),
    # In errors of a reading, or of a constant.
    Tolerance("pull|pull_extended|apart|gain.before|gain.after|gain.interval", 0.05, 0.01),
    # Sizes and predictions: a small part of the error beside them.
    Tolerance("value|low|high|stated|recalibrated|extended", 1e-12, 1e-3, 0.05),
    Tolerance("rho|phi", 1e-6, 0.03),  # parts of a reading or of a step
    # Errors and limits: two digits of them are read.
    Tolerance(r"\w*", 1e-12, 0.03),
)


PLACES = r"^(?!conditions).*\.(number|where)$"
"""Paths that tell which reading is farthest off: of two that are nearly so, rounding decides."""


def tolerated(path: str, before: float, now: float, sd: float) -> bool:
    """Whether a number is the stored one but for rounding."""
    each = next(each for each in TOLERANCES if re.search(rf"\b(?:{each.words})\b", path))
    most = each.absolute + each.relative * abs(before) + each.of_sd * sd
    return math.isfinite(before) and abs(now - before) <= most


def tolerated_words(before: str, now: str) -> bool:
    """Whether a text is the stored one but for the last digits of its numbers."""
    number = r"\d+(?:\.\d+)?(?:e-?\d+)?"
    pairs = zip(re.findall(number, before), re.findall(number, now), strict=False)
    return re.sub(number, "#", before) == re.sub(number, "#", now) and all(
        math.isclose(float(one), float(other), rel_tol=0.05,
                     abs_tol=1.01 * 10.0 ** -len(one.partition(".")[2]) if "." in one else 0.0)
        for one, other in pairs
    )  # fmt: skip


def differences(
    before: Any, now: Any, exact: bool, path: str = "", sd: float = 0.0
) -> Iterator[str]:
    """``path: before -> now`` of each leaf that differs; words and counts have to be the same."""
    if isinstance(before, dict) and isinstance(now, dict):
        beside = before.get("sd")
        sd = beside if isinstance(beside, float) else sd
        for name in {**before, **now}:
            where = f"{path}.{name}" if path else name
            if name not in before or name not in now:
                yield f"{where}: {'new' if name in now else 'gone'}"
            else:
                yield from differences(before[name], now[name], exact, where, sd)
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for k, pair in enumerate(zip(before, now, strict=True)):
            yield from differences(*pair, exact, f"{path}[{k}]", sd)
    elif repr(before) != repr(now) and (exact or not re.search(PLACES, path)):
        same = False
        if not exact and isinstance(before, float) and isinstance(now, float):
            same = tolerated(path, before, now, sd)
        elif not exact and isinstance(before, str) and isinstance(now, str):
            same = tolerated_words(before, now)
        if not same:
            yield f"{path}: {before!r:.160} -> {now!r:.160}"


def thinned(value: Any) -> Any:
    """The value as the stored file keeps it: of a long list its length and some of its items.

    Words and rows of candidates are in order of the alphabet: which of two that are equally likely
    comes first is rounding.
    """
    if isinstance(value, dict):
        return {key: thinned(each) for key, each in value.items()}
    if isinstance(value, list):
        if value and isinstance(value[0], str):
            value = sorted(value)
        elif value and isinstance(value[0], dict) and "candidate" in value[0]:
            value = sorted(value, key=lambda row: str(row["candidate"]))
        n = len(value)
        if n <= MOST:
            return [thinned(each) for each in value]
        return [n, *(thinned(value[k * (n - 1) // (MOST - 1)]) for k in range(MOST))]
    return value


def numbers(name: str, threads: int = 1) -> dict[str, Any]:
    """All numbers of the diagnosis of a problem, as JSON has them."""
    told = PROBLEMS[name].diagnosed(threads).as_dict()
    return {key: each for key, each in json.loads(json.dumps(told)).items() if key not in VARIES}


def answer(threads: int, names: Iterable[str]) -> None:
    """Print the numbers of each problem as a line of JSON; their CPU seconds on standard error."""
    for name in names:
        begin = time.process_time()
        try:
            said = numbers(name, threads)
        except Exception as error:  # a refusal is an answer too
            said = {"refused": f"{type(error).__name__}: {error}"}
        print(json.dumps({"name": name, "numbers": said}), flush=True)
        print(f"{name}: {time.process_time() - begin:.1f} CPU s", file=sys.stderr, flush=True)


def answers(package: Path, names: Sequence[str], threads: int, jobs: int) -> dict[str, Any]:
    """Numbers by problem, of the package in a folder, by so many processes."""
    paths = map(str, (package.resolve(), ROOT / "bench", ROOT / "tests"))
    variables = {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "golden", "answer", str(threads)]
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder, str(k)) for k in range(jobs)]
        running = []
        for k, path in enumerate(files):
            with path.open("w") as file:
                given = [*command, *names[k::jobs]]
                running.append(subprocess.Popen(given, stdout=file, env=variables))
        if sum(each.wait() != 0 for each in running):
            raise SystemExit("golden: a process failed")
        lines = [line for path in files for line in path.read_text().splitlines()]
    return {each["name"]: each["numbers"] for each in map(json.loads, lines)}


def stored(path: Path = VERDICTS) -> dict[str, Any]:
    """The stored numbers by problem."""
    lines = path.read_text().splitlines() if path.exists() else []
    return {each["name"]: each["numbers"] for each in map(json.loads, lines)}


def _verdict(said: dict[str, Any] | None) -> str:
    return "-" if said is None else str(said.get("refused") or [said["verdict"], said["cause"]])


def compared(
    before: dict[str, Any], now: dict[str, Any], exact: bool, most: int | None = None
) -> int:
    """Print each problem that differs, with its verdicts and `most` of its leaves; their count."""
    count = 0
    for name in {**before, **now}:
        one, other = before.get(name), now.get(name)
        found = list(differences(one, other, exact))
        if found:
            count += 1
            print(f"{name}: {_verdict(one)} -> {_verdict(other)}; {len(found)} differ")
            if one and other:
                print(*(f"    {each}" for each in found[:most]), sep="\n")
    print(f"golden: {count} of {len({**before, **now})} problems differ", flush=True)
    return count


def main() -> int:
    """Compare, or renew."""
    if sys.argv[1:2] == ["answer"]:
        answer(int(sys.argv[2]), sys.argv[3:])
        return 0
    parser = argparse.ArgumentParser(prog="python -m bench golden", description=__doc__)
    parser.add_argument("--against", metavar="COMMIT", help="or a folder with its built package")
    parser.add_argument("--threads", default="1", help="as 1,2; with --against")
    parser.add_argument("--renew", action="store_true", help="write the stored file anew")
    parser.add_argument("--only", default="", metavar="PATTERN", help="of the problems' names")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    options = parser.parse_args()
    package, before = Path(stickslip.__file__).parents[1], stored()
    chosen = [name for name in {**before, **PROBLEMS} if re.search(options.only, name)]
    names = [name for name in chosen if name in PROBLEMS]

    def said(of: Path, threads: int) -> dict[str, Any]:
        return answers(of, [name for name in names if threads == 1 or PROBLEMS[name].threaded],
                       threads, options.jobs)  # fmt: skip

    if options.against:
        from against import built  # which an earlier package need not be able to import

        earlier = said(built(options.against), 1)
        count = 0
        for threads in map(int, options.threads.split(",")):
            now = said(package, threads)
            print(f"{options.against} and this package with {threads} threads, to the last bit:")
            count += compared({name: earlier[name] for name in now}, now, exact=True, most=10)
        return int(count > 0)
    now = {name: thinned(each) for name, each in said(package, 1).items()}
    old = {name: before[name] for name in chosen if name in before}
    elsewhere = {} if options.renew else stored(ELSEWHERE)
    old |= {name: each for name, each in elsewhere.items()
            if name in now and not any(differences(each, now[name], False))}  # fmt: skip
    count = compared(old, now, exact=options.renew, most=3 if options.renew else None)
    if options.renew:
        kept = {**before, **now}
        VERDICTS.write_text("".join(
            json.dumps({"name": name, "numbers": kept[name]}, separators=(",", ":")) + "\n"
            for name in PROBLEMS if name in kept
        ))  # fmt: skip
        return 0
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
