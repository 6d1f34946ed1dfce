#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "stickslip/contact/dynamics.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::in_coil_field;
using stickslip::test::in_uniform_field;
using stickslip::test::kRounding;
using stickslip::test::paper_coils;
using stickslip::test::paper_model;
using stickslip::test::Random;

namespace {

// The magnet alone: no weight, no drag, no adhesion.
Model magnet() {
    Model model = paper_model();
    model.gravity_x = model.gravity_z = 0.0;
    model.translational_drag = model.rotational_drag_linear = model.rotational_drag_quadratic = 0.0;
    model.adhesion = {};
    return model;
}

Load load_at(Dynamics& dynamics, const BodyState& body) {
    dynamics.set_quadrant(body.quadrant);
    dynamics.rebase_field(body.x, body.z);
    const Pose pose = dynamics.pose(body.angle);
    return dynamics.load(dynamics.field_at(0.0), body.x, body.z, pose, body.vx, body.vz,
                         body.omega);
}

BodyState random_body(Random& random) {
    BodyState body;
    body.quadrant = random.integer(-5, 5);
    body.angle = random.between(0.0, kQuarterTurn);
    body.x = random.between(-0.01, 0.01);
    body.z = random.between(0.0, 0.005);
    body.vx = random.between(-0.1, 0.1);
    body.vz = random.between(-0.1, 0.1);
    body.omega = random.between(-1000.0, 1000.0);
    return body;
}

}  // namespace

TEST_CASE("load: Eqs. (8) and (9) from the field of the coils, at any angle and misalignment") {
    Random random(1);
    for (int n = 0; n < 300; ++n) {
        Model model = magnet();
        model.misalignment = n % 3 == 0 ? 0.0 : random.between(-3.0, 3.0);
        PerCoil currents;
        for (double& current : currents) current = random.between(-7.0, 7.0);
        Dynamics dynamics = in_coil_field(model, currents);
        const BodyState body = random_body(random);
        const Load load = load_at(dynamics, body);

        const FieldAndGradient at = paper_coils().field(
            {body.x, 0.0, body.z}, Currents(Eigen::Map<const Currents>(currents.data())));
        const double direction = body.theta() + model.misalignment;
        const Eigen::Vector3d moment =
            model.moment * Eigen::Vector3d(std::cos(direction), 0.0, -std::sin(direction));
        const Eigen::Vector3d force = at.gradient * moment;
        // Angles of up to 12 rad carry 12 roundings, products and sums a few; five coils of 7 mT
        // and 0.13 T/m at most each may cancel.
        CHECK(std::abs(load.torque - moment.cross(at.field).y()) <
              32.0 * kRounding * model.moment * 5.0 * 7e-3);
        CHECK(std::abs(load.fx - force.x()) < 32.0 * kRounding * model.moment * 5.0 * 0.13);
        CHECK(std::abs(load.fz - force.z()) < 32.0 * kRounding * model.moment * 5.0 * 0.13);
        CHECK(load.contact_adhesion == 0.0);
    }
}

TEST_CASE("load: forces and torque are the slopes of the potential energy -m.B") {
    Random random(2);
    for (int n = 0; n < 100; ++n) {
        Model model = magnet();
        model.misalignment = random.between(-0.3, 0.3);
        PerCoil currents;
        for (double& current : currents) current = random.between(-7.0, 7.0);
        Dynamics dynamics = in_coil_field(model, currents);
        const Currents vector(Eigen::Map<const Currents>(currents.data()));
        const auto energy = [&](double x, double z, double theta) {
            const Eigen::Vector3d field = paper_coils().field({x, 0.0, z}, vector).field;
            const double direction = theta + model.misalignment;
            return -model.moment *
                   (std::cos(direction) * field.x() - std::sin(direction) * field.z());
        };
        const BodyState body = random_body(random);
        const double theta = body.theta();
        const Load load = load_at(dynamics, body);
        // Central differences. Lengths: fields vary over 0.1 m, so h = 20 um truncates at
        // (h/0.1)^2/6 = 7e-9, and rounds at 1e-16 0.1/h = 5e-13. Angle: h^2/6 = 2e-9 at 1e-4.
        const double h = 2e-5, t = 1e-4;
        const double size = model.moment * 5.0 * 7e-3;
        const double fx = -(energy(body.x + h, body.z, theta) - energy(body.x - h, body.z, theta));
        const double fz = -(energy(body.x, body.z + h, theta) - energy(body.x, body.z - h, theta));
        const double torque =
            -(energy(body.x, body.z, theta + t) - energy(body.x, body.z, theta - t));
        CHECK(std::abs(load.fx - fx / (2.0 * h)) < 4.0 * 7e-9 * size / 0.1);
        CHECK(std::abs(load.fz - fz / (2.0 * h)) < 4.0 * 7e-9 * size / 0.1);
        CHECK(std::abs(load.torque - torque / (2.0 * t)) < 2e-9 * size);
    }
}

TEST_CASE("load: signs. A clamp field downwards tilts nose-down, towards atan(-Bz/Bx)") {
    const Model model = magnet();
    Dynamics dynamics = in_uniform_field(model, 2e-3, -1e-3);
    BodyState body;
    CHECK(load_at(dynamics, body).torque > 0.0);  // flat: turns towards larger theta
    body.angle = std::atan(0.5);
    // Two products of moment 1.6e-9 and field 1e-3 that cancel.
    CHECK(std::abs(load_at(dynamics, body).torque) < 4.0 * kRounding * model.moment * 2e-3);
    body.angle += 0.01;
    CHECK(load_at(dynamics, body).torque < 0.0);
}

TEST_CASE("load: torque at the centre is 10.56 uN mm for 6.5 mT across the moment") {
    const Model model = magnet();
    Dynamics dynamics = in_uniform_field(model, 0.0, -6.5e-3);
    // 5e5 A/m times 250 x 130 x 100 um^3 times 6.5 mT.
    const double expected = 5e5 * 250e-6 * 130e-6 * 100e-6 * 6.5e-3;
    CHECK(expected == doctest::Approx(10.56e-9).epsilon(5e-4));
    CHECK(load_at(dynamics, {}).torque == doctest::Approx(expected).epsilon(1e-14));
}

TEST_CASE("load: weight, and its part along a tilted surface") {
    Model model = magnet();
    model.gravity_x = 3.0;
    model.gravity_z = -9.0;
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    const Load load = load_at(dynamics, {});
    CHECK(load.fx == doctest::Approx(model.mass * 3.0).epsilon(1e-15));
    CHECK(load.fz == doctest::Approx(-model.mass * 9.0).epsilon(1e-15));
    CHECK(load.torque == 0.0);
}

TEST_CASE("drag: Eqs. (18) and (19), and it takes energy whatever the direction") {
    Model model = magnet();
    model.translational_drag = 1e-5;
    model.rotational_drag_quadratic = 9e-17;
    model.rotational_drag_linear = 2e-15;
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    Random random(3);
    for (int n = 0; n < 200; ++n) {
        const BodyState body = random_body(random);
        const Load load = load_at(dynamics, body);
        CHECK(load.fx == doctest::Approx(-1e-5 * body.vx).epsilon(1e-14));
        CHECK(load.fz == doctest::Approx(-1e-5 * body.vz).epsilon(1e-14));
        const double turning = 2e-15 * body.omega + 9e-17 * std::abs(body.omega) * body.omega;
        CHECK(load.torque == doctest::Approx(-turning).epsilon(1e-14));
        CHECK(load.fx * body.vx + load.fz * body.vz < 0.0);
        CHECK(load.torque * body.omega < 0.0);
    }
}

TEST_CASE("angle drag: larger by the factor 1 + k cos^2 theta, in every quadrant") {
    Model model = magnet();
    model.translational_drag = 1e-5;
    model.angle_drag = 0.7;
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    Random random(4);
    for (int n = 0; n < 200; ++n) {
        const BodyState body = random_body(random);
        const double cosine = std::cos(body.theta());
        const double drag = 1e-5 * (1.0 + 0.7 * cosine * cosine);
        // theta of up to 12 rad has 12 roundings.
        CHECK(load_at(dynamics, body).fx == doctest::Approx(-drag * body.vx).epsilon(1e-14));
        CHECK(load_at(dynamics, body).fz == doctest::Approx(-drag * body.vz).epsilon(1e-14));
    }
}

TEST_CASE("pose: that of the C library but for rounding, in every quadrant and turns beyond") {
    const Model model = paper_model();
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    for (const int quadrant : {0, 1, -6}) {
        dynamics.set_quadrant(quadrant);
        for (const double angle :
             {-0.1, 0.0, 1e-9, 0.4, 0.785, 1.2, kQuarterTurn, 1.68, 1.69, -0.12, 3.0, -40.0}) {
            const Pose pose = dynamics.pose(angle);
            const Pose direct = model.pose(quadrant, angle);
            // That of `cosine_and_sine`, and what an angle of 40 loses; then two roundings.
            const double tolerance = (4.0 + std::abs(angle)) * kRounding;
            CHECK(std::abs(pose.cosine - direct.cosine) < tolerance);
            CHECK(std::abs(pose.sine - direct.sine) < tolerance);
            CHECK(std::abs(pose.lever - direct.lever) < 2.0 * tolerance * model.shape.radius());
            CHECK(std::abs(pose.height - direct.height) < 2.0 * tolerance * model.shape.radius());
            CHECK(pose.angle == angle);
        }
        // Where a face lies flat.
        CHECK(dynamics.pose(0.0).cosine == 1.0);
        CHECK(dynamics.pose(0.0).sine == 0.0);
        CHECK(dynamics.pose(kQuarterTurn).cosine == 0.0);
        CHECK(dynamics.pose(kQuarterTurn).sine == 1.0);
    }
}

TEST_CASE("adhesion pulls at contact, and is no force on the centre of mass") {
    constexpr double kStrength = 0.22e-6;  // N
    Model model = magnet();
    model.adhesion = {.strength = kStrength};
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    dynamics.rebase_field(0.0, 1e-4);
    const Pose pose = dynamics.pose(0.3);
    const Load load = dynamics.load(dynamics.field_at(0.0), 0.0, pose.height, pose, 0.0, 0.0, 0.0);
    CHECK(load.contact_adhesion == kStrength);
    CHECK(load.fz == 0.0);
    CHECK(load.torque == 0.0);
}
