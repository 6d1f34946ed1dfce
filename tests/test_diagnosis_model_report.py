"""The page of a diagnosis with a model of the user's own."""

import json

import numpy as np
import pytest

from report_page import without_pictures
from stickslip.diagnosis import Prior, Uncertain, diagnose_model
from stickslip.errors import ScenarioError
from toy_model import (
    CAUSES,
    SIZE,
    UNCERTAIN,
    X,
    predict,
    shared_result,
)


def _page(folder, given):
    given.save_report(folder, title="Toy", place=X, labels=("x", "y (V)"), unit="V")
    assert sorted(each.name for each in folder.iterdir()) == ["report.html", "report.json"]
    text = without_pictures(folder / "report.html")
    assert "<h1>Toy</h1>" in text
    assert not any(word in text for word in ("extended.toml", "http", "mm/s"))
    return json.loads((folder / "report.json").read_text()), text


def test_a_model_of_the_users_own_has_a_page_too(tmp_path):
    given = shared_result(3, wave=1.0)
    full, text = _page(tmp_path / "toy", given)
    assert (full["verdict"], full["cause"], full["gain_unit"]) == ("named", "wave", "V")
    assert "mean absolute error (V)" in text
    assert "% of the mean size" in text
    assert f"Gain on {full['gain']['n']} held-out conditions" in text
    data = full["channels"]["Data and models"]
    assert data["place"] == X.tolist()
    assert data["observed"] == given.findings.problem.observed.tolist()
    # The parameters of the extended model are in no file of their own.
    assert "in report.json, under “parameters”" in text
    values = {name: each["value"] for name, each in full["parameters"].items()}
    constants = {name: each["extended"] for name, each in full["recalibrated"].items()}
    assert {**constants, **values} == pytest.approx(given.extended)
    # The extended model is within the noise, the recalibrated one is not.
    gap = {
        name: np.subtract(data[name], data["observed"]) / data["sd"]
        for name in ("recalibrated", "extended")
    }
    assert np.mean(gap["extended"] ** 2) < 2.0 < np.mean(gap["recalibrated"] ** 2)


def test_each_verdict_has_a_page(tmp_path):
    full, text = _page(tmp_path / "set", shared_result(0, split=0.4))
    assert full["verdict"] == "ambiguous"
    assert "the best that explains the data" in text
    full, text = _page(tmp_path / "none", shared_result(3))
    assert full["verdict"] == "none"
    assert "Upper limit of each cause" in text
    lost = diagnose_model(predict, None, np.zeros(SIZE), UNCERTAIN, CAUSES)
    full, text = _page(tmp_path / "lost", lost)
    assert full["verdict"] == "data-problem"
    data = full["channels"]["Data and models"]
    assert (data["sd"], "recalibrated" in data) == (None, False)


def test_a_model_without_suspects_has_a_page(tmp_path):
    slope = Uncertain("slope", Prior("normal", 0.0, 1.0), suspect=False)
    given = diagnose_model(lambda x, p: p * x, X, 0.3 * X, [slope], sd=0.1)
    full, text = _page(tmp_path / "plain", given)
    assert full["verdict"] == "none"
    assert "What these data can tell apart" not in text


@pytest.mark.parametrize("place", [[1.0, 2.0], np.full(SIZE, np.nan)])
def test_a_page_with_a_wrong_abscissa_is_refused(tmp_path, place):
    given = shared_result(3)
    with pytest.raises(ScenarioError, match="place: allowed is a finite number for each of 30"):
        given.save_report(tmp_path / "toy", place=place)
    with pytest.raises(ScenarioError, match="place: allowed is a finite number for each of 30"):
        given.plot.fit(place=place)
    assert not (tmp_path / "toy").exists()
