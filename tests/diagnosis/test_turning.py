"""Periods, delays and times of events, whose predictions turn: a search has many minima there."""

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip import (
    Cause,
    Parameter,
    Prior,
    ScenarioError,
    Series,
    diagnose_model,
    events,
    instruments,
)
from stickslip.diagnosis.model import ForwardModel, posed

TIMES = np.arange(300.0)
SQUARE = 5.0 + 2.0 * np.sign(np.sin(2.0 * np.pi * TIMES / 70.0))
WAVES = 1.0 + 0.8 * np.sin(2.0 * np.pi * TIMES / 22.0) + 0.15 * np.sin(2.0 * np.pi * TIMES / 75.0)
GAIN = Parameter("gain", Prior("normal", 1.02, 0.02))
OFFSET = instruments.offset("-", 0.2)


def relaxed(series, p):
    """A lag of 12 s behind an input that is held between two readings."""
    kept = np.exp(-1.0 / 12.0)
    wave = p.get("wave.size", 0.0) * np.sin(2.0 * np.pi * series.t / p.get("wave.period", 1.0))
    driven = p["gain"] * (series["u"] + wave)
    start = driven[:, :1]
    rest, _ = lfilter([1.0 - kept], [1.0, -kept], driven[:, :-1], axis=1, zi=kept * start)
    return np.hstack([start, rest])


def readings(u, causes, values):
    """Readings of the model without errors; `values` by name, 0 where none is given."""
    names = ["gain", *(one.name for cause in causes for one in cause.parameters)]
    record = Series(TIMES, TIMES, {"u": u}, sd=1.0)
    row = np.array([[values.get(name, 0.0) for name in names]])
    return ForwardModel(relaxed, None, (GAIN,), tuple(causes))(record, names, row)[0]


WAVE = Cause(
    "wave",
    (
        Parameter("wave.size", size=0.5, low=-20.0, high=20.0),
        Parameter("wave.period", Prior("log-normal", 14.0, 1.8), unit="s"),
    ),
)
LATE, LATE_READINGS = (instruments.delay(size=2.0, input=name, name="late") for name in ("u", None))
TURNING = {
    "a step of the readings": (SQUARE, events.step(1.0, 5.0, 295.0, name="event"),
                               {"event.height": 0.9, "event.time": 217.6}),
    "a pulse of the readings": (SQUARE, events.pulse(1.0, 5.0, 295.0, 60.0, name="event"),
                                {"event.height": -0.8, "event.time": 131.4, "event.length": 21.3}),
    "a pulse of an input": (SQUARE, events.pulse(1.0, 5.0, 295.0, 60.0, input="u", name="event"),
                            {"event.height": 1.3, "event.time": 203.0, "event.length": 14.0}),
    "a period": (SQUARE, WAVE, {"wave.size": 2.5, "wave.period": 6.3}),
    "a delay of a periodic input": (WAVES, LATE, {"late.time": 14.6, "late.before": 1.0}),
    "a delay of the readings": (WAVES, LATE_READINGS, {"late.time": 14.6}),
}  # fmt: skip


@pytest.mark.parametrize("what", TURNING)
@pytest.mark.daily("a period", "a pulse of an input")
def test_a_search_finds_what_turns_the_predictions(what):
    u, cause, truth = TURNING[what]
    sound = readings(u, (cause, OFFSET), {"gain": 1.0, "wave.period": 1.0, **truth})
    sd = 0.02 * float(np.std(sound))
    noise = sd * np.random.default_rng(3).standard_normal(len(TIMES))
    record = Series(TIMES, sound + noise, {"u": u}, sd=sd)
    found = diagnose_model(relaxed, record, [GAIN], [cause, OFFSET])
    assert (found.verdict.kind, found.verdict.causes) == ("named", (cause.name,))
    # The truth is among what is fitted; it is off by less than a prior's cost.
    assert found.best.fit.chi2 < np.sum((noise / sd) ** 2) + 4.0
    times = found.params[found.params["unit"] == "s"]
    for name, row in times.iterrows():
        # Errors of a time are those of the data, not of its prior; edges are of a reading's width.
        assert row["sd"] < 1.5
        assert abs(row["value"] - truth[name]) < 4.0 * row["sd"] + 0.5


def test_fineness_is_that_of_the_predictions():
    steady = Cause("drag", Parameter("drag.size", size=0.1, low=0.0, high=1.0))
    record = Series(TIMES, SQUARE, {"u": WAVES}, sd=0.1)

    def model(series, p):
        return relaxed(series, p) - p["drag.size"] * np.cumsum(series["u"], axis=-1) / 300.0

    made = posed(record, model, [GAIN], [WAVE, LATE, steady])
    fineness = dict(zip(made.names, made.fineness, strict=True))
    assert fineness["gain"] == fineness["wave.size"] == fineness["drag.size"] == 1.0
    # A move of a quarter of a period over the record turns an effect: ln(1 + 14 / (4 * 300)).
    assert 2.0**-9 <= fineness["wave.period"] < 2.0 * np.log1p(14.0 / 1200.0) / np.log(1.8)
    # A wave of 22 s keeps a cosine of 0.8 over 2.3 s, and the delay grows by up to 25 s a unit.
    assert 2.0**-5 <= fineness["late.time"] <= 0.25


@pytest.mark.parametrize("low", [-0.3, -0.7, -3.0])
def test_an_amplitude_that_only_grows_is_not_fine(low):
    bias = Cause("bias", Parameter("bias.size", size=0.5, low=low, high=20.0))
    record = Series(TIMES, SQUARE, {"u": WAVES}, sd=0.1)

    def model(series, p):
        return relaxed(series, p) + p["bias.size"] * np.cos(series.t / 9.0)

    assert np.all(posed(record, model, [GAIN], [bias]).fineness == 1.0)


def test_a_cause_may_state_the_fineness_of_one_of_two_amplitudes():
    parts = [Parameter(f"tone.{name}", size=0.5, low=-5.0, high=5.0, fineness=fineness)
             for name, fineness in (("sine", 0.1), ("cosine", 1.0))]  # fmt: skip
    tone = Cause("tone", parts)
    y = relaxed(Series(TIMES, SQUARE, {"u": SQUARE}, sd=1.0), {"gain": np.ones((1, 1))})[0]
    y = y + 0.5 * np.sin(TIMES) + 0.05 * np.random.default_rng(1).standard_normal(300)

    def model(series, p):
        wave = p["tone.sine"] * np.sin(series.t) + p["tone.cosine"] * np.cos(series.t)
        return relaxed(series, p) + wave

    found = diagnose_model(model, Series(TIMES, y, {"u": SQUARE}, sd=0.05), [GAIN], [tone])
    assert found.verdict.causes == ("tone",)


@pytest.mark.parametrize("cause", ["lag", "delay"])
@pytest.mark.parametrize("before", [0.0, 1.0])
@pytest.mark.daily("0.0-delay")
def test_an_input_before_its_record_is_free(cause, before):
    listed = [instruments.lag(5.0, input="u"), instruments.delay(size=5.0, input="u")]
    truth = {"gain": 1.0, f"{cause}.time": 6.0, f"{cause}.before": before}
    y = readings(SQUARE, listed, truth) + 0.02 * np.random.default_rng(5).standard_normal(300)
    found = diagnose_model(relaxed, Series(TIMES, y, {"u": SQUARE}, sd=0.02), [GAIN], listed)
    assert (found.verdict.kind, found.verdict.causes) == ("named", (cause,))
    # Six readings of a change of up to 7, with errors of 0.02: 4 * 0.02 / (7 * 6**0.5), tenfold.
    assert found.params.loc[f"{cause}.before", "value"] == pytest.approx(before, abs=0.05)


def test_a_model_of_chance_is_refused():
    random = np.random.default_rng(0)

    def model(series, p):
        return relaxed(series, p) + 0.1 * random.standard_normal((len(p["gain"]), 300))

    with pytest.raises(ScenarioError, match="returns other readings when it is called again"):
        diagnose_model(model, Series(TIMES, SQUARE, {"u": SQUARE}, sd=0.1), [GAIN], [OFFSET])
