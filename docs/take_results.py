"""Copy results of bench/results/ to docs/measured/, where the tables of the pages are made from.

`python docs/take_results.py` takes those that are newer than what the pages have. A result is
kept with the date of its measurement, so that a fresh clone has every table.
"""

from __future__ import annotations

import json
from datetime import datetime, timezone
from pathlib import Path

DOCS = Path(__file__).parent
RESULTS = DOCS.parent / "bench" / "results"

COMMANDS = {
    "speed.json": "python -m bench speed",
    "peers.json": "python -m bench peers",
    "sweep.json": "python -m bench sweep",
    "real.json": "python -m bench real",
}
"""The tables of the pages, and the command that measures each."""


def take(source: Path, target: Path) -> bool:
    """Copy a result with its date; whether it is newer than what was there."""
    result = json.loads(source.read_text())
    measured = datetime.fromtimestamp(source.stat().st_mtime, timezone.utc)
    result["date"] = measured.date().isoformat()
    if target.is_file() and json.loads(target.read_text())["date"] >= result["date"]:
        return False
    target.write_text(json.dumps(result, indent=1) + "\n")
    return True


def main() -> None:
    """Take what there is, and say what that was."""
    for name, command in COMMANDS.items():
        source = RESULTS / name
        if not source.is_file():
            print(f"{name}: not in {RESULTS}; `{command}` measures it")
        elif take(source, DOCS / "measured" / name):
            print(f"{name}: taken")
        else:
            print(f"{name}: the pages have one of that day or later")


if __name__ == "__main__":
    main()
