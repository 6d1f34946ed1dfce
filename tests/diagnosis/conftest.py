"""Diagnoses of toy models that several files look at."""

import pytest

import made_findings as made


@pytest.fixture(scope="session")
def named():
    """One cause, and errors as stated."""
    return made.with_pairs(made.toy(made.TRUTH))


@pytest.fixture(scope="session")
def none():
    """No cause."""
    return made.toy((1.1, 1.9, 0.0, 0.0, 0.0))


@pytest.fixture(scope="session")
def rough():
    """One cause, and scatter that is no cause: a report of it has every number."""
    return made.with_pairs(made.toy(made.TRUTH, error=0.12))
