#include "stickslip/corner_balance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "stickslip/assembly.hpp"
#include "stickslip/parameters.hpp"
#include "stickslip/simulation.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

constexpr double kRate = 1e5;  // Hz

Scenario walking(const std::vector<std::pair<std::string, double>>& keys) {
    Scenario scenario;
    scenario.drive.frequency = 30.0;
    scenario.drive.base = 0.5e-3;
    scenario.drive.pulses = 4;
    scenario.record = {RecordKind::uniform, kRate};
    for (const auto& [key, value] : keys) set_parameter(scenario, key, value);
    return scenario;
}

struct Left {
    double torque = 0.0, sticking_velocity = 0.0,
           force = 0.0;  // largest, relative but for the second
    int sticks = 0, slips = 0;
};

/// What the balances of a scenario leave over of the motion of another, derivatives by central
/// differences.
Left left_over(const Scenario& scenario, const Scenario& simulated) {
    const Recording r = simulate(simulated).recording;
    Scenario at_events = simulated;
    at_events.record = {RecordKind::events, 0.0};
    const std::vector<double> events = simulate(at_events).recording.t;
    const double sign = frame_sign(scenario);
    const double h = (1.0 + scenario.effects.clock_scale_fraction) / kRate;
    std::vector<BalancePoint> points;
    std::vector<CornerMotion> motions;
    std::vector<bool> sticks;
    double touched = 0.0;
    for (std::size_t i = 2; i + 2 < r.t.size(); ++i) {
        if (r.contact[i] == 0) touched = r.t[i];
        // No difference reaches over an event.
        const auto event = std::lower_bound(events.begin(), events.end(), r.t[i - 2]);
        const bool smooth = event == events.end() || *event > r.t[i + 2];
        if (!smooth || r.contact[i] < 1 || r.contact[i] > 3) continue;
        const int world = r.contact[i] == 3 ? -1 : 1;
        points.push_back(
            {r.t[i], r.x[i], r.z[i], r.theta[i], r.t[i] - touched, static_cast<int>(sign) * world});
        motions.push_back({r.theta[i], r.omega[i], (r.omega[i + 1] - r.omega[i - 1]) / (2.0 * h),
                           sign * r.vx[i], sign * (r.vx[i + 1] - r.vx[i - 1]) / (2.0 * h)});
        sticks.push_back(r.contact[i] == 1);
    }
    // In one call, since each one builds its model.
    const CornerBalances found = corner_balances(scenario, points, motions);
    Left left;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const CornerBalance& b = found.rows[i];
        if (sticks[i]) {
            // Of the field's largest torque, M B = 1.6e-6 A m^2 x 2.5 mT.
            left.torque = std::max(left.torque, std::abs(b.torque) / 4e-9);
            left.sticking_velocity = std::max(left.sticking_velocity, std::abs(b.contact_velocity));
            ++left.sticks;
        } else {
            left.force = std::max(left.force, std::abs(b.force) / found.weight);
            ++left.slips;
        }
    }
    return left;
}

void check_closed(const Scenario& scenario) {
    const Left left = left_over(scenario, scenario);
    REQUIRE(left.sticks > 500);
    REQUIRE(left.slips > 100);
    // Differences of rates: h^2 / 6 of the third derivative, (2.6e3 rad/s)^3 of rocking, is 1e-4 of
    // the torque's own; where the drive bends the second derivative jumps, and more is left.
    CHECK(left.torque < 1e-3);
    CHECK(left.sticking_velocity < 1e-12);
    CHECK(left.force < 1e-3);
}

}  // namespace

TEST_CASE("balances of a simulated motion close") {
    check_closed(walking({}));
}

TEST_CASE("balances close with every effect that acts on a touching body") {
    std::vector<std::pair<std::string, double>> keys = {
        {"effects.coil_heating.coefficient", 1e-3},
        {"effects.amplifier_limit.voltage", 20.0},
        {"effects.eddy_lag.time", 2e-3},
        {"effects.mutual_inductance.coupling", 0.05},
        {"effects.gradient_scale.fraction", 0.3},
        {"effects.field_gain.in_plane", 0.1},
        {"effects.field_gain.clamp", -0.1},
        {"effects.misalignment.angle", 0.1},
        {"effects.magnetization_scale.fraction", 0.1},
        {"effects.ambient_field.Bx", 5e-5},
        {"effects.ambient_field.Bz", -5e-5},
        {"effects.stribeck_friction.velocity", 5e-3},
        {"effects.viscous_friction.coefficient", 2.0},
        {"effects.friction_anisotropy.fraction", 0.1},
        {"effects.friction_patches.amplitude", 0.2},
        {"effects.angle_adhesion.strength", 0.5},
        {"effects.adhesion_ageing.rate", 0.1},
        {"effects.angle_drag.strength", 0.5},
        {"effects.quadratic_drag.coefficient", 1e-3},
        {"effects.rotational_drag.coefficient", 1e-14},
        {"effects.surface_tilt.angle", 0.05},
        {"contact.adhesion_range", 1e-6},
    };
    Scenario forward = walking(keys);
    check_closed(forward);
    forward.drive.direction = Direction::minus_x;
    check_closed(forward);
}

TEST_CASE("balances close with free shapes of all that acts on a touching body") {
    std::vector<std::pair<std::string, double>> keys;
    for (const char* name :
         {"free_friction_speed", "free_friction_angle", "free_friction_load", "free_friction_age",
          "free_adhesion_angle", "free_adhesion_age", "free_contact_place", "free_drag_angle",
          "free_drag_speed", "free_drag_rate", "free_field_time", "free_field_frequency",
          "free_field_amplitude"}) {
        double knot = 0.1;
        for (const char* number : {"1", "2", "3", "4", "5"}) {
            keys.emplace_back("effects." + std::string(name) + ".knot_" + number, knot);
            knot = -1.2 * knot;
        }
    }
    check_closed(walking(keys));
}

TEST_CASE("what the instruments make of a motion is taken off before its balances") {
    check_closed(walking({{"effects.length_scale.fraction", 0.2},
                          {"effects.clock_scale.fraction", -0.1},
                          {"effects.angle_offset.angle", 0.05}}));
}

TEST_CASE("what is left of a motion is the force that the scenario lacks") {
    const Left field = left_over(walking({}), walking({{"effects.misalignment.angle", 0.05}}));
    CHECK(field.torque == doctest::Approx(0.05).epsilon(0.3));  // M B times the angle, at most
    const Left tilt = left_over(walking({}), walking({{"effects.surface_tilt.angle", 0.05}}));
    CHECK(tilt.force ==
          doctest::Approx(0.05 * 0.53).epsilon(0.1));  // 0.53: weight without adhesion
}

TEST_CASE("motions and points of balances have to fit") {
    CHECK_THROWS_AS(corner_balances(Scenario{}, {}, {}), std::invalid_argument);
    CHECK_THROWS_AS(corner_balances(Scenario{}, {{}, {}}, {{}}), std::invalid_argument);
}
