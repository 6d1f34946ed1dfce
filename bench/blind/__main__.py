"""``python -m blind``: data sets of every kind, diagnosed without their answers, then scored."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from blind.generator import KINDS, write_case
from blind.scoring import judge, table


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(prog="python -m blind", description=__doc__)
    parser.add_argument("--seeds", type=int, default=3, help="data sets of each kind")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--kinds", default=",".join(KINDS), help="comma-separated")
    parser.add_argument("--jobs", type=int, default=2, help="processes of the generator")
    parser.add_argument("--out", type=Path, default=Path("bench/results/blind"))
    options = parser.parse_args()
    out = options.out
    out.mkdir(parents=True, exist_ok=True)
    rows, answers = [], []
    with ProcessPoolExecutor(options.jobs) as pool:
        for seed in range(options.first, options.first + options.seeds):
            for kind in options.kinds.split(","):
                # The folder's name tells the diagnosis nothing.
                folder = out / "data" / f"{len(rows):04d}"
                path, answer = write_case(folder, kind, seed, pool)
                answers.append(answer)
                (out / "answers.json").write_text(json.dumps(answers, indent=2))
                start = time.perf_counter()
                command = [sys.executable, "-m", "stickslip", "diagnose", str(path), "--json"]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                if done.returncode:
                    print(kind, seed, done.stderr.strip(), flush=True)
                    continue
                said = json.loads(done.stdout)
                row = {
                    "kind": kind,
                    "seed": seed,
                    "truth": answer["answer"],
                    "outcome": judge(answer, said),
                    "seconds": time.perf_counter() - start,
                    "said": said,
                }
                rows.append(row)
                print(
                    kind, seed, answer["answer"], "->", said["verdict"], said["cause"],
                    f"p = {said['p_value']:.2g}: {row['outcome']}, {row['seconds']:.0f} s",
                    flush=True,
                )  # fmt: skip
                (out / "results.json").write_text(json.dumps(rows, indent=2))
    text = table(rows)
    (out / "table.md").write_text(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
