"""Stored data sets of old seeds, each with the errors and fits of the engine that stored it.

What a change of the search or of the rules gives is seen here before a study: the verdicts, and
whether the truth and the former leader are fitted as well, by the stored errors.
"""

from __future__ import annotations

import signal
import tempfile
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from scipy.linalg import block_diag, solve_triangular

from blind.study import HERE, SETS, Array, Row, append, lines, pack, sets, state, unpacked
from blind.writing import write_case
from stickslip import Diagnosis, diagnose, read_measurement

FROZEN = HERE / "frozen"
ROWS = "rows.jsonl.xz"
WORSE = 1.0  # growth of a chi-square that is allowed
_FITS = 6  # models that are stored beside the truth and the recalibrated one


def store(asked: Iterable[tuple[str, int]], minutes: float, most: float) -> None:
    """Make, diagnose and store data sets whose diagnosis takes at most so many CPU seconds.

    One that is stored is diagnosed again if another engine did it; none begins after some minutes.
    """
    now, end = state(), time.monotonic() + 60.0 * minutes
    parts = {FROZEN / name: FROZEN / f"{name}.part" for name in (ROWS, SETS)}
    pack(parts)
    made = {each["name"]: each for each in sets(FROZEN / SETS)}
    done = {each["name"] for each in sets(FROZEN / ROWS) if each["engine"] == now["engine"]}
    for kind, seed in asked:
        name = f"{kind} {seed}"
        if time.monotonic() > end:
            break
        if name in done:
            continue
        with tempfile.TemporaryDirectory() as work:
            folder = Path(work) / "data"
            one = made.get(name)
            if one is None:
                answer = write_case(folder, kind, seed)
                files = {each.name: each.read_text() for each in sorted(folder.iterdir())}
                one = {"name": name, "kind": kind, "seed": seed, "answer": answer, "files": files}
            begin = time.process_time()
            try:
                with at_most(most):
                    found = diagnose(read_measurement(unpacked(one, folder)), threads=1)
            except TimeoutError:
                print(f"{name}: above {most:.0f} CPU s", flush=True)
                continue
        row = {"name": name, "engine": now["engine"], "commit": now["commit"]}
        row |= {**_said(found), "cpu_seconds": round(time.process_time() - begin, 1)}
        append(parts[FROZEN / SETS], one)
        append(parts[FROZEN / ROWS], row | _numbers(found, one["answer"]["answer"]))
        print(f"{name}: {row['verdict']}, {row['cpu_seconds']:.1f} CPU s", flush=True)
    pack(parts)


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Raise TimeoutError after some CPU seconds."""

    def stop(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def _said(found: Diagnosis) -> Row:
    return {"verdict": found.verdict.kind, "causes": list(found.verdict.causes)}


def _numbers(found: Diagnosis, truth: list[str]) -> Row:
    """Errors, and the leading fits with their evidence."""
    problem, models = found.problem, found.findings.models
    best = {}
    for each in models.leaders():
        wanted = len(best) < _FITS or each.names in (frozenset(), frozenset(truth))
        if wanted and each.names not in best:
            best[each.names] = each
    fits = []
    for names, likeliest in best.items():
        each = models.get(names) or likeliest
        values = problem.physical(each.x[None, :])[0][each.free]
        fits.append(
            {
                "causes": sorted(names), "form": each.form, "likeliest": likeliest.form,
                "chi2": round(each.chi2, 4), "log_evidence": round(likeliest.log_evidence, 4),
                "values": {problem.names[k]: float(f"{value:.8g}")
                           for k, value in zip(each.free.tolist(), values, strict=True)},
            }
        )  # fmt: skip
    covariances = [problem.covariance(k) for k in range(len(problem.tables))]
    upper = [
        None if each is None else [float(f"{e:.6g}") for e in each[np.triu_indices(len(each))]]
        for each in covariances
    ]
    return {
        "p_value": found.findings.test.p_value,
        "probabilities": {name: round(p, 4) for name, p in found.verdict.probabilities.items()},
        "sd": [float(f"{each:.6g}") for each in problem.sd], "covariances": upper, "fits": fits,
    }  # fmt: skip


def whitened(row: Row, residual: Array, counts: list[int]) -> Array:
    """A residual in the stored errors; `counts` are the rows of each table."""
    blocks, at = [], 0
    for count, upper in zip(counts, row["covariances"], strict=True):
        block = np.diag(np.square(row["sd"][at : at + count]))
        if upper is not None:
            block[np.triu_indices(count)] = upper
            block = np.triu(block) + np.triu(block, 1).T
        blocks.append(np.linalg.cholesky(block))
        at += count
    return np.asarray(solve_triangular(block_diag(*blocks), residual, lower=True))


def worse(found: Diagnosis, row: Row, truth: list[str]) -> dict[str, float]:
    """By how much chi-square of the truth and of the former leader has grown; NaN if not fitted."""
    counts = [len(each.mean) for each in found.problem.tables]
    claimed = [each for each in row["fits"] if each["causes"]][:1]
    grown = {}
    for old in [*claimed, *(each for each in row["fits"] if each["causes"] == sorted(truth))]:
        new = found.findings.models.get(old["causes"], old["form"])
        name = " + ".join(old["causes"]) or "none"
        grown[name] = (
            np.nan if new is None
            else float(np.sum(whitened(row, new.residual, counts) ** 2)) - old["chi2"]
        )  # fmt: skip
    return grown


def compare(out: Path, kinds: list[str], minutes: float, most: float) -> None:
    """Diagnose the stored sets, and set verdict, fits and cost beside those that are stored.

    Rows of the present engine that are in `out` are not made again.
    """
    now, end = state()["engine"], time.monotonic() + 60.0 * minutes
    before = {row["name"]: row for row in sets(FROZEN / ROWS)}
    done = {row["name"]: row for row in lines(out) if row["engine"] == now}
    rows = []
    for one in sets(FROZEN / SETS):
        name = one["name"]
        if one["kind"] not in kinds or name not in before:
            continue
        if name not in done:
            if time.monotonic() > end:
                continue
            begin = time.process_time()
            row = {"name": name, "engine": now}
            try:
                with tempfile.TemporaryDirectory() as work, at_most(most):
                    found = diagnose(read_measurement(unpacked(one, Path(work))), threads=1)
                row |= _said(found) | {"grown": worse(found, before[name], one["answer"]["answer"])}
            except TimeoutError:
                row |= {"verdict": f"above {most:.0f} CPU s", "causes": [], "grown": {}}
            done[name] = row | {"cpu_seconds": time.process_time() - begin}
            append(out, done[name])
        row, old = done[name], before[name]
        rows.append((row, old))
        truth = " + ".join(one["answer"]["answer"] or [one["answer"]["hook"] or "-"])
        said_before, said_now = (
            f"{each['verdict']} {', '.join(each['causes'][:4])}" for each in (old, row)
        )
        mark = "same" if (old["verdict"], set(old["causes"])) == (
            row["verdict"], set(row["causes"])) else "CHANGED"  # fmt: skip
        grown = ", ".join(f"{key} {value:+.2f}" for key, value in row["grown"].items())
        costs = f"{old['cpu_seconds']:.1f} -> {row['cpu_seconds']:.1f} CPU s"
        print(f"{mark} {name} | {truth} | {said_before} -> {said_now} | {grown} | {costs}",
              flush=True)  # fmt: skip
    same = sum((old["verdict"], set(old["causes"])) == (row["verdict"], set(row["causes"]))
               for row, old in rows)  # fmt: skip
    grown = np.array([value for row, _ in rows for value in row["grown"].values()])
    costs = np.array([[old["cpu_seconds"], row["cpu_seconds"]] for row, old in rows] or [[0, 0]])
    median, highest = np.median(costs, axis=0), costs.max(axis=0)
    print(
        f"{same} of {len(rows)} verdicts are the stored ones; {np.sum(grown <= WORSE)} of "
        f"{len(grown)} chi-squares are at most {WORSE:g} higher; CPU s before and now: median "
        f"{median[0]:.1f} and {median[1]:.1f}, at most {highest[0]:.0f} and {highest[1]:.0f}, "
        f"in all {costs[:, 0].sum():.0f} and {costs[:, 1].sum():.0f}"
    )
