#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/phases.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::in_uniform_field;
using stickslip::test::kRounding;
using stickslip::test::paper_model;
using stickslip::test::plain_robot;
using stickslip::test::Random;

namespace {

struct Draw {
    Pose pose;
    double omega;
    Load load;
};

Draw random_draw(Random& random, const Model& model) {
    const int quadrant = random.integer(-4, 4);
    const double angle = random.between(0.0, kQuarterTurn);
    Draw draw;
    draw.pose = model.shape.pose(quadrant, std::cos(angle), std::sin(angle));
    draw.omega = random.between(-3000.0, 3000.0);
    draw.load.fx = random.between(-1e-6, 1e-6);
    draw.load.fz = random.between(-1e-6, 1e-6);
    draw.load.torque = random.between(-1e-10, 1e-10);
    draw.load.contact_adhesion = random.between(0.0, 0.5e-6);
    return draw;
}

// What is left of Newton's and Euler's equations (10)-(12) when the reaction and the accelerations
// are put in, relative to the largest term. `slip_acceleration`: of the corner along x.
double residual(const Model& model, const Draw& draw, double angular_acceleration,
                double slip_acceleration, double normal, double friction) {
    const auto& [pose, omega, load] = draw;
    // Eqs. (13)-(14), differentiated twice, with the corner's own acceleration along x.
    const double ax =
        slip_acceleration + angular_acceleration * pose.height + omega * omega * pose.lever;
    const double az = angular_acceleration * pose.lever - omega * omega * pose.height;
    const double up = normal - load.contact_adhesion;
    const double force = model.mass * (std::abs(ax) + std::abs(az)) + std::abs(load.fx) +
                         std::abs(load.fz) + std::abs(normal) + load.contact_adhesion;
    const double r = model.shape.radius();
    const double torque =
        std::abs(load.torque) + model.inertia * std::abs(angular_acceleration) + force * r;
    return std::max({std::abs(model.mass * ax - load.fx - friction) / force,
                     std::abs(model.mass * az - load.fz - up) / force,
                     std::abs(model.inertia * angular_acceleration - load.torque +
                              pose.height * friction + pose.lever * up) /
                         torque});
}

}  // namespace

TEST_CASE("sticking corner: satisfies Newton's and Euler's equations with P at rest") {
    const Model model = paper_model();
    const PlainDynamics<double> robot = plain_robot(model);
    Random random(1);
    for (int n = 0; n < 1000; ++n) {
        const Draw draw = random_draw(random, model);
        const CornerStick stick = corner_stick(robot, draw.pose, draw.omega, draw.load);
        // J + m r^2 comes from other sums than the residual: a dozen roundings.
        CHECK(residual(model, draw, stick.angular_acceleration, 0.0, stick.reaction.normal,
                       stick.reaction.friction) < 16.0 * kRounding);
    }
}

TEST_CASE("slipping corner: satisfies Newton's and Euler's equations with friction at its limit") {
    const Model model = paper_model();
    const PlainDynamics<double> robot = plain_robot(model);
    Random random(2);
    int tried = 0;
    for (int n = 0; n < 1000; ++n) {
        const Draw draw = random_draw(random, model);
        const double coefficient = random.between(-2.0, 2.0);
        const CornerSlip slip = corner_slip(robot, draw.pose, draw.omega, draw.load, coefficient);
        CHECK(slip.effective_inertia == painleve_inertia(robot, draw.pose, coefficient));
        if (std::abs(slip.effective_inertia) < 0.1 * model.inertia) continue;
        ++tried;
        // Cancellation in the effective inertia by up to a factor 10, in its parts 4 J.
        CHECK(residual(model, draw, slip.angular_acceleration, slip.slip_acceleration, slip.normal,
                       -coefficient * slip.normal) < 16.0 * 40.0 * kRounding);
    }
    CHECK(tried > 900);
}

TEST_CASE("face: its two ends carry the load, and the lever of friction") {
    const Model model = paper_model();
    Random random(3);
    for (int n = 0; n < 1000; ++n) {
        const int quadrant = random.integer(-4, 4);
        const double base = model.shape.half_base(quadrant), rise = model.shape.half_rise(quadrant);
        const Load load = random_draw(random, model).load;
        const bool sticks = random.coin();
        const double coefficient = random.between(-2.0, 2.0);
        const FaceReaction reaction = face_reaction(model, quadrant, load, sticks, coefficient);
        const double size = std::abs(load.fx) + std::abs(load.fz) + load.contact_adhesion +
                            std::abs(reaction.friction);
        const double tolerance = 8.0 * kRounding * size;
        CHECK(std::abs(reaction.normal() + load.fz - load.contact_adhesion) <= tolerance);
        // No torque about the centre of mass; each end has half of the adhesion.
        const double torque =
            load.torque - rise * reaction.friction - base * (reaction.ahead - reaction.behind);
        CHECK(std::abs(torque) <=
              tolerance * (base + rise) + 8.0 * kRounding * std::abs(load.torque));
        if (sticks) {
            CHECK(reaction.friction == -load.fx);
        } else {
            CHECK(std::abs(reaction.friction + coefficient * reaction.normal()) <= tolerance);
        }
    }
}

TEST_CASE("kinematics: the centripetal term of Eq. (13) points from the corner to the centre") {
    // x = P_x - r cos(theta + phi) differentiates to + r thetadot^2 cos(theta + phi): a corner that
    // holds a turning body pulls the centre of mass towards itself. No load, so it is all there is.
    const Model model = paper_model();
    const double theta = 0.4, omega = 1000.0;
    const double r = model.shape.radius(), psi = theta + std::atan(0.4);
    const Pose pose = model.shape.pose(0, std::cos(theta), std::sin(theta));
    const CornerStick stick = corner_stick(plain_robot(model), pose, omega, Load{});
    const double pull = model.mass * r * omega * omega;
    CHECK(stick.angular_acceleration == 0.0);
    CHECK(stick.reaction.friction == doctest::Approx(pull * std::cos(psi)).epsilon(1e-14));
    CHECK(stick.reaction.normal == doctest::Approx(-pull * std::sin(psi)).epsilon(1e-14));

    // The same from positions at three times: truncation (omega h)^2/12, rounding 4e-16/(omega
    // h)^2.
    const double h = 1e-7;
    const auto x = [&](double t) { return -r * std::cos(psi + omega * t); };
    const double second = (x(h) - 2.0 * x(0.0) + x(-h)) / (h * h);
    CHECK(model.mass * second == doctest::Approx(stick.reaction.friction).epsilon(1e-7));
}

TEST_CASE("corner velocities are those of the rigid body") {
    const Model model = paper_model();
    const Pose pose = model.shape.pose(1, std::cos(0.3), std::sin(0.3));
    // v + omega e_y x (lever, -height) = v + omega (-height, -lever).
    CHECK(corner_velocity_x(pose, 0.01, 200.0) == 0.01 - 200.0 * pose.height);
    CHECK(corner_velocity_z(pose, 0.02, 200.0) == 0.02 - 200.0 * pose.lever);
}

TEST_CASE("rocking: the frequency pinned at a corner and in flight") {
    Model model = paper_model();
    model.gravity_z = 0.0;
    // The field's direction is the angle at which the magnet rests; nothing else turns it.
    const double rest = 0.3, field = 2.5e-3;
    Dynamics dynamics = in_uniform_field(model, field * std::cos(rest), -field * std::sin(rest));
    const auto frequency = [](double slope) {
        return std::sqrt(-slope) / (2.0 * std::numbers::pi);
    };
    const double h = 1e-4;  // rad; a sine's central difference is short by h^2/6 = 2e-9

    CornerStickPhase pinned(dynamics, {0.0});
    const auto turning_on_corner = [&](double angle) {
        const CornerStickPhase::State y = {angle, 0.0};
        pinned.rebase(y);
        CornerStickPhase::State rates;
        CornerStickPhase::Values unused;
        pinned.rates(pinned.field_at(0.0), y, rates, unused);
        return rates[1];
    };
    const double on_corner =
        frequency((turning_on_corner(rest + h) - turning_on_corner(rest - h)) / (2.0 * h));

    FlightPhase flight(dynamics);
    const auto turning_in_flight = [&](double angle) {
        const FlightPhase::State y = {0.0, 1e-3, angle, 0.0, 0.0, 0.0};
        flight.rebase(y);
        FlightPhase::State rates;
        FlightPhase::Values unused;
        flight.rates(flight.field_at(0.0), y, rates, unused);
        return rates[5];
    };
    const double in_flight =
        frequency((turning_in_flight(rest + h) - turning_in_flight(rest - h)) / (2.0 * h));

    const double r = model.shape.radius(), torque = model.moment * field;
    const double expected =
        std::sqrt(torque / (model.inertia + model.mass * r * r)) / (2.0 * std::numbers::pi);
    CHECK(on_corner == doctest::Approx(expected).epsilon(1e-8));
    // m r^2 / J = 3 for any uniform rectangle, so that the pinned inertia is four times the free.
    CHECK(in_flight == doctest::Approx(2.0 * on_corner).epsilon(1e-8));
    // Of 25.6 ug. Density times volume is 24.05 ug, which would make them 421 and 842 Hz.
    CHECK(on_corner == doctest::Approx(407.8).epsilon(0.05 / 407.8));
    CHECK(in_flight == doctest::Approx(815.7).epsilon(0.05 / 815.7));
    const double lighter = std::sqrt(25.6e-9 / (7400.0 * 250e-6 * 130e-6 * 100e-6));
    CHECK(lighter * on_corner == doctest::Approx(421.0).epsilon(0.5 / 421.0));
    CHECK(lighter * in_flight == doctest::Approx(842.0).epsilon(0.5 / 842.0));
}

TEST_CASE("Painleve: sliding first loses its solution at mu = 4/3 and theta = 41.6 degrees") {
    // J + m lever (lever - mu height) = 0 means mu = (1/3 + cos^2)/(cos sin) of theta + phi, with
    // J = m r^2/3. With t = tan it is (4 + t^2)/(3 t): least at t = 2, where it is 4/3.
    const Model model = paper_model();
    const PlainDynamics<double> robot = plain_robot(model);
    const double angle = std::atan(2.0) - std::atan(0.4);
    CHECK(angle * 180.0 / std::numbers::pi == doctest::Approx(41.6).epsilon(0.05 / 41.6));
    const auto inertia = [&](double theta, double mu) {
        return painleve_inertia(robot, model.shape.pose(0, std::cos(theta), std::sin(theta)), mu);
    };
    CHECK(std::abs(inertia(angle, 4.0 / 3.0)) < 16.0 * kRounding * model.inertia);
    double least = 1.0, least_angle = 0.0;
    for (int i = 0; i <= 90000; ++i) {
        const double theta = i / 90000.0 * kQuarterTurn;
        CHECK(inertia(theta, 1.3333) > 0.0);
        if (inertia(theta, 1.3334) < least) {
            least = inertia(theta, 1.3334);
            least_angle = theta;
        }
    }
    CHECK(least < 0.0);
    // Where it is least is not quite where it vanishes first: both tend to one as mu to 4/3.
    CHECK(least_angle == doctest::Approx(angle).epsilon(1e-3));
    // Slipping the other way presses less: no paradox however large the friction.
    for (int i = 0; i <= 90; ++i) CHECK(inertia(i / 90.0 * 1.19, -100.0) > 0.0);
}

TEST_CASE("impulse without collision: slip and nothing else, through the corner") {
    const Model model = paper_model();
    Random random(4);
    for (int n = 0; n < 200; ++n) {
        const double angle = random.between(0.0, kQuarterTurn), slip = random.between(-0.2, 0.2);
        const Pose pose = model.shape.pose(0, std::cos(angle), std::sin(angle));
        BodyState before;
        before.omega = random.between(-1000.0, 1000.0);
        before.vx = slip + before.omega * pose.height;
        before.vz = before.omega * pose.lever;
        BodyState after = before;
        stop_slip_by_impulse(model, pose, slip, after);
        const double speed = std::abs(slip) + 1000.0 * model.shape.radius();
        CHECK(std::abs(corner_velocity_x(pose, after.vx, after.omega)) < 4.0 * kRounding * speed);
        CHECK(std::abs(corner_velocity_z(pose, after.vz, after.omega)) < 4.0 * kRounding * speed);
        // Angular momentum about the corner: J omega + m (height vx + lever vz).
        const auto momentum = [&](const BodyState& body) {
            return model.inertia * body.omega +
                   model.mass * (pose.height * body.vx + pose.lever * body.vz);
        };
        CHECK(std::abs(momentum(after) - momentum(before)) <
              16.0 * kRounding * model.mass * model.shape.radius() * speed);
        const auto energy = [&](const BodyState& body) {
            return 0.5 * model.mass * (body.vx * body.vx + body.vz * body.vz) +
                   0.5 * model.inertia * body.omega * body.omega;
        };
        CHECK(energy(after) <= energy(before) * (1.0 + 8.0 * kRounding));
    }
}

TEST_CASE("friction: the coefficient while slipping, with and without Stribeck's fall") {
    const FrictionLaw plain{0.2, 0.145};
    CHECK(plain.kinetic(1, 0.0, {}) == 0.145);
    CHECK(plain.kinetic(1, -1.0, {}) == 0.145);
    const FrictionLaw stribeck{0.2, 0.145, {.smooth = {.stribeck_velocity = 1e-3}}};
    CHECK(stribeck.kinetic(1, 0.0, {}) == doctest::Approx(0.2).epsilon(1e-15));
    CHECK(stribeck.kinetic(1, 1e-3, {}) ==
          doctest::Approx(0.145 + 0.055 / std::exp(1.0)).epsilon(1e-15));
    CHECK(stribeck.kinetic(1, -1e-3, {}) == stribeck.kinetic(1, 1e-3, {}));
    CHECK(stribeck.kinetic(1, 1.0, {}) == 0.145);
}
