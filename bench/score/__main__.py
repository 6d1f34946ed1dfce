"""The score of the diagnosis: problems whose truth is known, by class, beside what is asked.

Without options the table of the rows of the present engine is printed. `--part` diagnoses problems
of a part and appends their rows. `--against` compares with the rows of another file, or of an
earlier engine in the same one, problem by problem.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scores import OUTCOMES, Row, answer, counts, markdown
from stale import code, stale

from score.rows import HERE, ROWS, ask, in_turns, newest, read
from stickslip._util.toml import parse_toml

ASKED: dict[str, dict[str, Any]] = parse_toml((HERE / "asked.toml").read_text())
NAMES = OUTCOMES[:-1]
COMPARED = "rows", *OUTCOMES, "none", "held"
STATES = "not made", "too weak", "failed"  # of rows that are no answers


def groups(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Rows by class: those that are asked, then others by their first two words."""

    def within(row: Row, name: str) -> bool:
        return f"{row['class']}, ".startswith(f"{name}, ")

    others = [row for row in rows if not any(within(row, name) for name in ASKED)]
    names = [*ASKED, *dict.fromkeys(", ".join(row["class"].split(", ")[:2]) for row in others)]
    found = {name: [row for row in rows if within(row, name)] for name in names}
    return {name: own for name, own in found.items() if own}


def met(count: Mapping[str, int], asked: Mapping[str, Any]) -> str:
    """Whether counts are as asked: `yes`, `no`, or `-` while that depends on rows to come."""
    whole, said = count["rows"] >= asked.get("sets", 0), ["no"] * bool(count["failed"])
    for check in asked.get("checks", ()):
        value = sum(count[each] for each in check["count"])
        share = value / max(count[check["of"]], 1) if "of" in check else value
        fine = check.get("least", 0) <= share <= check.get("most", np.inf)
        # A count only grows; a share of nothing is not known.
        sure = share > check.get("most", np.inf) or ("least" in check and fine)
        known = whole and count[check["of"]] if "of" in check else whole or sure
        said.append("-" if not known else "yes" if fine else "no")
    return next((each for each in ("no", "-", "yes") if each in said), "")


def table(rows: Sequence[Row]) -> str:
    """Counts of each class beside what is asked."""
    plain, shown = {row["problem"]: row for row in rows}, []
    for name, own in groups(rows).items():
        count, asked = counts(own, plain), ASKED.get(name, {})
        wishes = "; not checked: ".join(asked[each] for each in ("asked", "unchecked")
                                        if each in asked)  # fmt: skip
        wide = [row["width"] for row in own if row.get("width")]
        answers = [answer(row) for row in own if "state" not in row]
        credits = [each.credit for each in answers if each.truth]
        seconds = [row["cpu"] for row in own if "cpu" in row] or [0.0]

        def share(one: str, of: str, count: Mapping[str, int] = count) -> str:
            return f"{count[one]} of {count[of]}" if count[of] else ""

        shown.append((
            name, f"{count['rows']} of {asked['sets']}" if "sets" in asked else count["rows"],
            *(count[each] or "" for each in NAMES),
            f"{np.mean(credits):.2f}" if credits else "",
            count["rightly silent"] or "", share("none", "nothing"), share("low p", "nothing"),
            share("held", "sizes"), f"{np.median(wide):.2f}" if wide else "",
            share("as plain", "logs"), f"{np.median(seconds):.1f}", wishes,
            met(count, asked),
        ))  # fmt: skip
    heads = (
        "class;sets;" + ";".join(NAMES) + ";score of groups;honest;`none`;p below 5 %;"
        "sizes in 95 %;width;as the plain log;CPU s;asked;met"
    )
    return markdown(heads, shown)


def page(path: Path) -> str:
    """The table of a file, below a line on rows that are stale."""
    rows = newest(read(path), code())
    other = [f"{sum(row.get('state') == each for row in rows)} {each}" for each in STATES]
    other += [f"{sum(row.get('said') == 'refused' for row in rows)} refused"]
    words = f"{len(rows)} problems, of which {', '.join(other)}."
    ours = [row for row in rows if "golden" in row.get("engine", row)]  # others do not change
    return "\n\n".join([*stale(ours), table(rows), words])


def against(before: Sequence[Row], now: Sequence[Row]) -> str:
    """Counts of each class before and now, and what is said of problems that both have."""
    old, new = ({row["problem"]: row for row in rows} for rows in (before, now))
    pairs = [(old[name], row) for name, row in new.items() if name in old]
    if not pairs:
        return "No problem has rows of both."
    before, now = ([*each] for each in zip(*pairs, strict=True))
    sides = groups(before), groups(now)
    shown = []
    for name in {**sides[0], **sides[1]}:
        one, other = (counts(side.get(name, ()), {}) for side in sides)
        cells = (f"{one[each]} → {other[each]}" if one[each] != other[each] else one[each] or ""
                 for each in COMPARED)  # fmt: skip
        shown.append((name, *cells))
    changed = [f"- {row['class']}: {row['problem']}: {_words(was)} → {_words(row)}"
               for was, row in pairs if _words(was) != _words(row)]  # fmt: skip
    words = f"{len(changed)} of {len(pairs)} problems that both have differ."
    heads = ";".join(("class", "sets", *COMPARED[1:]))
    return "\n\n".join([markdown(heads, shown), words, "\n".join(changed)]).rstrip()


def _words(row: Row) -> str:
    if "state" in row:
        return str(row["state"])
    return f"{row['said']} {', '.join(sorted(row['causes']))} ({answer(row).outcome})"


def part(text: str) -> tuple[int, int]:
    """A part and how many there are, as 3/8."""
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise argparse.ArgumentTypeError(f"{text}: allowed is K/N, K from 1 to N")
    return int(found[1]), int(found[2])


def main() -> None:
    """Print the table, diagnose a part, or compare."""
    parser = argparse.ArgumentParser(prog="python -m bench score", description=__doc__)
    parser.add_argument("--part", type=part, metavar="K/N", help="every Nth, from the Kth on")
    parser.add_argument("--minutes", type=float, default=15.0, help="of a part, 15 if not given")
    parser.add_argument("--keep", action="store_true", help="for `bench rules`: 5 MB a problem")
    parser.add_argument("--only", default="", metavar="PATTERN", help='of "class: problem"')
    parser.add_argument("--rows", type=Path, default=ROWS, help="JSON lines, or a tool's answers")
    parser.add_argument("--against", metavar="FILE", help="or the commit or a sum of an engine")
    options = parser.parse_args()
    if options.part:
        ask(options.rows, in_turns(*options.part, only=options.only), options.minutes,
            keep=options.keep)  # fmt: skip
    elif options.only or not options.rows.is_file():
        parser.error(f"--only {options.only}: with --part" if options.only
                     else f"--rows {options.rows}: no such file")  # fmt: skip
    elif options.against:
        rows, other = read(options.rows), Path(options.against)
        own = [row for row in rows if options.against in row.get("engine", {}).values()]
        if not own and not other.exists():
            parser.error(f"--against {other}: no file, and no engine of {options.rows}")
        print(against(newest(own or read(other), ""), newest(rows, code())))
    else:
        print(page(options.rows))


if __name__ == "__main__":
    main()
