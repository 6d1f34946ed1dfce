"""One data set of the study, from its making to what is said of it."""

from __future__ import annotations

import hashlib
import subprocess
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import stickslip
from blind.writing import write_case, write_more
from stickslip.diagnosis.api import diagnose
from stickslip.measurement import read_measurement

_HERE = Path(__file__).resolve().parent
# Of the study: what decides about the data.
_DATA = (
    "catalogue", "generator", "kinds", "noise", "readings", "settings", "strength", "truth",
    "writing",
)  # fmt: skip


def state() -> dict[str, str]:
    """Which engine and which generator made a row: version, commit, sums of their files."""
    package = Path(stickslip.__file__).resolve().parent
    engine = (path for path in package.rglob("*") if path.suffix in (".py", ".so"))
    reference = (_HERE.parents[1] / "tests" / "reference").glob("[!t]*.py")
    data = [*(_HERE / f"{name}.py" for name in _DATA), *reference]
    asked = ("git", "-C", str(_HERE), "rev-parse", "--short", "HEAD")
    commit = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    return {
        "version": stickslip.__version__,
        "commit": commit,
        "engine": _checksum(engine),
        "data": _checksum(data),
    }


def _checksum(paths: Iterable[Path]) -> str:
    total = hashlib.sha256()
    for path in sorted(paths):
        total.update(path.name.encode() + path.read_bytes())
    return total.hexdigest()[:12]


def study(kind: str, seed: int) -> dict[str, Any]:
    """Make one data set, diagnose it from its files alone, and return what was said.

    Near twins are measured again at the experiments that the diagnosis proposes.
    """
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work) / "data"
        answer = write_case(folder, kind, seed)
        row = {"answer": answer, **_diagnosed(folder)}
        drives = [each["drive"] for each in row["said"]["next_experiments"]]
        if kind == "near twins" and drives:
            more = Path(work) / "more"
            write_more(folder, more, answer, drives)
            row["followed"] = _diagnosed(more)["said"]
        return row


def _diagnosed(folder: Path) -> dict[str, Any]:
    start = time.process_time()
    result = diagnose(read_measurement(folder / "measurement.toml"), threads=1)
    gain = result.gain
    return {
        "said": result.as_dict(),
        "reasons": [each.code.name for each in result.verdict.reasons],
        "gain": None if gain is None else {"p_value": gain.p_value, "choice": gain.choice},
        "cpu_seconds": time.process_time() - start,
    }
