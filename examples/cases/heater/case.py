"""A heated block, of which heat capacity and loss are known."""

from pathlib import Path

from stickslip import Diagnosis, diagnose_model, models

model = models.thermal(capacity=(200.0, 10.0), loss=(2.0, 0.2), ambient=0.0)


def diagnosed() -> Diagnosis:
    """The diagnosis of the log."""
    log = models.read_log(Path(__file__).with_name("log.csv"), model)
    return diagnose_model(model, log)


if __name__ == "__main__":
    result = diagnosed()
    print(result.verdict.kind, *sorted(result.verdict.causes))
