"""A benchmark for any tool that says what is wrong with a model; see README.md beside.

`make` writes the sets anew, `run` answers them by one of the tools here. `python -m bench score
--rows FILE` counts the answers of a file beside the truth.
"""

from __future__ import annotations

import argparse
import json

from causes import walkers
from causes.make import TRUTH, make
from causes.tools import TOOLS, Answer, run

ANSWERS = TRUTH.parent / "answers"


def main() -> None:
    """Do one step."""
    parser = argparse.ArgumentParser(
        prog="python -m bench causes",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    steps = parser.add_subparsers(dest="step", required=True)
    steps.add_parser("make", help="write the sets")
    told = steps.add_parser("run", help="answer the sets")
    told.add_argument("tool", choices=TOOLS)
    told.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    options = parser.parse_args()
    if options.step == "make":
        make()
        walkers.make()
    else:
        path = ANSWERS / f"{options.tool.replace(' ', '-')}.json"
        path.parent.mkdir(exist_ok=True)
        have = json.loads(path.read_text()) if path.exists() else {}

        def write(answers: Answer) -> None:
            path.write_text(json.dumps(answers, indent=1) + "\n")

        run(options.tool, options.minutes, write, have)


if __name__ == "__main__":
    main()
