#include "stickslip/field/field_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "fitted_map.hpp"
#include "stickslip/field/expansion.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/scenario/coils.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double kUnitField = 9.6e-4;  // T/A, of a coil of Table I at the centre

const Box kBox = {{-0.01, -0.006, -0.002}, {0.014, 0.008, 0.01}};

// Any numbers are a field that obeys Maxwell's equations.
FieldMap any_map(Random& random, std::size_t degree) {
    PerCoilOf<std::vector<double>> coefficients;
    for (auto& own : coefficients) {
        for (std::size_t i = 0; i < FieldMap::count(degree); ++i) {
            own.push_back(kUnitField * random.between(-1.0, 1.0));
        }
    }
    return {kBox, coefficients};
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
        const FieldMap map = any_map(random, degree);
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

TEST_CASE("field map: that of the paper's coils converges to them with the degree") {
    // A term of degree n falls as (place / distance of the wires)^n: 4.9 mm, the corner of the box,
    // over 103 mm. Its factor in the field of a coil is of order n + 1.
    const Box box = paper_map()->box();
    const CoilSet coils;
    Random random(2);
    std::vector<Vector3d> places;
    for (int n = 0; n < 100; ++n) places.push_back(any_point(random, box));
    for (std::size_t degree = 2; degree <= 8; ++degree) {
        const auto map = fitted_map(coils, box, degree);
        const double part = 0.5 * (box.high - box.low).norm() / 0.103;
        const double term = static_cast<double>(degree + 1) * std::pow(part, degree);
        for (const Vector3d& place : places) {
            for (const Coil coil : kAllCoils) {
                const FieldAndGradient of_map = map->unit_field(coil, place);
                const FieldAndGradient of_coil = coils.unit_field(coil, place);
                CHECK((of_map.field - of_coil.field).norm() <= (term + 1e-12) * kUnitField);
                const double steeper = static_cast<double>(degree) / (0.103 * part);
                CHECK((of_map.gradient - of_coil.gradient).norm() <=
                      (3.0 * term + 1e-11) * steeper * kUnitField);
            }
        }
    }
}

TEST_CASE("field map: turned, it is the field that a turned robot sees") {
    Random random(3);
    const FieldMap map = any_map(random, 5), turned = map.turned();
    const Matrix3d turn = Vector3d(-1.0, -1.0, 1.0).asDiagonal();
    const PerCoil world = {0.3, -1.1, 0.7, 0.2, -0.9};
    const PerCoil robot = stickslip::turned(world);
    for (int n = 0; n < 50; ++n) {
        const Vector3d point = any_point(random, kBox);
        CHECK(turned.box().holds(turn * point));
        FieldAndGradient in_world{Vector3d::Zero(), Matrix3d::Zero()}, in_robot = in_world;
        for (const Coil coil : kAllCoils) {
            const auto k = static_cast<std::size_t>(coil);
            const FieldAndGradient a = map.unit_field(coil, point);
            const FieldAndGradient b = turned.unit_field(coil, turn * point);
            in_world.field += world[k] * a.field;
            in_world.gradient += world[k] * a.gradient;
            in_robot.field += robot[k] * b.field;
            in_robot.gradient += robot[k] * b.gradient;
        }
        CHECK((turn * in_world.field - in_robot.field).norm() <= 1e-14 * kUnitField);
        CHECK((turn * in_world.gradient * turn - in_robot.gradient).norm() <=
              1e-13 * kUnitField / 0.01);
    }
}

TEST_CASE("field map: the field near the robot is that of the map") {
    // Fourth order in (reach + 0.1 mm) over the distance of the wires, as without a map.
    const CoilSet coils({}, paper_map());
    Random random(4);
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
            const FieldAndGradient unit = paper_map()->unit_field(coil, {x, 0.0, z});
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

TEST_CASE("field map: outside of its box it gives no field") {
    const CoilSet coils({}, paper_map());
    Currents currents = Currents::Ones();
    CHECK_NOTHROW(coils.field({0.004, 0.002, -0.002}, currents));
    CHECK_THROWS_WITH_AS(
        coils.field({0.0041, 0.0, 0.0}, currents),
        "point (0.0041, 0, 0) m lies outside of the field map, x -0.004 to 0.004 m, y -0.002 to "
        "0.002 m, z -0.002 to 0.002 m",
        std::domain_error);
    CHECK_THROWS_AS(coils.field({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, currents),
                    std::domain_error);
}

TEST_CASE("field map: a run with the map of the paper's coils goes as with the coils") {
    Scenario scenario;
    scenario.drive.base = 0.5e-3;
    scenario.drive.pulses = 12;
    for (const Direction direction : {Direction::plus_x, Direction::minus_x}) {
        scenario.drive.direction = direction;
        scenario.map = nullptr;
        const RunResult expected = simulate(scenario);
        scenario.map = paper_map();
        const RunResult found = simulate(scenario);
        CHECK(found.status == Status::ok);
        CHECK(found.summary.mean_velocity ==
              doctest::Approx(expected.summary.mean_velocity).epsilon(1e-6));
    }
}

TEST_CASE("field map: a robot that comes to its end has left the workspace") {
    Scenario scenario;
    scenario.drive.base = 0.5e-3;
    scenario.map = fitted_map(CoilSet(), {{-0.0005, -0.001, -0.001}, {0.0007, 0.001, 0.001}}, 4);
    const RunResult result = simulate(scenario);
    CHECK(result.status == Status::left_workspace);
    CHECK(result.final_body.x >= 0.0007);
    CHECK(result.final_body.x < 0.00071);
    CHECK(message(result).find("the robot left coil.map, which has the field from x = -0.0005 to "
                               "0.0007 m and from z = -0.001 to 0.001 m") != std::string::npos);
}

TEST_CASE("field map: a scenario with a map has no geometry of coils") {
    Scenario scenario;
    scenario.map = paper_map();
    CHECK_NOTHROW(check(scenario));
    scenario.coils[0].resistance = 12.0;
    scenario.coils[1].inductance = 0.05;
    CHECK_NOTHROW(check(scenario));
    for (CoilParameters& coil : scenario.coils) coil.side = 0.1;
    CHECK_THROWS_WITH_AS(check(scenario),
                         "coil.side = 0.1: allowed beside coil.map, which has the field of the "
                         "coils, is 0.1385 only",
                         std::invalid_argument);
    scenario.coils = {};
    scenario.coils[4].turns = 300.0;
    CHECK_THROWS_WITH_AS(check(scenario),
                         "coil.clamp.turns = 300: allowed beside coil.map, which has the field of "
                         "the coils, is 510 only",
                         std::invalid_argument);
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
