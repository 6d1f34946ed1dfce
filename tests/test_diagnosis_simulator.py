"""The simulation as the model of a diagnosis: its accuracy, its causes and their sizes."""

from types import SimpleNamespace

import numpy as np

from stickslip import Scenario
from stickslip.diagnosis import Prior, Uncertain
from stickslip.diagnosis.model.effect_causes import _SHAPES, _SIZES, library
from stickslip.diagnosis.model.simulator import Simulator, loosest_tolerances
from stickslip.scenario.named_effects import effects, is_lawful

LAWFUL = [each for each in effects() if is_lawful(each.name)]


def test_predictions_do_not_depend_on_threads():
    drive = [{"drive.frequency": f, "drive.pulses": 5} for f in (30.0, 60.0)]
    values = np.array([[0.14], [0.15], [0.16]])
    one, three = (
        Simulator(Scenario(), ["contact.kinetic_friction"], threads)(drive, values)
        for threads in (1, 3)
    )
    assert np.array_equal(one, three)


TRIED = (1e-4, 1e-5, 1e-6, 1e-7)
DRIVES = [
    {"drive.mode": mode, "drive.frequency": f, "drive.pulses": 5, "drive.base": 0.5e-3}
    for mode in ("IPP", "OPP")
    for f in (25.0, 40.0, 60.0, 90.0)
]


def _errors(names, values):
    """Of each tolerance against one a hundred times finer than the finest, m/s."""

    def velocities(rtol):
        return Simulator(Scenario().replace({"solver.rtol": rtol}), names)(DRIVES, values)

    truth = velocities(0.01 * TRIED[-1])
    return {rtol: np.abs(velocities(rtol) - truth) for rtol in TRIED}


def _chosen(uncertain, sd, stated=TRIED[-1]):
    simulator = Simulator(
        Scenario().replace({"solver.rtol": stated}), [each.name for each in uncertain]
    )
    noise = SimpleNamespace(covariance=np.diag(sd**2))
    return loosest_tolerances(simulator, DRIVES, uncertain, [], noise, 0).tolist()


def test_each_condition_has_the_loosest_tolerance_whose_error_is_far_below_its_noise():
    # m/s; from where the loosest will do to where none does.
    noise = np.geomspace(1e-3, 1e-7, len(DRIVES))
    error = {rtol: each[0] for rtol, each in _errors([], np.zeros((1, 0))).items()}
    chosen = _chosen([], noise)
    assert set(chosen) == set(TRIED)
    for k, rtol in enumerate(chosen):
        assert error[rtol][k] < noise[k] / 20.0 or rtol == TRIED[-1]
        for looser in TRIED[: TRIED.index(rtol)]:
            assert error[looser][k] > noise[k] / 20.0
    # A scenario that asks for little is computed no worse than the finest that is always tried.
    assert min(_chosen([], noise, stated=1e-3)) == TRIED[-2]


def test_tolerances_hold_over_the_prior():
    # Chosen by three quarters of eight draws, so of others most are as good. By the middle of the
    # prior alone some condition would get a tolerance that is too loose for most.
    noise = np.full(len(DRIVES), 4e-5)
    friction = Uncertain("contact.kinetic_friction", Prior("normal", 0.145, 0.01))
    others = friction.prior.value(np.random.default_rng(7).standard_normal((20, 1)))
    error = _errors([friction.name], others)
    for k, rtol in enumerate(_chosen([friction], noise)):
        assert rtol != TRIED[-1]  # which would be taken where none is good
        assert np.mean(error[rtol][:, k] < noise[k] / 20.0) > 0.5


def test_every_extension_of_a_known_law_is_a_cause_that_starts_absent():
    causes = library(Scenario(), {}, 20.0)
    assert [each.name for each in causes] == [each.name for each in LAWFUL]
    # The 13 free shapes and the own values of 5 coils are none.
    left_out = {each.name for each in effects()} - {each.name for each in LAWFUL}
    assert len(left_out) == 13 + 5
    assert all(name.startswith(("free_", "coil_")) for name in left_out)
    parameters = [each for cause in causes for each in cause.parameters]
    names = [each.name for each in parameters]
    absent = np.array([[float(each.value(np.zeros(1))[0]) for each in parameters]])
    drive = [{"drive.frequency": 50.0, "drive.pulses": 5, "drive.base": 0.5e-3}]
    plain = Simulator(Scenario(), [])(drive, np.zeros((1, 0)))
    assert Simulator(Scenario(), names)(drive, absent) == plain


def test_every_extension_has_a_size_of_its_own():
    # Else it would be guessed from its range, which is as wide as physics allows.
    across = {"ambient_field.By", "surface_tilt.azimuth"}
    names = {key.name.removeprefix("effects.") for each in LAWFUL for key in each.parameters}
    assert names - across == {*_SIZES, *_SHAPES, "amplifier_limit.voltage"}
