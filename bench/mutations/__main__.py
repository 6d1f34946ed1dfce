"""Drawn changes of the sources of a language, tried one by one.

Lines are drawn by a seed, each with the same weight, and one change of each: a comparison turned
round, a sign, a number, a condition. Each is made in a copy, with which tests run until one fails:
those nearest to the line, and the golden verdicts. A change that none sees SURVIVES: a test is
missing, or the change makes no difference. Results are appended to a file of JSON lines; a change
that is there is not tried again.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import time
from collections import Counter
from types import ModuleType

from mutations import core, python
from mutations.trial import ROOT, Mutation, Trial

LANGUAGES = {"python": python, "core": core}


def changes(language: ModuleType) -> dict[str, list[Mutation]]:
    """All changes of the sources by their place, FILE:LINE."""
    lines: dict[tuple[str, int], list[Mutation]] = {}
    for path in {path for pattern in language.FILES for path in ROOT.glob(pattern)}:
        file, source = path.relative_to(ROOT).as_posix(), path.read_bytes()
        for start, stop, text in language.mutations(source):
            line = source.count(b"\n", 0, start) + 1
            lines.setdefault((file, line), []).append(Mutation(file, line, start, stop, text))
    return {"{}:{}".format(*place): lines[place] for place in sorted(lines)}


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser("python -m bench mutations", description=__doc__)
    parser.add_argument("language", choices=LANGUAGES)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30, help="lines to draw")
    parser.add_argument("--at", metavar="FILE:LINE", help="all changes of this line, none drawn")
    parser.add_argument("--part", default="1/1", metavar="K/N", help="every Nth from the Kth on")
    parser.add_argument("--limit", type=float, default=60.0, help="CPU s of each run of tests")
    parser.add_argument("--tests", nargs="+", default=["tests"], help="to choose from")
    parser.add_argument("--out", default=os.devnull, help="JSON lines to append results to")
    options = parser.parse_args(words)
    language, lines = LANGUAGES[options.language], changes(LANGUAGES[options.language])
    choice = random.Random(options.seed)
    places = choice.sample(list(lines), len(lines))[: options.count]
    chosen = [choice.choice(lines[place]) for place in places]
    if options.at and not (chosen := lines.get(options.at)):
        parser.error(f"--at {options.at}: nothing to change; allowed is FILE:LINE of a source")
    part, parts = map(int, options.part.split("/"))
    trial = None
    verdicts: Counter[str] = Counter()
    with open(options.out, "a+") as out:
        out.seek(0)
        rows = [json.loads(row) for row in out]
        for mutation in chosen[part - 1 :: parts]:
            file, line, start, stop, text = mutation
            source = (ROOT / file).read_bytes()
            old = " ".join(source[start:stop].decode().split())
            column = start - source.rfind(b"\n", 0, start)
            place = {"file": file, "line": line, "column": column,
                     "change": f"{old} -> {text or 'nothing'}"}  # fmt: skip
            row = next((row for row in rows if place.items() <= row.items()), None)
            if row is None:
                trial = trial or Trial(language.Copy(options.tests), options.limit)
                begun = time.monotonic()
                verdict, test = trial.judged(mutation)
                row = place | {"seed": options.seed, "verdict": verdict, "test": test}
                row["seconds"] = round(time.monotonic() - begun)
                print(json.dumps(row), file=out, flush=True)
            verdicts[row["verdict"]] += 1
            print("{file}:{line}: {change}: {verdict} {test}".format_map(row), flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in verdicts.items()))
    return int(verdicts["survives"] > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
