#include "stickslip/field/field_map.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "stickslip/field/expansion.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double kUnitField = 9.6e-4;  // T/A, of a coil of Table I at the centre

const Box kBox = {{-0.01, -0.006, -0.002}, {0.014, 0.008, 0.01}};

// Any numbers are a field that obeys Maxwell's equations; each degree is `fall` times the one
// before.
FieldMap any_map(Random& random, const Box& box, std::size_t degree, double fall = 1.0) {
    PerCoilOf<std::vector<double>> coefficients;
    for (auto& own : coefficients) {
        for (std::size_t l = 1; l <= degree; ++l) {
            const double size = kUnitField * std::pow(fall, static_cast<double>(l - 1));
            while (own.size() < FieldMap::count(l)) own.push_back(size * random.between(-1.0, 1.0));
        }
    }
    return {box, coefficients};
}

Vector3d any_point(Random& random, const Box& box) {
    Vector3d point;
    for (Eigen::Index i = 0; i < 3; ++i) point[i] = random.between(box.low[i], box.high[i]);
    return point;
}

}  // namespace

TEST_CASE("field map: the gradient is that of the field, without divergence and rotation") {
    Random random(1);
    for (std::size_t degree = 1; degree <= FieldMap::kMostDegree; ++degree) {
        const FieldMap map = any_map(random, kBox, degree);
        for (int n = 0; n < 50; ++n) {
            const Coil coil = kAllCoils[static_cast<std::size_t>(random.integer(0, 4))];
            const Vector3d point = any_point(random, kBox);
            const FieldAndGradient found = map.unit_field(coil, point);
            CHECK(found.gradient == found.gradient.transpose());
            CHECK(std::abs(found.gradient.trace()) <=
                  4.0 * kRounding * found.gradient.cwiseAbs().maxCoeff());
            // Central differences err by step^2/6 of the third derivative, (degree/radius)^2 of the
            // gradient's size at the most, and by rounding over the step.
            constexpr double kStep = 1e-5;
            Matrix3d differences;
            for (Eigen::Index k = 0; k < 3; ++k) {
                Vector3d offset = Vector3d::Zero();
                offset[k] = kStep;
                differences.col(k) = (map.unit_field(coil, point + offset).field -
                                      map.unit_field(coil, point - offset).field) /
                                     (2.0 * kStep);
            }
            const double radius = 0.5 * (kBox.high - kBox.low).norm();
            const double part = static_cast<double>(degree) * kStep / radius;
            const double size = 5.0 * kUnitField / radius;
            CHECK((differences - found.gradient).cwiseAbs().maxCoeff() <=
                  part * part * size + 10.0 * kRounding * 5.0 * kUnitField / kStep);
        }
    }
}

TEST_CASE("field map: the first harmonics are a uniform field and the two simplest gradients") {
    // R_10 = z, R_11 = (x + iy)/2, R_20 = (2 z^2 - x^2 - y^2)/4, R_21 = z (x + iy)/2 of u.
    const std::vector<Vector3d> points = {{0.003, 0.002, 0.001}};
    const std::vector<double> fields = harmonic_fields(kBox, 2, points);
    const Vector3d u =
        (points[0] - 0.5 * (kBox.low + kBox.high)) / (0.5 * (kBox.high - kBox.low).norm());
    const std::size_t count = FieldMap::count(2);
    const double expected[3][5] = {{0.0, 0.5, 0.0, -0.5 * u.x(), 0.5 * u.z()},
                                   {0.0, 0.0, 0.5, -0.5 * u.y(), 0.0},
                                   {1.0, 0.0, 0.0, u.z(), 0.5 * u.x()}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t k = 0; k < 5; ++k) {
            CHECK(fields[axis * count + k] == doctest::Approx(expected[axis][k]).epsilon(1e-14));
        }
    }
}

TEST_CASE("field map: the field near the robot is that of the map") {
    // Fourth order in (reach + 0.1 mm) over the distance of the wires, as without a map: half the
    // diagonal is a twentieth of that.
    Random random(4);
    const Box box = {{-0.004, -0.002, -0.002}, {0.004, 0.002, 0.002}};
    const auto map = std::make_shared<const FieldMap>(any_map(random, box, 6, 0.05));
    const CoilSet coils({}, map);
    LocalField field(coils, all_driven());
    CHECK(field.reach() < LocalField::kReach);  // 1 % of half the diagonal of 9.8 mm
    CHECK(field.reach() == doctest::Approx(4.9e-5).epsilon(1e-3));
    const PerCoil currents = {1.0, -0.4, 0.3, 0.8, -0.6};
    field.set_segment(steady(currents));
    for (int n = 0; n < 200; ++n) {
        const double x = random.between(-0.0039, 0.0039), z = random.between(-0.0019, 0.0019);
        field.rebase({x, z});
        const PlanarField found = field.at(0.5)(x, z);
        FieldAndGradient full{Vector3d::Zero(), Matrix3d::Zero()};
        for (const Coil coil : kAllCoils) {
            const double current = currents[static_cast<std::size_t>(coil)];
            const FieldAndGradient unit = map->unit_field(coil, {x, 0.0, z});
            full.field += current * unit.field;
            full.gradient += current * unit.gradient;
        }
        CHECK(std::abs(found.bx - full.field.x()) <= 1e-10 * kUnitField);
        CHECK(std::abs(found.bz - full.field.z()) <= 1e-10 * kUnitField);
        CHECK(std::abs(found.dbx_dz - full.gradient(0, 2)) <= 1e-7 * kUnitField / 0.1);
    }
    CHECK_FALSE(field.outside());
    field.rebase({0.00401, 0.0});
    CHECK(field.outside());
}

TEST_CASE("field map: what is none is refused") {
    const PerCoilOf<std::vector<double>> uniform = {
        {{0.0, 1.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}}};
    CHECK_NOTHROW(FieldMap(kBox, uniform));
    CHECK_THROWS_AS(FieldMap({{0.001, -1.0, -1.0}, {1.0, 1.0, 1.0}}, uniform),
                    std::invalid_argument);
    CHECK_THROWS_AS(FieldMap({{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, uniform), std::invalid_argument);
    PerCoilOf<std::vector<double>> other = uniform;
    other[2].push_back(0.0);
    CHECK_THROWS_WITH_AS(
        FieldMap(kBox, other),
        "a map has l (l + 2) coefficients a coil for a degree l from 1 to 10, not 4",
        std::invalid_argument);
    other[2] = {0.0, std::numeric_limits<double>::infinity(), 0.0};
    CHECK_THROWS_AS(FieldMap(kBox, other), std::invalid_argument);

    // Without a field of the coil that drives there is no voltage for one.
    Scenario scenario;
    other[2] = {0.0, 0.0, 0.0};
    scenario.map = std::make_shared<const FieldMap>(kBox, other);
    CHECK_NOTHROW(check(scenario));
    other[0] = {0.0, 0.0, 0.0};
    scenario.map = std::make_shared<const FieldMap>(kBox, other);
    CHECK_THROWS_AS(check(scenario), std::invalid_argument);
}
