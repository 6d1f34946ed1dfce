#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "plane_scenarios.hpp"
#include "stickslip/contact/impact.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::alone;
using stickslip::test::along_and_across;
using stickslip::test::paper_model;
using stickslip::test::Random;
using stickslip::test::walking;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// m/s^2, of a face that slides.
double braking(const Scenario& s) {
    return s.contact.kinetic_friction * (s.gravity + s.contact.adhesion / s.robot.mass);
}

}  // namespace

// The corner that lands, too, is where the heading has it.
TEST_CASE("plane: friction patches lie along x, whichever way the robot faces") {
    Scenario scenario = walking(0.5 * std::numbers::pi);
    const double smooth = simulate(scenario).summary.mean_velocity_y;
    set_parameter(scenario, "effects.friction_patches.amplitude", 0.5);
    set_parameter(scenario, "effects.friction_patches.period", 4e-4);
    CHECK(simulate(scenario).summary.mean_velocity_y == doctest::Approx(smooth).epsilon(1e-9));
    scenario.drive.heading = 0.0;
    scenario.drive.direction = Direction::minus_x;
    const double turning = simulate(scenario).summary.mean_velocity;
    scenario.whole_plane = false;
    const double planar = simulate(scenario).summary.mean_velocity;
    CHECK(turning == doctest::Approx(planar).epsilon(1e-6));
    CHECK(std::abs(planar + smooth) > 1e-3 * smooth);
}

TEST_CASE("plane: turning everything by a quarter turn, and a mirror, change the axes alone") {
    const double heading = 25.0 * kDegree;
    const Slip first = along_and_across(simulate(walking(heading)).summary, heading);
    CHECK(std::abs(first.across) > 0.01 * first.along);
    for (int quarter = 1; quarter < 4; ++quarter) {
        const double turned = heading + quarter * 0.5 * std::numbers::pi;
        const Slip other = along_and_across(simulate(walking(turned)).summary, turned);
        CHECK(other.along == doctest::Approx(first.along).epsilon(1e-6));
        CHECK(other.across == doctest::Approx(first.across).epsilon(1e-5));
    }
    const Slip mirrored = along_and_across(simulate(walking(-heading)).summary, -heading);
    CHECK(mirrored.along == doctest::Approx(first.along).epsilon(1e-6));
    CHECK(mirrored.across == doctest::Approx(-first.across).epsilon(1e-5));
}

// Without anything else friction brakes at mu (g + adhesion / m), and the way is straight.
TEST_CASE("plane: a face that is left alone slides straight and as far as friction lets it") {
    for (const double way : {0.0, 50.0 * kDegree, 100.0 * kDegree, -170.0 * kDegree}) {
        Scenario scenario = alone(0.05);
        const double speed = 0.02;
        scenario.initial.vx = speed * std::cos(way);
        scenario.initial.vy = speed * std::sin(way);
        const RunResult run = simulate(scenario);
        REQUIRE(run.status == Status::ok);
        const double distance = speed * speed / (2.0 * braking(scenario));
        CHECK(run.final_state.x == doctest::Approx(distance * std::cos(way)).epsilon(1e-6));
        CHECK(run.final_state.y == doctest::Approx(distance * std::sin(way)).epsilon(1e-6));
        CHECK(run.final_state.vx == 0.0);
        CHECK(run.final_state.contact == ContactWord::face_stick);
    }
}

TEST_CASE("plane: on a slope a face holds within the cone of friction, and slides straight down") {
    for (const double azimuth : {20.0 * kDegree, 90.0 * kDegree, -130.0 * kDegree}) {
        Scenario scenario = alone(0.02);
        scenario.contact.adhesion = 0.0;
        scenario.effects.surface_tilt_azimuth = azimuth;
        scenario.effects.surface_tilt_angle = std::atan(scenario.contact.static_friction) - 1e-4;
        CHECK(simulate(scenario).final_state.x == 0.0);
        scenario.effects.surface_tilt_angle += 2e-4;
        const RunResult run = simulate(scenario);
        const double tilt = scenario.effects.surface_tilt_angle, g = scenario.gravity;
        const double acceleration =
            g * (std::sin(tilt) - scenario.contact.kinetic_friction * std::cos(tilt));
        const double distance = 0.5 * acceleration * 0.02 * 0.02;
        CHECK(run.final_state.x == doctest::Approx(distance * std::cos(azimuth)).epsilon(1e-5));
        CHECK(run.final_state.y == doctest::Approx(distance * std::sin(azimuth)).epsilon(1e-5));
    }
}

TEST_CASE("plane: with a mode of friction that differs to the front and to the rear") {
    // Across, friction is that without the difference.
    Scenario scenario = alone(0.05);
    set_parameter(scenario, "effects.friction_anisotropy.fraction", 0.3);
    scenario.initial.vy = 0.02;
    const double distance = 0.02 * 0.02 / (2.0 * braking(scenario));
    CHECK(simulate(scenario).final_state.y == doctest::Approx(distance).epsilon(1e-6));
    scenario.initial.vy = 0.0;
    scenario.initial.vx = 0.02;
    CHECK(simulate(scenario).final_state.x == doctest::Approx(distance / 1.3).epsilon(1e-6));
}

// Complementarity of an impact: Coulomb's cone, friction against the slip that remains, no corner
// into the surface, and no energy gained.
TEST_CASE("plane: an impact with a velocity across keeps the laws of impacts") {
    Random random(9);
    int slides = 0, sticks = 0;
    for (int n = 0; n < 2000; ++n) {
        Model model = paper_model();
        model.restitution = random.coin() ? random.between(0.0, 0.9) : 0.0;
        BodyState before;
        before.angle = random.between(0.05, 1.5);
        before.vx = random.between(-0.05, 0.05);
        before.vy = random.between(-0.05, 0.05);
        before.vz = random.between(-0.1, 0.02);
        before.omega = random.between(-200.0, 200.0);
        const Pose pose = model.shape.pose(0, std::cos(before.angle), std::sin(before.angle));
        before.z = pose.height;
        if (!(corner_velocity_z(pose, before.vz, before.omega) < -1e-4)) continue;
        const ImpactResult impact = corner_impact(model, pose, before);
        const BodyState& after = impact.body;
        const double normal = model.mass * (after.vz - before.vz);
        const Slip friction = {model.mass * (after.vx - before.vx),
                               model.mass * (after.vy - before.vy)};
        const Slip slip = {corner_velocity_x(pose, after.vx, after.omega), after.vy};
        const double limit = model.friction.kinetic_coefficient * normal;
        CHECK(normal >= 0.0);
        CHECK(friction.size() <= limit * (1.0 + 1e-9));
        if (slip.size() > 1e-9) {
            ++slides;
            CHECK(friction.along ==
                  doctest::Approx(-limit * slip.along / slip.size()).epsilon(1e-6).scale(limit));
            CHECK(friction.across ==
                  doctest::Approx(-limit * slip.across / slip.size()).epsilon(1e-6).scale(limit));
        } else {
            ++sticks;
        }
        const auto energy = [&](const BodyState& b) {
            return model.mass * (b.vx * b.vx + b.vy * b.vy + b.vz * b.vz) +
                   model.inertia * b.omega * b.omega;
        };
        CHECK(energy(after) <= energy(before) * (1.0 + 1e-9));
    }
    CHECK(slides > 300);
    CHECK(sticks > 30);
}

TEST_CASE("plane: a start that does not face the drive's direction is one in the whole plane") {
    Scenario scenario;
    CHECK_FALSE(frame_of(scenario).whole_plane);
    scenario.initial.heading = 0.5;
    CHECK(frame_of(scenario).whole_plane);
    scenario.initial.heading = std::numbers::pi;
    CHECK(frame_of(scenario).whole_plane);
    scenario.drive.direction = Direction::minus_x;
    CHECK_FALSE(frame_of(scenario).whole_plane);
    scenario.initial.heading = 0.0;
    CHECK_FALSE(frame_of(scenario).whole_plane);
}
