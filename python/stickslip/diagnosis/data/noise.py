"""Noise of readings, of any design, by restricted likelihood.

    y = X b + S (Z u + e)

`X` is what the physics may explain freely: a level of each condition, what repeats with an input.
So no model and no cause changes what is estimated (Patterson and Thompson, Biometrika 58 (1971)
545). `S` holds a size for each group of readings, s_k^2 = s0^2 + (rho level_k)^2. Errors e
have variance 1 and, between neighbours in a run, the correlation phi. `Z` are the terms that
readings share, each of which has a size. The logarithms of s0, of rho and of the sizes of the
shared terms, and the probit of phi, have weak normal priors. Sobol draws about the mode of their
posterior, with importance weights, give covariances and their degrees of freedom (Satterthwaite,
Biometrics Bulletin 2 (1946) 110).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import solve_banded
from scipy.optimize import minimize
from scipy.sparse import csr_array, dia_array, hstack, vstack
from scipy.special import ndtr, ndtri
from scipy.stats import chi2 as chi2_law
from scipy.stats import qmc

from stickslip._util.arrays import Array, Indices

Draws = dict[str, Array]
"""Hyperparameters by name, each of shape (draws,)."""

_PRIORS = {"s0": (-0.7, 1.5), "rho": (-2.0, 1.5), "phi": (-1.0, 1.2), "shift": (-1.0, 1.0),
           "gain": (-1.0, 1.0), "period": (-2.5, 2.0)}  # fmt: skip
"""Mean and standard deviation of each coordinate: the logarithms of s0 and of rho at the usual
level over the pooled scatter, the probit of phi, the logarithms of the sizes of shifts and gains in
errors of a reading, and that of what periods share in errors of a period's mean. Chosen:
weak, with mostly equal errors of all readings, and with periods that seldom differ."""

_FARTHEST = 8.0
"""Standard deviations of the priors beyond which the likelihood is not followed. Chosen: far out,
with numbers that a computer has."""

_DRAWS, _TAILS, _WIDER, _FEWEST_DRAWS = 256, 4.0, 1.15, 40.0
"""Number of draws, the degrees of freedom of their law, its width beside that of the posterior at
its mode, and the effective sample below which draws are made again. Chosen: it mostly is half of
the draws, and where it is 40 it tells a mean to a sixth of its error."""

_STRONGEST = 0.9999
"""Correlation of neighbours beyond which a run is one error. Chosen."""

_NODES, _NEGLIGIBLE = 17, 1e-4
"""Correlations at which covariances are computed, and the weight of draws, in the largest, that do
not count for their range. Chosen: variances err by less than a three-hundredth."""

_FREE = 1e-9
"""Precision of the free terms, in that which readings give them: none, and a factor all the same
where readings leave some of them open. Chosen: between rounding and what is estimated."""

_AT_ONCE = 1 << 21  # numbers in memory at a time: 16 MiB; chosen


@dataclass(frozen=True, eq=False)
class Noise:
    """Readings that tell their noise.

    Attributes
    ----------
    y : ndarray, shape (n,)
        Readings, run by run, less a fit of the free terms, in units of the pooled scatter.
    free : csr_array, shape (n, p)
        X. The sizes of the groups must not change what it spans.
    group : ndarray of int, shape (n,)
        Of equal size, numbered from 0.
    freedom : ndarray, shape (groups,)
        Readings of each group less the free terms that they tell.
    gap : ndarray, shape (n,)
        Distance from the reading before; infinite for the first of a run.
    level : ndarray, shape (groups,), optional
        In the usual one; with it errors may grow with the level.
    shared : dict
        By the name of its size: columns of Z, shape (n, q), and the covariance of their u.
    """

    y: Array
    free: csr_array
    group: Indices
    freedom: Array
    gap: Array
    level: Array | None = None
    shared: Mapping[str, tuple[csr_array, Array]] = field(default_factory=dict)

    @cached_property
    def names(self) -> list[str]:
        """Hyperparameters that these readings tell."""
        along = bool(np.any(np.isfinite(self.gap)))
        return ["s0"] + ["rho"] * (self.level is not None) + ["phi"] * along + [*self.shared]

    @property
    def joint(self) -> bool:
        """Whether readings share errors."""
        return "phi" in self.names or bool(self.shared)

    def sizes(self, p: Draws) -> Array:
        """Errors of a reading of each group, shape (draws, groups)."""
        level = np.zeros(len(self.freedom)) if self.level is None else self.level
        rho = np.exp(2.0 * p["rho"])[:, None] if "rho" in p else 0.0
        return np.asarray(np.sqrt(np.exp(2.0 * p["s0"])[:, None] + rho * level**2))

    def draws(self, seed: int) -> tuple[Draws, Array]:
        """Draws of the hyperparameters, and their weights, shape (draws,), of sum 1."""
        centre, width = np.array([_PRIORS[name] for name in self.names]).T
        d = len(self.names)

        def density(h: Array) -> Array:
            """-ln of the posterior, of h of shape (draws, d), in prior standard deviations."""
            values = centre + width * np.clip(h, -_FARTHEST, _FARTHEST)
            loss = self.loss(dict(zip(self.names, values.T, strict=True)))
            return np.asarray(0.5 * loss + 0.5 * np.sum(h**2, axis=1))

        step = 0.05 * np.eye(d)

        def slope(h: Array) -> Array:
            return np.asarray(density(h + step) - density(h - step)) / 0.1

        peak = minimize(lambda h: float(density(h[None])[0]), np.zeros(d), jac=slope, method="BFGS",
                         options={"gtol": 1e-5, "maxiter": 100}).x  # fmt: skip
        curvature = np.array([(slope(peak + move) - slope(peak - move)) / 0.1 for move in step])
        values, axes = np.linalg.eigh(0.5 * (curvature + curvature.T))
        # The prior alone has a curvature of 1.
        spread = _WIDER * axes / np.sqrt(np.maximum(values, 0.5))
        uniform = np.clip(qmc.Sobol(d + 1, seed=seed).random(_DRAWS), 1e-9, 1.0 - 1e-9)
        z = ndtri(uniform[:, :d]) * np.sqrt(_TAILS / chi2_law.ppf(uniform[:, d:], _TAILS))
        for again in (True, False):
            h = peak + z @ spread.T
            log_weight = -density(h) + 0.5 * (_TAILS + d) * np.log1p(np.sum(z**2, axis=1) / _TAILS)
            weight = np.exp(log_weight - np.max(log_weight))
            weight /= np.sum(weight)
            if not again or weight @ weight < 1.0 / _FEWEST_DRAWS:
                break
            # The posterior is no normal law: once more with the moments of its draws.
            peak = weight @ h
            square = (h - peak).T * weight @ (h - peak) + 1e-9 * np.eye(d)
            spread = _WIDER * np.linalg.cholesky(square)
        return dict(zip(self.names, (centre + width * h).T, strict=True)), weight

    def loss(self, p: Draws) -> Array:
        """-2 ln of the restricted likelihood, shape (draws,), but for a constant.

        By Henderson's mixed-model equations, linear in the number of readings: neighbours are
        multiplied once, and a draw weighs their products.
        """
        size = self.sizes(p)
        loss = 2.0 * np.log(size) @ self.freedom
        if not self.joint:
            return np.asarray(loss + size**-2.0 @ np.bincount(self.group, self.y**2, size.shape[1]))
        phi = np.minimum(ndtr(p["phi"]), _STRONGEST) if "phi" in p else np.zeros(len(size))
        gaps, counts, products, precisions = self._equations
        link = phi[:, None] ** gaps
        fresh = 1.0 / (1.0 - link**2)
        loss -= np.log(fresh) @ counts
        weights = np.stack([fresh, -link * fresh, link**2 * fresh], axis=2).reshape(len(size), -1)
        whole = math.isqrt(products.shape[0])
        k, at_once = whole - size.shape[1], max(1, _AT_ONCE // whole**2)
        for rows in np.split(np.arange(len(size)), range(at_once, len(size), at_once)):
            normal = (products @ weights[rows].T).T.reshape(-1, whole, whole)
            inverse = 1.0 / size[rows]
            bordered = np.empty((len(rows), k + 1, k + 1))
            bordered[:, :k, :k] = normal[:, :k, :k]
            for name, part, precision in precisions:
                of = p[name][rows] if name in p else np.zeros(len(rows))
                loss[rows] += 2.0 * len(precision) * of
                bordered[:, part, part] += precision * np.exp(-2.0 * of)[:, None, None]
            bordered[:, -1, :k] = np.einsum("dkg,dg->dk", normal[:, :k, k:], inverse)
            bordered[:, -1, -1] = np.einsum("dg,dgh,dh->d", inverse, normal[:, k:, k:], inverse)
            # Readings without noise leave what rounding makes of the difference.
            bordered[:, -1, -1] *= 1.0 + k * np.finfo(float).eps
            pivots = np.diagonal(np.linalg.cholesky(bordered), axis1=1, axis2=2)
            loss[rows] += 2.0 * np.sum(np.log(pivots[:, :-1]), axis=1) + pivots[:, -1] ** 2
        return np.asarray(loss)

    @cached_property
    def _equations(self) -> tuple[Array, Indices, csr_array, list[tuple[str, slice, Array]]]:
        """Distances, how often each comes, products of columns, and precisions of their sizes.

        Columns are the free and shared terms, and the readings of each group. Their products are
        those of readings a distance after others, with these, and of these, shape (columns^2, 3
        distances).
        """
        groups = (len(self.y), len(self.freedom))
        apart = csr_array((self.y, (np.arange(len(self.y)), self.group)), shape=groups)
        shared = [(name, *each) for name, each in self.shared.items()]
        at = self.free.shape[1]
        least = _FREE * float(self.free.power(2).sum()) / at * np.eye(at)
        precisions = [("", slice(0, at), least)]
        for name, terms, covariance in shared:
            part = slice(at, at := at + terms.shape[1])
            precisions.append((name, part, np.linalg.inv(covariance)))
        columns = hstack([self.free, *(terms for _, terms, _ in shared), apart], format="csr")
        before = vstack([0.0 * columns[:1], columns[:-1]], format="csr")
        gaps, counts = np.unique(self.gap, return_counts=True)
        products = []
        for gap in gaps:
            one, other = (each[self.gap == gap] for each in (columns, before))
            across = one.T @ other
            for product in (one.T @ one, across + across.T, other.T @ other):
                products.append(product.reshape(1, -1))
        return gaps, counts, vstack(products, format="csr").T.tocsr(), precisions


def whitener(gap: Array, phi: float) -> dia_array:
    """The transpose, (n, n), of what makes errors that are correlated along runs independent."""
    link = min(phi, _STRONGEST) ** gap
    size = np.sqrt(1.0 - link**2)
    return dia_array((np.stack([-link / size, 1.0 / size]), [1, 0]), shape=(len(gap),) * 2)


Part = tuple[Array, Array, Array]
"""A covariance, shape (k, k), its factor in each draw, and sizes of its rows, (draws, k)."""


def along(matrix: Array, gap: Array, phi: Array, weight: Array, size: Array) -> list[Part]:
    """Parts of the covariance of ``matrix @ e``, of errors that are correlated along runs.

    It is smooth in phi, so that a few nodes tell it for all draws. `matrix` has the shape (k, n),
    `phi` and `weight` that of the draws, and `size` (draws, k).
    """
    likely = phi[weight > _NEGLIGIBLE * np.max(weight)]
    nodes = np.unique(np.linspace(np.min(likely), np.max(likely), _NODES))
    near = (np.interp(phi, nodes, unit) for unit in np.eye(len(nodes)))
    halves = (solve_banded((0, 1), whitener(gap, node).data, matrix.T) for node in nodes.tolist())
    return [(half.T @ half, share, size) for half, share in zip(halves, near, strict=True)]


def averaged(parts: Sequence[Part], weight: Array) -> tuple[list[Array], float, float]:
    """Means of the parts over draws, the factor of their size, and its degrees of freedom."""
    means = [block * ((size.T * (weight * share)) @ size) for block, share, size in parts]
    inverse = np.linalg.inv(np.sum(means, axis=0)) / len(means[0])
    scale = np.sum(
        [share * np.sum((size @ (inverse * block)) * size, axis=1) for block, share, size in parts],
        axis=0,
    )
    return means, *satterthwaite(scale, weight)


def satterthwaite(scale: Array, weight: Array) -> tuple[float, float]:
    """A size whose draws are `scale`, shape (draws,), and its degrees of freedom.

    By the first two moments of its inverse: of errors with one variance they give the F law. Of the
    size itself they would count four degrees of freedom less, and make it too large.
    """
    inverse = 1.0 / scale
    mean = float(weight @ inverse)
    return 1.0 / mean, 2.0 * mean**2 / max(float(weight @ (inverse - mean) ** 2), 1e-9)
