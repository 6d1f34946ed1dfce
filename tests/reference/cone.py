"""Impulses of several contacts with Coulomb's cone of friction, all of them at once.

For n contacts with impulses p (x, y, normal of each in turn) and velocities u = W p + b find

    0 <= p_n,  u_n >= 0,  p_n u_n = 0,
    |p_t| <= mu p_n,  and where u_t != 0:  p_t = -mu p_n u_t / |u_t|,

that is p = projection(p - rho u) of every contact (Alart and Curnier, 1991). Newton's method on
that equation treats all contacts alike. A rigid body on more corners than it needs leaves part of
the impulses open (four corners that press, two that pull along their edge): they are then those of
the smallest sum of squares, as of equal springs, if every contact is given a compliance that is too
small to move (`COMPLIANCE`, which whoever fills W adds to its diagonal).
"""

import numpy as np
from numba import njit

from .rigid_body import inner

MOST = 8  # contacts
NEWTON_STEPS = 40
SOFTEST = 0.1  # of the mean of a contact's own three elements of W
TOLERANCE = 1e-9  # of the largest impulse
COMPLIANCE = 1e-8  # of the mean of a contact's own three elements of W


@inner
def projected(w, b, mu, n, p, rho, image):
    """projection(p - rho u) of every contact into image (3 n,); returns the largest |image - p|.

    w (3 n, 3 n) is the matrix W in 1/kg, b (3 n,) m/s, mu (n,), p (3 n,) N s, rho (n,) kg.
    """
    distance = 0.0
    for i in range(n):
        k = 3 * i
        ux, uy, un = b[k], b[k + 1], b[k + 2]
        for j in range(3 * n):
            ux += w[k, j] * p[j]
            uy += w[k + 1, j] * p[j]
            un += w[k + 2, j] * p[j]
        yx, yy = p[k] - rho[i] * ux, p[k + 1] - rho[i] * uy
        normal = max(0.0, p[k + 2] - rho[i] * un)
        size, limit = np.sqrt(yx * yx + yy * yy), mu[i] * normal
        share = limit / size if size > limit else 1.0
        image[k], image[k + 1], image[k + 2] = share * yx, share * yy, normal
        for j in range(k, k + 3):
            distance = max(distance, abs(image[j] - p[j]))
    return distance


@inner
def eliminate(matrix, right, count):
    """Gaussian elimination with row exchange, in place: right (count,) becomes the solution."""
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            for j in range(k, count):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            right[k], right[best] = right[best], right[k]
        for i in range(k + 1, count):
            factor = matrix[i, k] / matrix[k, k]
            if factor != 0.0:
                for j in range(k + 1, count):
                    matrix[i, j] -= factor * matrix[k, j]
                right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        for j in range(k + 1, count):
            right[k] -= matrix[k, j] * right[j]
        right[k] /= matrix[k, k]


@inner
def _newton_rows(w, b, mu, n, p, rho, matrix, right):
    """The linear equations of Newton's next p, into matrix (3 n, 3 n) and right (3 n,)."""
    for i in range(n):
        k = 3 * i
        ux, uy, un = b[k], b[k + 1], b[k + 2]
        for j in range(3 * n):
            ux += w[k, j] * p[j]
            uy += w[k + 1, j] * p[j]
            un += w[k + 2, j] * p[j]
        normal = p[k + 2] - rho[i] * un
        for row in range(k, k + 3):
            # Of a closed contact that sticks, rho u = 0; of an open one, p = 0: rows of one size.
            for j in range(3 * n):
                matrix[row, j] = rho[i] * w[row, j] if normal > 0.0 else 0.0
            right[row] = -rho[i] * b[row] if normal > 0.0 else 0.0
            if normal <= 0.0:
                matrix[row, row] = 1.0
        yx, yy = p[k] - rho[i] * ux, p[k + 1] - rho[i] * uy
        size, limit = np.sqrt(yx * yx + yy * yy), mu[i] * normal
        if normal <= 0.0 or size <= limit:
            continue
        # It slips: p_t = mu p_n y / |y|, whose direction turns with y = p_t - rho u_t.
        ex, ey = yx / size, yy / size
        turning, old = limit / size, 0.0
        for j in range(3 * n):
            dx = (1.0 if j == k else 0.0) - rho[i] * w[k, j]
            dy = (1.0 if j == k + 1 else 0.0) - rho[i] * w[k + 1, j]
            across = turning * (ex * dy - ey * dx)
            matrix[k, j] = across * ey
            matrix[k + 1, j] = -across * ex
            old += across * p[j]
        right[k], right[k + 1] = old * ey, -old * ex
        matrix[k, k] += 1.0
        matrix[k + 1, k + 1] += 1.0
        matrix[k, k + 2] -= mu[i] * ex
        matrix[k + 1, k + 2] -= mu[i] * ey


@inner
def largest(values, count):
    """Largest size among the first `count` of some values."""
    result = 0.0
    for i in range(count):
        result = max(result, abs(values[i]))
    return result


@inner
def _copy(source, target, count):
    """Copy the first `count` values."""
    for i in range(count):
        target[i] = source[i]


@inner
def _newton(w, b, mu, n, p, rho, image, matrix, right):
    """Newton's method from p, in place; returns whether it came to an end."""
    for _ in range(NEWTON_STEPS):
        distance = projected(w, b, mu, n, p, rho, image)
        if distance <= TOLERANCE * largest(image, 3 * n):
            _copy(image, p, 3 * n)
            return True
        _newton_rows(w, b, mu, n, p, rho, matrix, right)
        eliminate(matrix, right, 3 * n)
        _copy(right, p, 3 * n)
    return False


@njit(error_model="numpy")
def solve_cone(w, b, mu, n, p, rho, image, matrix, right):
    """Solve for p (3 n,), which begins as a guess.

    image (24,), matrix (24, 24), right (24,): room to work in; see `projected` for the rest.
    Returns 0, or 1 if Newton's method needed softer contacts to begin with, or 2 if that failed
    too and p is what it came to.
    """
    for i in range(n):
        k = 3 * i
        rho[i] = 3.0 / (w[k, k] + w[k + 1, k + 1] + w[k + 2, k + 2])
    if _newton(w, b, mu, n, p, rho, image, matrix, right):
        return 0
    # A face at the limit of its friction: its corners' shares are all but open. Softer contacts
    # leave nothing open, and their answer is a good guess for harder ones.
    for i in range(3 * n):
        p[i] = 0.0
    softness = SOFTEST
    while softness > 0.0:
        for i in range(3 * n):
            w[i, i] += softness / rho[i // 3]
        _newton(w, b, mu, n, p, rho, image, matrix, right)
        for i in range(3 * n):
            w[i, i] -= softness / rho[i // 3]
        softness = 0.1 * softness if softness > COMPLIANCE else 0.0
    return 1 if _newton(w, b, mu, n, p, rho, image, matrix, right) else 2
