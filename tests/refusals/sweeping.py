"""Refusals of sweeps and predictions: name, call in an empty folder, error, words."""

import itertools
from functools import partial

import numpy as np

from stickslip import (
    Drive,
    Scenario,
    ScenarioError,
    Waveform,
    predict,
    simulate,
    sweep,
    sweep_dataframe,
)

BASE = Scenario(drive=Drive(base=0.5e-3, pulses=4))
KNOWN = BASE.with_uncertain({"contact.kinetic_friction": {"mean": 0.145, "sd": 0.01}})
FRICTION = {"contact.static_friction": [0.3, 0.1]}


def swept(folder, vary=FRICTION, scenario=BASE, **how):
    return sweep(scenario, vary, **how)


def predicted(folder, scenario=KNOWN, **how):
    return predict(scenario, **how)


def resumed(folder, *, first=(BASE, FRICTION), then=(BASE, FRICTION), damaged=None):
    """A sweep whose file is that of another one, or of none."""
    path = folder / "a.nc"
    sweep(*first, out=path)
    if damaged is not None:
        path.write_bytes(damaged(path.read_bytes()))
    return sweep(*then, out=path, resume=True)


def a_run(folder):
    simulate(BASE.replace({"record.rate": 1e3})).save(folder / "a.nc")
    return sweep(BASE, FRICTION, out=folder / "a.nc", resume=True)


def played(waveform):
    return Scenario(drive=Drive(mode="program", program=waveform))


VARIED = [
    ("no key", {}, "needs a key"),
    ("no list", [], "the list is empty"),
    ("nothing", None, "vary = None"),
    ("unknown key", {"drive.freqency": [1]}, 'did you mean "drive.frequency"'),
    ("number as key", {3: [1]}, "key 3"),
    ("map", {"coil.map": [None]}, "not voltages or maps"),
    ("no value", {"drive.frequency": []}, "drive.frequency: there is no value"),
    ("one value", {"drive.frequency": 30.0}, "drive.frequency = 30.0: allowed is a list"),
    ("endless", {"drive.frequency": itertools.count(1)}, "at most 10000000 values"),
    ("negative", {"drive.frequency": [30.0, -1.0]}, "drive.frequency = -1.0"),
    ("twice", {"drive.frequency": [30, 30.0]}, "30.0: this value is given twice"),
    ("record", {"record.rate": [1e3]}, "record.rate: a sweep keeps summaries only"),
    ("rows of numbers", [1.0], "vary, point 0 = 1.0"),
    ("unknown key in a row", [{"drive.freqency": 1}], "did you mean"),
    ("wrong value in a row", [{}, {"drive.pulses": 0}], "drive.pulses = 0"),
    (
        "too many",
        {"drive.frequency": np.linspace(1, 2, 10_000), "drive.peak": np.linspace(0, 1, 10_000)},
        "100000000 points",
    ),
]

PREDICTED = [
    ("varied and uncertain", {"vary": {"contact.kinetic_friction": [0.1]}}, "either varied or"),
    ("unknown key", {"vary": {"drive.frequencies": [1.0]}}, 'did you mean "drive.frequency"'),
    ("points", {"vary": 3}, "allowed is values by key"),
    ("one draw", {"draws": 1}, "draws = 1: allowed is a whole number from 2"),
    ("many draws", {"draws": 10**7 + 1}, "at most 10000000 simulations"),
    ("seed", {"seed": -1}, "seed = -1"),
    ("quantile twice", {"quantiles": [0.5, 0.5]}, "each once"),
    ("a single quantile", {"quantiles": 0.5}, "between 0 and 1"),
    ("no prior", {"uncertain": 3}, "a section [uncertain]"),
    ("scenario without priors", {"uncertain": Scenario()}, "no uncertain parameter"),
    ("nothing uncertain", {"scenario": BASE}, "state them under [uncertain]"),
    ("hardly allowed", {"uncertain": {"contact.kinetic_friction": {"mean": 0.9, "sd": 0.01}}},
     "100 draws"),
]  # fmt: skip

ANOTHER = "cannot be resumed: it belongs to another sweep"
NO_FILE = "cannot be resumed: is no netCDF file"
IPP = Waveform.ipp(base=0.5e-3, pulses=2)
RESUMED = [
    ("scenario", {"then": (BASE.replace({"drive.hold": 2e-3}), FRICTION)}, ANOTHER),
    ("values", {"then": (BASE, {"contact.static_friction": [0.3, 0.2]})}, ANOTHER),
    ("list", {"then": (BASE, [{"contact.static_friction": each} for each in (0.3, 0.1)])}, ANOTHER),
    (
        "order",
        {
            "first": (BASE, {**FRICTION, "drive.hold": [0.0, 1e-3]}),
            "then": (BASE, {"drive.hold": [0.0, 1e-3], **FRICTION}),
        },
        ANOTHER,
    ),
    ("voltages", {"first": (played(IPP), FRICTION), "then": (played(2 * IPP), FRICTION)}, ANOTHER),
    ("cut", {"damaged": lambda whole: whole[: len(whole) // 2]}, NO_FILE),
]  # fmt: skip

REFUSALS = [
    *((f"sweep: {n}", partial(swept, vary=v), ScenarioError, words) for n, v, words in VARIED),
    ("sweep: sawtooth", partial(swept, vary={"drive.peak": [1e-3]}, scenario=played(IPP)),
     ScenarioError, "not allowed with drive.mode"),
    ("sweep: scenario", partial(swept, scenario=3), ScenarioError, "scenario = 3"),
    ("sweep: list of scenarios", partial(swept, scenario=[BASE]), ScenarioError, "a Scenario"),
    *((f"sweep: threads {n!r}", partial(swept, threads=n), ValueError, "threads = ")
      for n in (0, -1, 1.5, True, "2")),
    ("sweep: resume without a file", partial(swept, resume=True), ValueError, "resume"),
    ("sweep: executor", partial(swept, executor="dask"), ScenarioError,
     'executor = "dask": allowed is an Executor'),
    ("sweep: progress", partial(swept, progress="yes"), ScenarioError, "a function of a fraction"),
    ("sweep: suffix", lambda folder: swept(folder, out=folder / "s.txt"), ValueError,
     ".nc, .nc4, .h5"),
    ("predict: suffix", lambda folder: predicted(folder, out=folder / "d.csv"), ValueError,
     ".nc, .nc4, .h5"),
    *((f"predict: {n}", partial(predicted, **how), ScenarioError, words)
      for n, how, words in PREDICTED),
    *((f"resume: {n}", partial(resumed, **how), ScenarioError, words)
      for n, how, words in RESUMED),
    ("resume: run", a_run, ScenarioError, ANOTHER),
    ("sweep: a folder", lambda folder: (folder / "a.nc").mkdir() or
     swept(folder, out=folder / "a.nc"), OSError, "a folder"),
    ("sweep: no folder", lambda folder: swept(folder, out=folder / "no/a.nc"), OSError,
     "there is no folder"),
    ("sweep_dataframe: run", lambda folder: sweep_dataframe(simulate(BASE)), ScenarioError,
     "what sweep or predict gave"),
    ("sweep_dataframe: Dataset of a run",
     lambda folder: sweep_dataframe(simulate(BASE.replace({"record.rate": 1e3})).to_xarray()),
     ScenarioError, "what sweep or predict gave"),
]  # fmt: skip
