"""Results of a diagnosis that ask for experiments, with models that nobody fitted."""

from types import SimpleNamespace

import pandas as pd

from stickslip import Measurement, Scenario
from stickslip.diagnosis.decision.experiments import Experiment, next_step
from stickslip.diagnosis.decision.verdict import Verdict
from stickslip.diagnosis.result import Diagnosis
from stickslip.walker.experiments import drive_in_words
from stickslip.walker.problem import Drives, vocabulary

NOMINAL = Scenario().replace({"drive.mode": "OPP", "drive.base": 0.5e-3, "drive.pulses": 5})
OLD = pd.DataFrame({"frequency": [20.0, 20.0, 40.0, 40.0], "velocity": [1e-3, 1.1e-3, 2e-3, 2e-3]})
_VERDICTS = Verdict("ambiguous", ("a", "b")), Verdict("named", ("a",)), Verdict("none")
UNSAFE, SAFE = next_step(_VERDICTS[0], ["a", "b"], 0.0), next_step(_VERDICTS[1], ["“a”"], 0.0)


class Asking(Diagnosis):
    """A diagnosis whose verdict and proposals are given; the rest is as of any other."""

    def propose_experiments(self, count=3):
        return self.findings.proposed[:count]


def measurement(table=OLD):
    return Measurement.from_dataframe(table, NOMINAL)


def experiments(count, separation=9.0):
    """Drives of other frequencies, and what two candidates predict of them."""
    conditions = measurement().velocity[0].conditions
    drive = {key.removeprefix("drive."): value for key, value in conditions[0].items()}
    predictions = {name: {"velocity": 1e-3, "sd": 1e-5} for name in ("a", "b")}
    faster = [{**drive, "frequency": 50.0 + 10.0 * k} for k in range(count)]
    return [Experiment(each, _words(each), UNSAFE, separation, predictions) for each in faster]


def _words(drive):
    return drive_in_words({f"drive.{key}": value for key, value in drive.items()})


def asking(data, said=UNSAFE, count=3, separation=9.0):
    """A diagnosis of a measurement that says what to do next."""
    verdict = {UNSAFE: _VERDICTS[0], SAFE: _VERDICTS[1]}.get(said, _VERDICTS[2])
    proposed = experiments(count, separation)
    problem = SimpleNamespace(causes=(), forward=None, words=vocabulary(), rivals=Drives(data, ()))
    return Asking(SimpleNamespace(verdict=verdict, proposed=proposed, problem=problem), data)
