"""A cart with a motor, of which mass, gain and friction are known."""

from pathlib import Path

from stickslip import Diagnosis, diagnose_model, models

model = models.axis(
    mass=2.0,
    gain=(3.0, 0.1),
    viscous=(4.0, 0.3),
    coulomb=(1.5, 0.2),
    without=["stribeck", "quadratic", "compliance"],
)


def diagnosed() -> Diagnosis:
    """The diagnosis of the log."""
    log = models.read_log(Path(__file__).with_name("log.csv"), model)
    return diagnose_model(model, log)


if __name__ == "__main__":
    result = diagnosed()
    print(result.verdict.kind, *sorted(result.verdict.causes))
    print(f"{1e3 * result.params['value']['late command.time']:.1f} ms")
