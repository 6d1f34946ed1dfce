"""This version beside an earlier commit: `python -m bench against COMMIT`.

The package of the earlier commit is built into build/against; the installed one is not touched.
Each version is a process of its own on the same core. They measure the works of works.py in turn,
so that drift meets them alike: *now/before* is the median of the ratios of their CPU times, with
its 95 % interval, of 21 pairs or of as many more as make the interval 2 % wide. The median relative
errors of the mean velocities, against this version at rtol 1e-11, stand beside.
"""

from __future__ import annotations

import argparse
import functools
import io
import json
import os
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import numpy as np
from measure import figure_of, filled, in_turn, pin, ratios, saved
from works import WORKS

import stickslip

TOLERANCES, EXACT = (1e-6, 1e-8), 1e-11
BUILD = Path("build/against")


def worker() -> None:
    """Answer each line of standard input, a work and a tolerance, with seconds of a call.

    A line with a third word is answered with the velocities.
    """
    pin()
    print(json.dumps(os.path.dirname(stickslip.__file__)), flush=True)
    samples = functools.cache(lambda name, rtol: filled(lambda: WORKS[name].call(rtol)))
    for line in sys.stdin:
        name, rtol, *velocities = json.loads(line)
        answer = WORKS[name].call(rtol)[1] if velocities else samples(name, rtol)()
        print(json.dumps(answer), flush=True)


def built(commit: str) -> Path:
    """Folder with the package of `commit`, or that folder itself; built if it is not there."""
    if Path(commit, "stickslip").is_dir():
        return Path(commit)
    git = functools.partial(subprocess.run, check=True, stdout=subprocess.PIPE)
    full = git(["git", "rev-parse", "--verify", f"{commit}^{{commit}}"]).stdout.decode().strip()
    package = BUILD / full / "package"
    if not (package / "stickslip").is_dir():
        print(f"building stickslip of {full[:7]} (some minutes)", flush=True)
        source = BUILD / full / "source"
        with tarfile.open(fileobj=io.BytesIO(git(["git", "archive", full]).stdout)) as archive:
            archive.extractall(source)
        install = ["-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps"]
        subprocess.run([sys.executable, *install, "--target", package, source], check=True)
        # Its own text of the works, as keys and functions may be others.
        shutil.copy(source / "bench/works.py", package)
    return package


class Version:
    """A process with the package of a folder, and variables of its environment."""

    def __init__(self, package: Path, **variables: str) -> None:
        paths = [str(package.resolve()), str(Path(__file__).parent)]
        self._process = subprocess.Popen(
            [sys.executable, "-c", "import against; against.worker()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "OPENBLAS_NUM_THREADS": "1",
                 **variables},
        )  # fmt: skip
        self.package = json.loads(self._process.stdout.readline())

    def _ask(self, *words: object) -> object:
        self._process.stdin.write(json.dumps(words) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def seconds(self, work: str, rtol: float) -> float:
        """CPU seconds of a call."""
        return self._ask(work, rtol)

    def velocities(self, work: str, rtol: float) -> np.ndarray:
        return np.array(self._ask(work, rtol, "velocities"))

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait()


def errors(versions: list[Version], work: str, rtol: float) -> list[float]:
    """Median relative error of the velocities of each version; below 1 um/s, relative to that."""
    exact = versions[-1].velocities(work, EXACT)
    size = np.maximum(np.abs(exact), 1e-6)
    found = [np.abs(each.velocities(work, rtol) - exact) / size for each in versions]
    return [float(np.median(each)) if len(exact) else 0.0 for each in found]


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench against", description=__doc__)
    parser.add_argument("commit", help="the earlier commit, or a folder with its built package")
    parser.add_argument("--works", default=",".join(WORKS), help="separated by commas")
    parser.add_argument("--limit", type=float, metavar="RATIO", help="1 if an interval ends above")
    parser.add_argument("--out", type=Path, default=Path("bench/results/against.json"))
    options = parser.parse_args()
    names = options.works.split(",")
    if not set(names) <= set(WORKS):
        parser.error(f"--works: allowed are {', '.join(WORKS)}")
    before, now = Version(built(options.commit)), Version(Path(stickslip.__file__).parents[1])
    if before.package == now.package:
        parser.error(f"both versions are the same package: {now.package}")
    print(f"{'work':11}{'rtol':>6}{'CPU s before':>13}{'now':>10}{'now/before':>11}"
          f"{'95 % interval':>17}{'pairs':>6}{'errors':>17}")  # fmt: skip
    rows = []
    for work in names:
        for rtol in TOLERANCES:
            asked = [functools.partial(each.seconds, work, rtol) for each in (now, before)]
            samples = list(in_turn(asked))
            ratio = ratios(samples)
            second, first = (figure_of(mine).median for mine in zip(*samples, strict=True))
            wrong = errors([before, now], work, rtol)
            rows.append({"work": work, "rtol": rtol, "cpu_seconds": [first, second],
                         "ratio": ratio._asdict(), "errors": wrong})  # fmt: skip
            between = f"{ratio.low:.3f} to {ratio.high:.3f}"
            said = " ".join(f"{each:.1e}" for each in wrong)
            print(f"{work:11}{rtol:6.0e}{first:13.2e}{second:10.2e}{ratio.median:11.3f}"
                  f"{between:>17}{ratio.n:6}{said:>17}", flush=True)  # fmt: skip
    before.close()
    now.close()
    saved(options.out, "against", {"before": options.commit, "works": rows})
    slow = [f"{row['work']} at rtol {row['rtol']:.0e}" for row in rows
            if options.limit is not None and row["ratio"]["high"] > options.limit]  # fmt: skip
    if slow:
        print(f"not shown to be within {options.limit} of before: {', '.join(slow)}")
    return int(bool(slow))


if __name__ == "__main__":
    sys.exit(main())
