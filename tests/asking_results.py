"""Results of a diagnosis that ask for experiments, as far as rounds look at one."""

from types import SimpleNamespace

import pandas as pd

from stickslip import Measurement, Scenario
from stickslip.diagnosis import Experiment
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.facts import Code, Fact

NOMINAL = Scenario().replace({"drive.mode": "OPP", "drive.base": 0.5e-3, "drive.pulses": 5})
OLD = pd.DataFrame({"frequency": [20.0, 20.0, 40.0, 40.0], "velocity": [1e-3, 1.1e-3, 2e-3, 2e-3]})
UNSAFE = Fact(Code.NO_SAFE_NAME, {"causes": ["a", "b"]})
SAFE = Fact(Code.NAME_SAFE, {"name": "a", "margin": MARGIN})


def measurement(table=OLD):
    return Measurement.from_dataframe(table, NOMINAL)


def experiments(count, separation=9.0):
    """Drives of other frequencies, and what two candidates predict of them."""
    conditions = measurement().velocity[0].conditions
    drive = {key.removeprefix("drive."): value for key, value in conditions[0].items()}
    predictions = {name: {"velocity": 1e-3, "sd": 1e-5} for name in ("a", "b")}
    return [
        Experiment({**drive, "frequency": 50.0 + 10.0 * k}, UNSAFE, separation, predictions)
        for k in range(count)
    ]


def asking(data, said=UNSAFE, count=3):
    """A result that proposes, as far as rounds look at one."""
    proposed = [] if said.code is Code.NOTHING_TO_SEPARATE else experiments(count)
    verdict = SimpleNamespace(kind="named", causes=("a",))
    return SimpleNamespace(
        measurement=data,
        next_step=said,
        propose_experiments=lambda most: proposed[:most],
        posed=SimpleNamespace(conditions=[*data.velocity[0].conditions]),
        findings=SimpleNamespace(verdict=verdict),
    )
