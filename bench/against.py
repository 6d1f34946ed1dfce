"""This version beside an earlier commit: `python -m bench against COMMIT`.

Protocol. The package of the earlier commit is built into build/against; the installed one is not
touched. Each version, and each limit of the lanes' width, is a process of its own on the same core
(`against_worker.py`). They measure in turn, so that drift meets them alike; a figure is the median
of CPU time, a ratio the median of the ratios of the turns. Only the speed-up by a second thread is
wall time, and best beside median, as other work on the machine can only lower it.

Equal accuracy. The error of a version at a tolerance is the root mean square of the relative error
of the mean velocity over the sixteen runs of `speed.py`, against the same version at rtol 1e-11.
CPU time against error is interpolated in the logarithms. Of the other workloads both versions have
rtol 1e-6, and the median of the relative error stands beside.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import statistics
import subprocess
import sys
import tarfile
from pathlib import Path

import numpy as np
from against_worker import RTOL
from measure import machine, pin
from speed import REFERENCE, speed_at_error

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
EQUAL_ERRORS = (1e-4, 1e-5, 1e-6)
WIDTHS = (1, 4, 8)
ALONE = "now, lanes <= 1"
EXACT = 1e-11
BUILD = Path("build/against")


def git(*arguments: str) -> bytes:
    return subprocess.run(["git", *arguments], check=True, stdout=subprocess.PIPE).stdout


def built(commit: str) -> Path:
    """Folder with the package of `commit`; built if it is not there."""
    full = git("rev-parse", "--verify", f"{commit}^{{commit}}").decode().strip()
    package = BUILD / full / "package"
    if (package / "stickslip").is_dir():
        return package
    print(f"building stickslip of {full[:7]} (some minutes)", flush=True)
    source = BUILD / full / "source"
    with tarfile.open(fileobj=io.BytesIO(git("archive", full))) as archive:
        archive.extractall(source)
    install = ["-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps"]
    subprocess.run([sys.executable, *install, "--target", str(package), str(source)], check=True)
    return package


class Version:
    """A process with one version of the package.

    package: folder that comes before the installed packages, or None for the installed one.
    width: limit of the lanes' width. pinned: on one core.
    """

    def __init__(
        self, package: Path | None = None, width: int | None = None, pinned: bool = True
    ) -> None:
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        environment.pop("PYTHONPATH", None)
        environment.pop("STICKSLIP_LANES", None)
        if package is not None:
            environment["PYTHONPATH"] = str(package.resolve())
        if width is not None:
            environment["STICKSLIP_LANES"] = str(width)
        worker = Path(__file__).with_name("against_worker.py")
        self._process = subprocess.Popen(
            [sys.executable, str(worker), *([] if pinned else ["--unpinned"])],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )

    def ask(self, request: str, **arguments):
        """The answer to a request of `against_worker.py`."""
        self._process.stdin.write(json.dumps([request, arguments]) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"the worker ended while it was asked for {request} {arguments}")
        return json.loads(line)

    def close(self) -> None:
        self._process.stdin.close()
        self._process.wait()


def in_turn(requests: list[tuple[Version, dict]], repeats: int) -> list[list[dict[str, float]]]:
    """Measurements for each of `requests`, taken in turn; the first turn does not count."""
    turns = [
        [version.ask("measured", **request) for version, request in requests]
        for _ in range(repeats + 1)
    ]
    return [list(column) for column in zip(*turns[1:], strict=True)]


def median(samples: list[dict[str, float]]) -> float:
    return statistics.median(each["seconds"] for each in samples)


def ratio(first: list[dict[str, float]], second: list[dict[str, float]]) -> float:
    """Median of the ratios of the turns."""
    pairs = zip(first, second, strict=True)
    return statistics.median(one["seconds"] / two["seconds"] for one, two in pairs)


def reference_rows(versions: dict[str, Version], repeats: int) -> list[dict]:
    """Speed and velocity error of the reference run at each tolerance, of each version."""
    names = [(name, rtol) for rtol in TOLERANCES for name in versions]
    requests = [(versions[name], {"name": "one", "rtol": rtol}) for name, rtol in names]
    exact = {
        name: np.array(version.ask("about_reference", rtol=EXACT))
        for name, version in versions.items()
    }
    rows = []
    for (name, rtol), samples in zip(names, in_turn(requests, repeats), strict=True):
        found = np.array(versions[name].ask("about_reference", rtol=rtol))
        rows.append(
            {
                "method": name,
                "rtol": rtol,
                "simulated_per_cpu_second": samples[0]["simulated"] / median(samples),
                "velocity_error": float(np.sqrt(np.mean((found / exact[name] - 1.0) ** 2))),
            }
        )
    return rows


def equal_accuracy(rows: list[dict], names: list[str]) -> list[dict]:
    """Speed of each version at the same velocity error, and how much faster than the first."""
    result = []
    for error in EQUAL_ERRORS:
        speeds = {name: speed_at_error(rows, name, error) for name in names}
        ratios = {name: speed / speeds[names[0]] for name, speed in speeds.items()}
        result.append({"velocity_error": error, "speeds": speeds, "ratios": ratios})
    return result


def typical_error(version: Version, work: str, exact: np.ndarray) -> float:
    """Median relative error of the mean velocities at `RTOL`; below 1 um/s relative to that."""
    found = np.array(version.ask("found", name=work, rtol=RTOL))
    return float(np.nanmedian(np.abs(found - exact) / np.maximum(np.abs(exact), 1e-6)))


def workload_rows(versions: dict[str, Version], work: str, repeats: int) -> list[dict]:
    """Speed of each version with one workload, and how much faster it is than the first."""
    samples = in_turn([(v, {"name": work, "rtol": RTOL}) for v in versions.values()], repeats)
    exact = np.array(versions["now"].ask("found", name=work, rtol=EXACT))
    return [
        {
            "work": work,
            "version": name,
            "simulated_per_cpu_second": mine[0]["simulated"] / median(mine),
            "ratio": ratio(samples[0], mine),
            "velocity_error": typical_error(version, work, exact),
        }
        for (name, version), mine in zip(versions.items(), samples, strict=True)
    ]


def python_rows(versions: dict[str, Version], repeats: int) -> list[dict]:
    """CPU time of two calls of the Python layer."""
    rows = []
    for work, call in (("replaced", "Scenario.replace"), ("converted", "Scenario.to_core")):
        samples = in_turn([(version, {"name": work}) for version in versions.values()], repeats)
        costs = {name: 1e6 * median(each) for name, each in zip(versions, samples, strict=True)}
        rows.append({"call": call, "microseconds": costs, "ratio": ratio(*samples)})
    return rows


def second_thread(repeats: int) -> dict[str, float]:
    """Wall time of the sweep with one thread over that with two."""
    version = Version(pinned=False)
    requests = [
        (version, {"name": "swept", "rtol": RTOL, "jobs": jobs, "clock": "perf_counter"})
        for jobs in (1, 2)
    ]
    ratios = [
        one["seconds"] / two["seconds"]
        for one, two in zip(*in_turn(requests, repeats), strict=True)
    ]
    version.close()
    return {"median": statistics.median(ratios), "best": max(ratios)}


def show(result: dict) -> None:
    """The tables."""
    print(f"{'reference run':15} {'rtol':>7} {'simulated s / CPU s':>20} {'velocity error':>15}")
    for row in result["tolerances"]:
        print(
            f"{row['method']:15} {row['rtol']:7.0e} {row['simulated_per_cpu_second']:20.0f}"
            f" {row['velocity_error']:15.1e}"
        )
    print(f"\n{'equal velocity error':20} {'version':15} {'simulated s / CPU s':>20} {'ratio':>6}")
    for row in result["equal_accuracy"]:
        for name, speed in row["speeds"].items():
            error = f"{row['velocity_error']:.0e}"
            print(f"{error:20} {name:15} {speed:20.0f} {row['ratios'][name]:6.2f}")
    print(
        f"\n{'rtol 1e-6':10} {'version':15} {'simulated s / CPU s':>20} {'ratio':>6}"
        f" {'velocity error':>15}"
    )
    for row in result["workloads"]:
        print(
            f"{row['work']:10} {row['version']:15} {row['simulated_per_cpu_second']:20.0f}"
            f" {row['ratio']:6.2f} {row['velocity_error']:15.1e}"
        )
    threads = result["second_thread"]
    print(
        f"\ntwo threads, wall time: {threads['median']:.2f} times one (median),"
        f" {threads['best']:.2f} (best); others may use the machine"
    )
    for row in result["python"]:
        costs = ", ".join(f"{name} {cost:.1f} us" for name, cost in row["microseconds"].items())
        print(f"{row['call']}: {costs}, ratio {row['ratio']:.1f}")
    print("load average: " + ", ".join(f"{load:.1f}" for load in result["load_average"]))


def measure_all(package: Path, repeats: int) -> dict:
    """Everything that the tables say."""
    versions = {"before": Version(package), "now": Version()}
    widths = {f"now, lanes <= {width}": Version(width=width) for width in WIDTHS}
    places = {name: version.ask("identity")["package"] for name, version in versions.items()}
    if len(set(places.values())) < 2:
        raise RuntimeError(f"both versions are the same package: {places}")
    alone = {ALONE: widths[ALONE]}
    tolerances = reference_rows(versions | alone, repeats)
    rows = workload_rows(versions | alone, "mixed", repeats)
    for work in ("swept", "alike"):
        rows += workload_rows(versions | widths, work, repeats)
    for work in ("plane", "long", "stepped", "rolled_out"):
        rows += workload_rows(versions, work, repeats)
    result = {
        "tolerances": tolerances,
        "equal_accuracy": equal_accuracy(tolerances, [*versions, ALONE]),
        "workloads": rows,
        "python": python_rows(versions, 3 * repeats),
    }
    for version in (*versions.values(), *widths.values()):
        version.close()
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("commit", help="the earlier commit")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--out", type=Path, default=Path("bench/results/against.json"))
    options = parser.parse_args()
    package = built(options.commit)
    threads = second_thread(options.repeats)
    core = pin()
    result = {
        "machine": machine(),
        "core": core,
        "before": git("describe", "--always", "--long", options.commit).decode().strip(),
        "now": git("describe", "--always", "--dirty").decode().strip(),
        "reference_run": REFERENCE.to_toml(),
        **measure_all(package, options.repeats),
        "second_thread": threads,
        "load_average": os.getloadavg(),
    }
    show(result)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=2) + "\n")
    print(f"written: {options.out}")


if __name__ == "__main__":
    main()
