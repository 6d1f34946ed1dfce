"""A benchmark for any tool that says what is wrong with a model; see README.md beside.

`make` writes the sets anew; the name of a tool has it answer them. `python -m bench score --rows
FILE` counts the answers of a file beside the truth.
"""

from __future__ import annotations

import argparse
import json

from causes import walkers
from causes.make import TRUTH, make
from causes.tools import TOOLS, Answer, run

ANSWERS = TRUTH.parent / "answers"


def main() -> None:
    """Make the sets, or answer them."""
    parser = argparse.ArgumentParser(prog="python -m bench causes", description=__doc__)
    parser.add_argument("what", choices=("make", *TOOLS))
    parser.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    options = parser.parse_args()
    if options.what == "make":
        make()
        walkers.make()
        return
    path = ANSWERS / f"{options.what.replace(' ', '-')}.json"
    have = json.loads(path.read_text()) if path.exists() else {}

    def write(answers: Answer) -> None:
        path.write_text(json.dumps(answers, indent=1) + "\n")

    run(options.what, options.minutes, write, have)


if __name__ == "__main__":
    main()
