"""Evidence, forms of the discrepancy, descents and draws beside integrals and dense matrices."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal, multivariate_t

import sliding_block
from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.decision.gain import held_out, measured, parts_of
from stickslip.diagnosis.fitting.descent import derivatives, descend, finished
from stickslip.diagnosis.fitting.forms import forms
from stickslip.diagnosis.fitting.models import covariance_beside
from stickslip.diagnosis.fitting.problem import LOST, Cached, Problem
from stickslip.diagnosis.model import posed
from toys import BEND, LEVEL, SLOPE, STEP, WAVE, data, fitted, problem, shapes

X = np.linspace(1.0, 3.0, 30)


def integral(posed, causes, form, width=7.0, points=49):
    """Log of the integral of likelihood and prior over three coordinates by sums."""
    free = posed.free(causes)
    at = fitted(posed, causes).x
    sd = np.sqrt(np.diag(fitted(posed, causes, at=at).covariance))
    sd = np.where(sd > 0.0, sd, 0.1)  # at the end of a range
    low, high = posed.limits[:, free]
    axes = [
        np.linspace(max(at[k] - width * s, a), min(at[k] + width * s, b), points)
        for k, s, a, b in zip(free, sd, low, high, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(free))
    x = np.zeros((len(grid), posed.size))
    x[:, free] = grid
    density = np.concatenate([
        form.density(posed.residuals(part), np.zeros(0)) for part in np.array_split(x, 10)
    ])  # fmt: skip
    density += -0.5 * np.sum(grid**2, axis=1) - 0.5 * len(free) * math.log(2 * math.pi)
    density += math.log(2.0) * sum(posed.parameters[k].one_sided for k in free)
    weights = np.ones(len(grid))
    for axis, column in zip(axes, grid.T, strict=True):
        # Trapezoids: half a step at the ends, where the density may be cut off.
        step = axis[1] - axis[0]
        weights *= np.where((column == axis[0]) | (column == axis[-1]), 0.5, 1.0) * step
    top = density.max()
    return top + math.log(float(np.sum(np.exp(density - top) * weights)))


@pytest.mark.parametrize(
    ("cause", "extra", "within"),
    # A size that is far from zero, a one-sided one far from and at its end.
    [(WAVE, 0.3, 0.02), (STEP, 0.4, 0.02), (STEP, -0.2, 0.1), (BEND, 0.0, 0.05)],
)
@pytest.mark.daily("cause1", "cause3")
def test_evidence_is_the_integral(cause, extra, within):
    (name,) = (each.name for each in cause.parameters)
    posed = problem(data(extra * shapes(X)[name]), [cause])
    form = forms(posed)["exact"]
    found = fitted(posed, [cause])
    wanted = integral(posed, [cause], form)
    # Laplace's rule is exact but for the curvature of sinh, small beside its width.
    assert found.log_evidence == pytest.approx(wanted, abs=within)


def dense(posed, name, h):
    """Covariance of a form as a matrix."""
    (table,) = posed.tables
    own = np.diag(posed.sd**2) if posed.covariance(0) is None else posed.covariance(0)
    if name == "exact":
        return own
    alike = np.zeros_like(own)
    if name == "ar1":
        span = np.array([np.ptp(table.order[table.run == run]) for run in table.run])
        apart = np.abs(np.subtract.outer(table.order, table.order)) / span[:, None]
        alike = np.where(table.run[:, None] == table.run, np.exp(-apart / math.exp(h[2])), 0.0)
    if name == "slow":  # a process that is mirrored at the ends of its run
        begin, end = ([pick(table.order[table.run == run]) for run in table.run]
                      for pick in (np.min, np.max))  # fmt: skip
        z = (table.order - begin) / np.subtract(end, begin)
        for image in 2.0 * np.arange(-3, 4):
            for apart in (np.subtract.outer(z, z), np.add.outer(z, z)):
                alike += np.exp(-0.5 * (apart + image) ** 2 / math.exp(2.0 * h[2]))
        alike *= table.run[:, None] == table.run
    size = 0.0 if name == "white" else np.median(posed.sd) * math.exp(h[1])
    return math.exp(2 * h[0]) * own + size**2 * alike


def shared_errors(posed):
    """The same problem with an error that all rows share."""
    rows = len(posed.y)
    covariance = 0.01 * np.eye(rows) + 0.02 * np.ones((rows, rows))
    return replace(posed, errors=(Errors(np.sqrt(np.diag(covariance)), covariance),))


# Beside shared errors ar1 is not offered.
@pytest.mark.parametrize(
    ("name", "shared"),
    [*itertools.product(("exact", "white"), (False, True)), ("ar1", False),
     ("slow", False)],
)  # fmt: skip
def test_densities_are_those_of_the_dense_matrix(name, shared):
    known = {"run": np.repeat([0, 1], [12, 18])} if name in ("ar1", "slow") else {}
    table = data(sd=np.linspace(0.05, 0.2, 30), **known)
    if known:
        table.order = table.order + np.where(table.order > 20, 3.5, 0.0)  # a gap
    posed = shared_errors(problem(table)) if shared else problem(table)
    form = forms(posed, [name])[name]
    h = np.array([0.3, 0.8, math.log(0.07 if name == "ar1" else 0.8)])[: len(form.names)]
    covariance = dense(posed, name, h)
    residual = np.random.default_rng(1).standard_normal((3, 30))
    law = multivariate_normal(np.zeros(30), covariance)
    assert form.density(residual, h) == pytest.approx(law.logpdf(residual), rel=1e-8)
    columns = np.random.default_rng(2).standard_normal((30, 4))
    wanted = columns.T @ np.linalg.solve(covariance, columns)
    assert form.gram(form.prepared(columns), h) == pytest.approx(wanted, rel=1e-7)


@pytest.mark.parametrize(("waves", "wider"), [(0.7, 1.8), (40.0, 1.0)])
def test_a_slow_rest_leaves_more_of_a_size_open_and_a_fast_one_does_not(waves, wider):
    error = 0.5 * np.sin(2.0 * np.pi * waves * (X - 1.0) / 2.0 + 1.0)
    posed = problem(data(0.6 * np.sin(5.0 * X) + error, run=np.zeros(30)), [WAVE])
    fit = fitted(posed, [WAVE], "ar1")
    whole = covariance_beside(posed, fit)
    # An upper bound of the fit's own, in all directions.
    assert np.linalg.eigvalsh(whole - fit.covariance).min() > -1e-9
    assert np.sqrt(whole[-1, -1] / fit.covariance[-1, -1]) == pytest.approx(wider, abs=0.3)
    exact = fitted(posed, [WAVE])
    assert covariance_beside(posed, exact) is exact.covariance


def test_estimated_errors_have_students_law():
    # Of two tables, each with its own size and degrees of freedom.
    known = ((30, 0.1, 7.0), (12, 0.3, 5.0))
    tables = tuple(data(n=rows, sd=sd) for rows, sd, _ in known)
    errors = tuple(Errors(np.full(rows, sd), dof=dof) for rows, sd, dof in known)
    posed = Problem(tables, lambda values: np.zeros((len(values), 42)), ())
    form = forms(replace(posed, errors=errors))["exact"]
    residual = 0.2 * np.random.default_rng(1).standard_normal((2, 42))
    parts = np.split(residual, [30], axis=1)
    laws = [multivariate_t(np.zeros(rows), sd**2 * np.eye(rows), dof) for rows, sd, dof in known]
    wanted = sum(law.logpdf(part) for law, part in zip(laws, parts, strict=True))
    assert form.density(residual, np.zeros(0)) == pytest.approx(wanted, rel=1e-9)


def broken(change):
    """The line, with rows that a function of the slope and of what is made spoils."""
    table = data()

    def model(values):
        made = values[:, :1] * table["x"] + values[:, 1:2]
        change(values[:, 0], made)
        return made

    return Problem((table,), Cached(model), (SLOPE, LEVEL))


def test_a_jump_is_no_slope():
    # A row jumps by 30 errors as the slope passes 1.02.
    def jump(slope, made):
        made[:, 7] += np.where(slope > 1.02, 3.0, 0.0)

    posed = broken(jump)
    x = np.array([(1.02 - 1e-4 - 1.0) / 0.1, 0.0])  # just below it
    slopes = finished(posed, derivatives(posed, x, np.arange(2), posed.residuals(x[None, :])[0]))[
        :, 0
    ]
    assert np.delete(slopes, 7) == pytest.approx(0.1 * np.delete(posed.tables[0]["x"], 7), rel=1e-6)
    assert abs(slopes[7]) < 1.0  # 3 / 0.03 = 100 across the jump


def test_a_lost_row_does_not_stop_the_others():
    def lose(_, made):
        made[:, 3], made[:, 4] = np.nan, 1e200

    posed = broken(lose)
    end = finished(posed, descend(posed, forms(posed)["exact"], np.zeros(0), (), np.zeros(2)))
    assert end.residual[3:5] == pytest.approx(LOST * posed.sd[3:5])
    kept, (table,) = np.delete(np.arange(30), [3, 4]), posed.tables
    alone = problem(Table({"x": table["x"][kept]}, table.y[kept], sd=0.1), [])
    assert end.x == pytest.approx(fitted(alone).x, abs=1e-3)


@pytest.mark.parametrize("name", ["exact", "white", "ar1"])
@pytest.mark.parametrize("count", [1, 30])
def test_a_lost_row_has_the_same_price_in_every_form(name, count):
    """A constant residual along a run would be nearly free as a correlated error."""
    known = {"run": np.zeros(30, dtype=int)} if name == "ar1" else {}
    posed = problem(data(sd=np.linspace(0.05, 0.2, 30), **known))
    posed = replace(posed, errors=tuple(replace(one, dof=9.0) for one in posed.errors))
    form = forms(posed)[name]
    h = form.limits()[3] if form.names else np.zeros(0)
    some, alone = 0.1 * np.random.default_rng(1).standard_normal((2, 1, 30))
    some[0, :count], alone[0] = LOST * posed.sd[:count], some[0]
    alone[0, :count] = 0.0
    assert form.cost(some, h) - form.cost(alone, h) == pytest.approx(count * LOST**2)


def test_held_out_errors_are_those_of_refits():
    posed = problem(data(0.3 * np.sin(5.0 * X)), [WAVE])
    found = fitted(posed, [WAVE])
    parts = parts_of(posed)
    errors = held_out(posed, found, parts)
    covariance = dense(posed, "exact", found.h)
    for rows in parts[:3]:
        kept = np.setdiff1d(np.arange(30), rows)
        weight = np.linalg.inv(covariance[np.ix_(kept, kept)])
        slopes = found.slopes[kept]
        curvature = slopes.T @ weight @ slopes + found.precision
        downhill = slopes.T @ weight @ found.residual[kept] - found.precision @ found.x
        moved = found.x + np.linalg.solve(curvature, downhill)
        wanted = found.residual[rows] - found.slopes[rows] @ (moved - found.x)
        assert errors[rows] == pytest.approx(wanted, abs=1e-8)
    assert np.concatenate(parts).tolist() == list(range(30))


def test_a_refit_that_meets_the_end_of_a_range_moves_the_rest():
    # Friction and the law are a product: where one meets its end, the other has to make up for it.
    law, sd = sliding_block.OVER_SPEED, sliding_block.SD
    hidden, at = sliding_block.HIDDEN[law]
    table = Table(sliding_block.SETTINGS, sliding_block.measured(0, 1.0 + hidden(at)), sd=sd)
    block = posed(table, sliding_block.push, sliding_block.UNCERTAIN, sliding_block.LAWS)
    (law,) = (each for each in block.causes if each.name == law.name)
    null, found = (fitted(block, causes) for causes in ([], [law]))
    missed = np.abs(held_out(block, found, parts_of(block))) / block.sd
    # Of a right model about sqrt(2 / pi), and more at the ends of a law that is known by its data.
    assert np.mean(missed) < 1.6
    assert measured(block, null, found).certain
