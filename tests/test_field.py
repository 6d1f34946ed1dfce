"""The coil field against two other ways to compute it, and its symmetries and limits."""

import itertools
import re

import magpylib
import numpy as np
import pytest

from stickslip import COIL_NAMES, Coils

HALF = 0.1385 / 2
DISTANCE = 0.099
TURNS = 510
MU_0 = 4e-7 * np.pi

# Corners of each coil in the order in which positive current runs, so that the field at the
# centre is along the positive axis.
_SQUARE = HALF * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]])
CORNERS = {
    "xp": np.insert(_SQUARE, 0, DISTANCE, axis=1),
    "xm": np.insert(_SQUARE, 0, -DISTANCE, axis=1),
    "yp": np.insert(_SQUARE[:, ::-1], 1, DISTANCE, axis=1),
    "ym": np.insert(_SQUARE[:, ::-1], 1, -DISTANCE, axis=1),
    "clamp": np.insert(_SQUARE, 2, -DISTANCE, axis=1),
}


def unit_current(coil):
    return np.eye(5)[COIL_NAMES.index(coil)]


def points_in_cube(side, count, seed=1):
    return np.random.default_rng(seed).uniform(-side / 2, side / 2, (count, 3))


def biot_savart(coil, point, nodes=120):
    """Equation (2) at 1 A by Gauss-Legendre quadrature; takes complex coordinates.

    The integrand is singular in the complex plane at a distance d (that of the point from the
    wire), so the error falls as (s + sqrt(1 + s^2))^(-2 nodes) with s = d / HALF: below rounding
    for d >= 2 cm.
    """
    abscissa, weight = np.polynomial.legendre.leggauss(nodes)
    field = np.zeros(3, dtype=np.result_type(point))
    corners = CORNERS[coil]
    for start, end in itertools.pairwise(corners):
        wire = start + np.outer((abscissa + 1) / 2, end - start)
        to_point = point - wire
        cubed = np.sum(to_point * to_point, axis=1) ** 1.5  # no conjugate: analytic
        field += np.sum((weight / 2 / cubed)[:, None] * np.cross(end - start, to_point), axis=0)
    return MU_0 * TURNS / (4 * np.pi) * field


def complex_step(function, point):
    """dB_i / dx_j to rounding: the imaginary part of a step too small to have a second order."""
    step = 1e-30
    columns = [function(point + 1j * step * axis).imag / step for axis in np.eye(3)]
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("coil", COIL_NAMES)
def test_field_agrees_with_magpylib(coil):
    # Asked for H, because magpylib's mu_0 is the measured one, 1.3e-10 from 4 pi 1e-7. In twice
    # the 10 cm cube a point can come near a wire's line, where magpylib's sines lose digits;
    # 1e-10 leaves them six.
    points = points_in_cube(0.2, 1000)
    peer = magpylib.current.Polyline(vertices=CORNERS[coil], current=TURNS)
    expected = MU_0 * peer.getH(points)
    error = np.linalg.norm(Coils().field(points, unit_current(coil)) - expected, axis=1)
    assert np.max(error / np.linalg.norm(expected, axis=1)) < 1e-10


def check_by_quadrature(coil, point):
    # 480 terms of both signs, and nodes known to 1e-15: some hundred roundings, and for the
    # gradient ten times that.
    field = biot_savart(coil, point)
    gradient = complex_step(lambda at: biot_savart(coil, at), point)
    got_field = Coils().field(point, unit_current(coil))
    got_gradient = Coils().gradient(point, unit_current(coil))
    assert np.linalg.norm(got_field - field) < 1e-13 * np.linalg.norm(field)
    assert np.linalg.norm(got_gradient - gradient) < 1e-12 * np.linalg.norm(gradient)


@pytest.mark.parametrize("coil", COIL_NAMES)
def test_field_and_gradient_agree_with_quadrature(coil):
    for point in points_in_cube(0.1, 20, seed=2):
        check_by_quadrature(coil, point)


@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-8, 1e-4])
@pytest.mark.parametrize("end", [1, -1])
def test_on_the_prolongation_of_a_wire(offset, end):
    # The formula as it is printed is 0/0 here and has lost all digits beside it.
    check_by_quadrature("xp", np.array([DISTANCE + offset, HALF, end * (HALF + 0.02)]))


def test_field_close_to_a_wire_is_that_of_a_straight_wire():
    # 1 um from the middle of a wire: mu_0 N I / (2 pi d), and the rest of the coil adds about
    # that at 0.1 m, 1e-5 of it.
    point = [DISTANCE + 1e-6, HALF, 0.0]
    field = np.linalg.norm(Coils().field(point, unit_current("xp")))
    assert field == pytest.approx(MU_0 * TURNS / (2 * np.pi * 1e-6), rel=5e-5)


def test_centre_field_per_ampere():
    coils = Coils()
    # On the axis four wires at the distance rho add up to 2 mu_0 N a^2 / (pi rho^2 R).
    rho2 = DISTANCE**2 + HALF**2
    expected = 2 * MU_0 * TURNS * HALF**2 / (np.pi * rho2 * np.sqrt(rho2 + HALF**2))
    assert expected == pytest.approx(0.96258e-3, abs=5e-9)  # five digits are given
    assert coils.centre_field_per_ampere == pytest.approx(expected, rel=2e-15)
    assert 6.5e-3 / coils.centre_field_per_ampere == pytest.approx(6.753, abs=5e-4)
    axes = {"xp": 0, "xm": 0, "yp": 1, "ym": 1, "clamp": 2}
    for coil in COIL_NAMES:
        at_centre = coils.field([0, 0, 0], unit_current(coil))
        assert np.array_equal(at_centre, coils.centre_field_per_ampere * np.eye(3)[axes[coil]])


def test_gradient_is_symmetric_without_trace():
    gradient = Coils().gradient(points_in_cube(0.1, 100), [1.0, -2.0, 0.5, 0.3, -1.0])
    size = np.linalg.norm(gradient, axis=(1, 2))
    assert np.array_equal(gradient, np.swapaxes(gradient, 1, 2))
    assert np.all(np.abs(np.trace(gradient, axis1=1, axis2=2)) < 4 * np.finfo(float).eps * size)


def test_opposite_coils_are_exact_mirror_images():
    coils = Coils()
    points = points_in_cube(0.1, 500)
    mirror = np.array([-1.0, 1.0, 1.0])
    plus = coils.field(points, unit_current("xp"))
    minus = coils.field(points * mirror, unit_current("xm"))
    assert np.array_equal(minus, -mirror * plus)  # an axial vector keeps x and turns y and z
    plus_gradient = coils.gradient(points, unit_current("xp"))
    minus_gradient = coils.gradient(points * mirror, unit_current("xm"))
    assert np.array_equal(minus_gradient, -np.outer(mirror, mirror) * plus_gradient)


@pytest.mark.parametrize("coil", ["xp", "clamp"])
@pytest.mark.parametrize(("side", "worst"), [(0.025, 0.1213), (0.005, 0.0235)])
def test_fringe_field_in_a_cube(coil, side, worst):
    # Section IV-B states less than 2.5 % for the 2.5 cm cube. The largest fringe component over
    # the main one, which is met at a corner, is 12 % there, and below 2.5 % in a 5 mm cube.
    grid = np.linspace(-side / 2, side / 2, 11)
    points = np.stack(np.meshgrid(grid, grid, grid), axis=-1)
    field = np.abs(Coils().field(points, unit_current(coil)))
    main = 0 if coil == "xp" else 2
    fringe = np.delete(field, main, axis=-1) / field[..., [main]]
    assert fringe.max() == pytest.approx(worst, abs=1e-4)
    assert np.unravel_index(fringe.argmax(), fringe.shape)[0] in (0, 10)


def test_turns_and_size_scale_as_they_must():
    # B is proportional to N / length, and its gradient to N / length^2; powers of two are exact.
    points = points_in_cube(0.02, 20)
    currents = [1.0, 2.0, 3.0, 4.0, 5.0]
    small, large = Coils(), Coils(side=0.1385 * 2, distance=DISTANCE * 2, turns=TURNS * 4)
    assert np.array_equal(2 * small.field(points, currents), large.field(2 * points, currents))
    assert np.array_equal(small.gradient(points, currents), large.gradient(2 * points, currents))


@pytest.mark.parametrize(
    ("points_shape", "currents_shape", "shape"),
    [
        ((3,), (5,), ()),
        ((7, 3), (5,), (7,)),
        ((3,), (7, 5), (7,)),
        ((7, 3), (7, 5), (7,)),
        ((4, 1, 3), (6, 5), (4, 6)),
        ((2, 3, 4, 3), (5,), (2, 3, 4)),
        ((0, 3), (5,), (0,)),
        ((4, 3), (1, 5), (4,)),
    ],
)
def test_shapes_broadcast(points_shape, currents_shape, shape):
    random = np.random.default_rng(3)
    points = random.uniform(-0.01, 0.01, points_shape)
    currents = random.uniform(-1, 1, currents_shape)
    coils = Coils()
    field, gradient = coils.field(points, currents), coils.gradient(points, currents)
    assert field.shape == (*shape, 3)
    assert gradient.shape == (*shape, 3, 3)
    all_points = np.broadcast_to(points, (*shape, 3))
    all_currents = np.broadcast_to(currents, (*shape, 5))
    for index in np.ndindex(shape):
        assert np.array_equal(field[index], coils.field(all_points[index], all_currents[index]))
        one = coils.gradient(all_points[index], all_currents[index])
        assert np.array_equal(gradient[index], one)


def test_strided_and_integer_input():
    coils = Coils()
    table = points_in_cube(0.01, 12).reshape(6, 6)
    strided = table[::2, ::2]
    assert np.array_equal(
        coils.field(strided, [1, 0, 0, 0, 2]), coils.field(strided.copy(), [1.0, 0, 0, 0, 2.0])
    )


@pytest.mark.parametrize("method", ["field", "gradient"])
@pytest.mark.parametrize(
    ("points", "currents", "message"),
    [
        ([0, 0], [0] * 5, "points of shape (2,): allowed is shape (..., 3)"),
        (0.0, [0] * 5, "points of shape (): allowed is shape (..., 3)"),
        ([0, 0, 0], [0] * 4, "currents of shape (4,): allowed is shape (..., 5)"),
        ([[0] * 3] * 2, [[0] * 5] * 3, "points of shape (2, 3) and currents of shape (3, 5)"),
        ([[0, 0, 0], [0, np.nan, 0]], [0] * 5, "points[1, 1] = nan: allowed is"),
        ([0, 0, 0], [0, 0, 0, 0, np.inf], "currents: row 4 = inf: allowed is"),
        ([0.099, 0.06925, 0.01], [1, 0, 0, 0, 0], "point (0.099, 0.06925, 0.01) m lies on the"),
        ([DISTANCE + 0.9e-9, HALF, HALF], [1, 0, 0, 0, 0], "point ("),
    ],
)
def test_bad_input_is_refused_by_name(method, points, currents, message):
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        getattr(Coils(), method)(points, currents)


@pytest.mark.parametrize("parameter", ["side", "distance", "turns"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_impossible_coils_are_refused(parameter, value):
    with pytest.raises(ValueError, match=f"coil {parameter}.* must be positive and finite"):
        Coils(**{parameter: value})


def test_the_field_beside_a_wire_or_on_one_without_current_is_finite():
    on_wire_of_xp = [DISTANCE, HALF, 0.01]
    assert np.isfinite(Coils().field(on_wire_of_xp, unit_current("xm"))).all()
    for beside in ([DISTANCE + 1.1e-9, HALF, 0.01], [DISTANCE, HALF, HALF + 2e-9]):
        assert np.isfinite(Coils().field(beside, unit_current("xp"))).all()
