#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/field/coil_set.hpp"

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace stickslip;

namespace {

const Matrix3d kMirrorX = Vector3d(-1.0, 1.0, 1.0).asDiagonal();

std::vector<Vector3d> random_points(double half_width, int count) {
    std::mt19937_64 generator(20080625);
    std::uniform_real_distribution<double> coordinate(-half_width, half_width);
    std::vector<Vector3d> points;
    for (int i = 0; i < count; ++i) {
        const double x = coordinate(generator);
        const double y = coordinate(generator);
        points.emplace_back(x, y, coordinate(generator));
    }
    return points;
}

Matrix3d central_differences(const CoilSet& coils, Coil coil, const Vector3d& point, double step) {
    Matrix3d gradient;
    for (int j = 0; j < 3; ++j) {
        const Vector3d offset = step * Vector3d::Unit(j);
        gradient.col(j) = (coils.unit_field(coil, point + offset).field -
                           coils.unit_field(coil, point - offset).field) /
                          (2.0 * step);
    }
    return gradient;
}

}  // namespace

TEST_CASE("field at the centre: closed form on the axis, along the positive axis for every coil") {
    const CoilSet coils;
    // Each of four wires of half-length a, at rho^2 = c^2 + a^2 from the axis, with its ends at
    // R^2 = c^2 + 2 a^2, adds a * 2 a / (rho^2 R): 8 a^2 / (rho^2 R) in all.
    const double a = 0.5 * 0.1385;
    const double c = 0.099;
    const double rho2 = c * c + a * a;
    const double r = std::sqrt(c * c + 2.0 * a * a);
    const double expected = 1e-7 * 510.0 * 8.0 * a * a / (rho2 * r);
    CHECK(expected == doctest::Approx(0.96258e-3).epsilon(5e-6));  // five digits given

    const int axis_of[] = {0, 0, 1, 1, 2};
    for (const Coil coil : kAllCoils) {
        const int axis = axis_of[static_cast<int>(coil)];
        const Vector3d field = coils.unit_field(coil, Vector3d::Zero()).field;
        // About 20 roundings of 1.1e-16 each stand between the two.
        CHECK(field[axis] == doctest::Approx(expected).epsilon(2e-15));
        CHECK(field[(axis + 1) % 3] == 0.0);
        CHECK(field[(axis + 2) % 3] == 0.0);
    }
    CHECK(coils.centre_field_per_ampere() == coils.unit_field(Coil::xp, Vector3d::Zero()).field[0]);
}

TEST_CASE("gradient agrees with central differences of the field") {
    const CoilSet coils;
    // Truncation: step^2 / 6 * B''' <= step^2 * B / d^3, where d >= 3 cm is the distance from the
    // nearest wire; rounding: 1e-15 * B / step. Together below 5e-9 B / d at step = 1e-6 m, and
    // a factor of four stands for the constants.
    const double step = 1e-6;
    for (const Vector3d& point : random_points(0.035, 40)) {
        for (const Coil coil : kAllCoils) {
            const FieldAndGradient at = coils.unit_field(coil, point);
            const Matrix3d difference = at.gradient - central_differences(coils, coil, point, step);
            CHECK(difference.norm() < 2e-8 * at.field.norm() / 0.03);
        }
    }
}

TEST_CASE("the field itself has neither divergence nor curl") {
    const CoilSet coils;
    for (const Vector3d& point : random_points(0.035, 40)) {
        for (const Coil coil : kAllCoils) {
            // From differences of the field: the analytic gradient has both by construction.
            const Matrix3d numeric = central_differences(coils, coil, point, 1e-6);
            const double tolerance = 2e-8 * coils.unit_field(coil, point).field.norm() / 0.03;
            CHECK(std::abs(numeric.trace()) < tolerance);
            CHECK((numeric - numeric.transpose()).norm() < 2.0 * tolerance);
        }
    }
}

TEST_CASE("opposite coils are mirror images to the last bit") {
    const CoilSet coils;
    for (const Vector3d& point : random_points(0.06, 200)) {
        const FieldAndGradient plus = coils.unit_field(Coil::xp, point);
        const FieldAndGradient minus = coils.unit_field(Coil::xm, kMirrorX * point);
        // B is an axial vector: mirrored in x it keeps its x and turns its y and z.
        CHECK(minus.field == -(kMirrorX * plus.field));
        CHECK(minus.gradient == -(kMirrorX * plus.gradient * kMirrorX));
    }
}

TEST_CASE("a quarter turn about z takes the x coil to the y coil to the last bit") {
    const CoilSet coils;
    Matrix3d turn;
    turn << 0.0, -1.0, 0.0,  //
        1.0, 0.0, 0.0,       //
        0.0, 0.0, 1.0;
    for (const Vector3d& point : random_points(0.06, 200)) {
        const FieldAndGradient x = coils.unit_field(Coil::xp, point);
        const FieldAndGradient y = coils.unit_field(Coil::yp, turn * point);
        CHECK(y.field == turn * x.field);
        CHECK(y.gradient == turn * x.gradient * turn.transpose());
    }
}

TEST_CASE("on the prolongation of a wire field and gradient stay finite and continuous") {
    const double a = 0.06925;
    // Past the end, on the line, and at distances where the printed form has lost all digits.
    const FieldAndGradient on = square_coil_field(a, {0.0, a, a + 0.02});
    for (const double offset : {1e-15, 1e-12, 1e-9, 1e-7}) {
        const FieldAndGradient beside = square_coil_field(a, {offset, a, a + 0.02});
        const Vector3d predicted = on.field + on.gradient.col(0) * offset;
        // An end's field falls as 1/d^2, so half its second derivative is 3 B / d^2; d = 2 cm.
        const double second_order = 3.0 * offset * offset / (0.02 * 0.02);
        CHECK((beside.field - predicted).norm() < (1e-14 + second_order) * on.field.norm());
        CHECK((beside.gradient - on.gradient).norm() <
              (1e-14 + 10.0 * offset / 0.02) * on.gradient.norm());
    }
}

TEST_CASE("both forms of a wire's factor agree at the wire's end") {
    const double a = 0.06925;
    const double above = std::nextafter(a, 1.0);
    for (const double u : {1e-3, 0.03, 0.1}) {
        const FieldAndGradient beside = square_coil_field(a, {u, 0.01, a});
        const FieldAndGradient past = square_coil_field(a, {u, 0.01, above});
        CHECK((beside.field - past.field).norm() < 1e-13 * beside.field.norm());
        CHECK((beside.gradient - past.gradient).norm() < 1e-13 * beside.gradient.norm());
    }
}

TEST_CASE("a point on a wire is an error that names the point and the coil") {
    const CoilSet coils;
    const double a = 0.06925;
    const Vector3d on_wire(0.099, a, 0.01);
    CHECK_THROWS_WITH_AS(
        coils.unit_field(Coil::xp, on_wire),
        "point (0.099, 0.06925, 0.01) m lies on the wire of coil xp, where the field is infinite",
        std::domain_error);
    CHECK_THROWS_AS(coils.unit_field(Coil::xp, on_wire + Vector3d(0.9e-9, 0.0, 0.0)),
                    std::domain_error);
    CHECK_THROWS_AS(coils.unit_field(Coil::xp, Vector3d(0.099, a, a)), std::domain_error);
    CHECK_NOTHROW(coils.unit_field(Coil::xp, on_wire + Vector3d(1.1e-9, 0.0, 0.0)));
    CHECK_NOTHROW(coils.unit_field(Coil::xp, Vector3d(0.099, a, a + 2e-9)));
    CHECK_NOTHROW(coils.unit_field(Coil::xm, on_wire));
}

TEST_CASE("superposition, in which a coil without current takes no part") {
    const CoilSet coils;
    Currents currents;
    currents << 1.5, -0.5, 0.25, 2.0, -3.0;
    const Vector3d point(1e-3, -2e-3, 3e-3);
    Vector3d field = Vector3d::Zero();
    Matrix3d gradient = Matrix3d::Zero();
    for (const Coil coil : kAllCoils) {
        const double current = currents[static_cast<int>(coil)];
        field += current * coils.unit_field(coil, point).field;
        gradient += current * coils.unit_field(coil, point).gradient;
    }
    const FieldAndGradient total = coils.field(point, currents);
    CHECK(total.field == field);
    CHECK(total.gradient == gradient);

    const Vector3d on_wire_of_xp(0.099, 0.06925, 0.0);
    currents[0] = 0.0;
    CHECK(coils.field(on_wire_of_xp, currents).field.allFinite());
    currents[0] = 1.0;
    CHECK_THROWS_AS(coils.field(on_wire_of_xp, currents), std::domain_error);
}

TEST_CASE("impossible geometry is refused with the value's name") {
    CHECK_THROWS_WITH_AS(CoilSet({.side = -1.0}),
                         "coil side (m) must be positive and finite, got -1",
                         std::invalid_argument);
    CHECK_THROWS_AS(CoilSet({.distance = 0.0}), std::invalid_argument);
    CHECK_THROWS_AS(CoilSet({.turns = std::numeric_limits<double>::quiet_NaN()}),
                    std::invalid_argument);
}
