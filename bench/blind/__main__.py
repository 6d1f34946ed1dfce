"""A data set of the blind study as files, and its answer apart: `write KIND SEED INTO`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from blind.kinds import KINDS
from blind.writing import write_case


def main() -> None:
    """Write a data set."""
    parser = argparse.ArgumentParser(prog="python -m bench blind", description=__doc__)
    write = parser.add_subparsers(required=True).add_parser("write")
    write.add_argument("kind", choices=KINDS)
    write.add_argument("seed", type=int)
    write.add_argument("into", type=Path)
    options = parser.parse_args()
    answer = write_case(options.into / "data", options.kind, options.seed)
    (options.into / "answer.json").write_text(json.dumps(answer, indent=2) + "\n")
    print(options.into / "data" / "measurement.toml")


if __name__ == "__main__":
    main()
