"""Every effect of `effect_table.py` in every way of `ways_to_run.py`."""

import functools

import pytest

import effect_table
from effect_table import OWN, Case, Table, rows
from own_effects import unregister
from ways_to_run import TWO_PROGRAMS, WAYS

table_of = functools.cache(Table)


@pytest.fixture(scope="module", autouse=True)
def own_rows():
    """Effects of the user are rows too."""
    effect_table.register_own_effects()
    yield
    table_of.cache_clear()
    for name in OWN:
        unregister(name)


by_choice = pytest.mark.parametrize("choice", ["singles", "pairs", "all"])


@by_choice
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.daily("batch-singles", "swept-singles", "stepped-singles", "in both planes-singles")
def test_effects_alone_and_in_pairs_act_alike_in_each_way_to_run(way, choice):
    assert [*WAYS[way](table_of(choice))] == []


def test_every_effect_acts_on_a_drive_of_the_table():
    """Ten times as much as two programs may differ, so that leaving it out would be seen."""
    table = table_of("singles")
    acting = {case.effects[0] for case in table.cases if case.effects and acts(table, case)}
    assert acting >= set(rows())


def test_what_acts_in_one_plane_acts_in_the_whole_plane_too():
    """On drives that are simulated in both, so that an effect that one of them lost is seen."""
    table = table_of("singles")
    pushed = [case for case in table.cases if case.push and case.effects and acts(table, case)]
    planar = {
        case.effects[0]
        for case in table.cases
        if case.effects
        and not case.scenario.whole_plane
        and acts(table, case)
        # What shakes is refused in the whole plane.
        and not any(key.startswith(("shake.", "inner.")) for key in case.keys)
    }
    assert {case.effects[0] for case in pushed} == planar - set(OWN)


@by_choice
@pytest.mark.daily("singles")
def test_every_run_of_the_table_comes_to_its_end(choice):
    table = table_of(choice)
    status = {str(case): table.alone[case].status for case in table.cases}
    assert {case: said for case, said in status.items() if said != "ok"} == {}


def acts(table, case):
    run, plain = table.alone[case], table.alone[Case((), case.drive, case.push)]
    limit = 10.0 * TWO_PROGRAMS
    if abs(run.mean_velocity - plain.mean_velocity) > limit * table.scale(case.drive):
        return True
    angles = ("theta_min", "theta_max")
    return any(abs(run.summary()[name] - plain.summary()[name]) > limit for name in angles)
