#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "stickslip/contact/face_phases.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/solver/tsit5.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::all_driven;
using stickslip::test::paper_coils;
using stickslip::test::paper_model;

namespace {

// Reactions of a flat robot at rest from the full sum of the coils, as Eqs. (8)-(12) give them.
struct Reactions {
    double ahead, behind, friction, limit;

    Reactions(const Model& model, const PerCoil& amperes) {
        const double b = 125e-6, h = 50e-6;
        const FieldAndGradient at = paper_coils().field(
            {0.0, 0.0, h}, Currents(Eigen::Map<const Currents>(amperes.data())));
        const Eigen::Vector3d force = model.moment * at.gradient.col(0);
        const double torque = -model.moment * at.field.z();
        const double normal = model.adhesion.strength - model.mass * model.gravity_z - force.z();
        friction = -force.x() - model.mass * model.gravity_x;
        ahead = 0.5 * normal + (torque - h * friction) / (2.0 * b);
        behind = 0.5 * normal - (torque - h * friction) / (2.0 * b);
        limit = model.friction.static_coefficient * normal;
    }
};

BodyState flat() {
    BodyState body;
    body.z = 50e-6;
    return body;
}

// First zero of a function that falls.
template <class Function>
double bisect(Function&& positive, double low, double high) {
    for (int i = 0; i < 200 && high > low; ++i) {
        const double middle = 0.5 * (low + high);
        (positive(middle) ? low : high) = middle;
    }
    return high;
}

struct Found {
    PhaseEnd<FaceRestPhase> end;
    FaceRestPhase::Values values;  // at the end
};

Found end_of_rest(const Model& model, const CurrentSegment& segment) {
    LocalField field(paper_coils(), all_driven());
    field.set_segment(segment);
    Dynamics dynamics(model, field);
    FaceRestPhase rest(dynamics);
    PhaseMemory memory;
    StepperOptions options;
    options.scales = {1e-4, 1.0, 1e4};
    options.swing_rate = 1e4;
    const auto end = Tsit5(options).advance(rest, memory, 0.0, segment.duration, rest.begin(flat()),
                                            [](auto&&...) { return kGoesOn; });
    FaceRestPhase::State unused;
    Found found = {end, {}};
    rest.rates(rest.field_at(end.tau), end.y, unused, found.values);
    return found;
}

// Five coils' currents over a slow rise of the voltages.
CurrentSegment slow_rise(const PerCoil& volts, double duration) {
    Circuit circuit = test::equal_coils(10.0, 0.07, 0.0);
    return circuit.advance({0.0, duration, {}, volts});
}

}  // namespace

TEST_CASE("rest: under a slowly rising field the cone is left when the closed form says") {
    // The x coil alone pulls with its gradient; friction so low that it slips before it tips.
    Model model = paper_model();
    model.friction = {0.02, 0.01};
    for (const double direction : {1.0, -1.0}) {
        PerCoil volts = {};
        volts[direction > 0.0 ? 0 : 1] = 60.0;  // either coil attracts the robot
        model.moment = direction > 0.0 ? paper_model().moment : -paper_model().moment;
        if (direction < 0.0) volts[1] = -60.0;
        const CurrentSegment segment = slow_rise(volts, 20.0);
        const double expected = bisect(
            [&](double t) {
                const Reactions r(model, segment.currents(t));
                return std::abs(r.friction) < r.limit;
            },
            0.0, 20.0);
        REQUIRE(expected < 19.0);
        const Found found = end_of_rest(model, segment);
        const Reactions there(model, segment.currents(found.end.tau));
        const bool forward = there.friction < 0.0;
        CHECK(found.end.event == (forward ? Event::breaks_forward : Event::breaks_backward));
        // The finder's resolution is 2e-12 of a step, which is as long as the time so far; force
        // and limit carry 1e-15 of their size, which comes to the same part of the time.
        CHECK(std::abs(found.end.tau - expected) < 1e-11 * expected);
        CHECK(found.values[forward ? 3 : 2] <= 0.0);  // the far side
        CHECK(there.ahead > 0.0);
        CHECK(there.behind > 0.0);
    }
}

TEST_CASE("rest: a rising clamp field tips the robot when the closed form says") {
    const Model model = paper_model();
    for (const double volts : {-20.0, 20.0}) {
        const CurrentSegment segment = slow_rise({0.0, 0.0, 0.0, 0.0, volts}, 20.0);
        const double expected = bisect(
            [&](double t) {
                const Reactions r(model, segment.currents(t));
                return std::min(r.ahead, r.behind) > 0.0;
            },
            0.0, 20.0);
        REQUIRE(expected < 19.0);
        const Found found = end_of_rest(model, segment);
        CHECK(found.end.event == (volts < 0.0 ? Event::behind_lifts : Event::ahead_lifts));
        CHECK(std::abs(found.end.tau - expected) < 1e-11 * expected);
        CHECK(found.values[volts < 0.0 ? 1 : 0] <= 0.0);
    }
}

TEST_CASE("rest: after a jump of the voltage the event lies in the first time constant") {
    const Model model = paper_model();
    Circuit circuit = test::equal_coils(10.0, 0.07, 0.0);
    const PerCoil volts = {0.0, 0.0, 0.0, 0.0, -20.0};
    const CurrentSegment segment = circuit.advance({0.0, 100.0, volts, volts});
    const double expected = bisect(
        [&](double t) { return Reactions(model, segment.currents(t)).behind > 0.0; }, 0.0, 1.0);
    REQUIRE(expected < 1e-3);
    const Found found = end_of_rest(model, segment);
    CHECK(found.end.event == Event::behind_lifts);
    // Of a step no longer than T.
    CHECK(std::abs(found.end.tau - expected) < 4e-12 * 0.007);
}

TEST_CASE("rest: a load that only just holds, and one that only just does not") {
    Model model = paper_model();
    model.friction = {0.02, 0.01};
    const PerCoil amperes = {5.0, 0.0, 0.0, 0.0, 0.0};
    const Reactions at_five(model, amperes);
    const double needed =
        std::abs(at_five.friction) / (at_five.limit / model.friction.static_coefficient);
    for (const double factor : {1.0 + 1e-12, 1.0 - 1e-12}) {
        model.friction.static_coefficient = needed * factor;
        model.friction.kinetic_coefficient = 0.5 * needed;
        const CurrentSegment segment = stickslip::test::steady(amperes, 10.0);
        const Found found = end_of_rest(model, segment);
        CHECK((found.end.event == Event::none) == (factor > 1.0));
        CHECK(found.end.tau == (factor > 1.0 ? 10.0 : 0.0));
    }
}

TEST_CASE("rest: a minute at 0.9 of the friction cone leaves every bit as it was") {
    // Weight down a tilted surface, against mu_s (m g cos + F_adh).
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const PerCoil off = {};
    scenario.program = VoltageProgram({{{{0.0, off}, {60.0, off}}, 1}});
    const double weight = scenario.robot.mass * scenario.gravity;
    const double share = 0.9;
    const double angle = bisect(
        [&](double tilt) {
            return weight * std::sin(tilt) <
                   share * scenario.contact.static_friction *
                       (weight * std::cos(tilt) + scenario.contact.adhesion);
        },
        0.0, 1.0);
    for (const double sign : {1.0, -1.0}) {
        scenario.effects.surface_tilt_angle = sign * angle;
        const RunResult result = simulate(scenario);
        CHECK(result.status == Status::ok);
        CHECK(result.summary.simulated_time == 60.0);
        CHECK(result.summary.mean_velocity == 0.0);
        CHECK(result.final_body.x == 0.0);
        CHECK(result.final_body.z == 50e-6);
        CHECK(result.final_body.angle == 0.0);
        CHECK(result.final_body.quadrant == 0);
        CHECK(result.final_body.vx == 0.0);
        CHECK(result.final_body.vz == 0.0);
        CHECK(result.final_body.omega == 0.0);
    }
    // And just beyond the cone it goes.
    scenario.effects.surface_tilt_angle = 1.2 * angle;
    CHECK(simulate(scenario).final_body.x > 1e-3);
}

TEST_CASE("rest: the tilt at which the robot slides is that of Eq. (15)") {
    // F_adh = m g (sin(alpha)/mu - cos(alpha)): 21.2 degrees for 0.22 uN and 25.6 ug.
    Scenario scenario;
    scenario.drive.mode = DriveMode::program;
    const PerCoil off = {};
    scenario.program = VoltageProgram({{{{0.0, off}, {0.05, off}}, 1}});
    const auto slide_angle = [](double weight) {
        return bisect(
            [&](double a) { return weight * (std::sin(a) / 0.2 - std::cos(a)) < 0.22e-6; }, 0.0,
            1.0);
    };
    constexpr double degree = std::numbers::pi / 180.0;
    const double alpha = slide_angle(scenario.robot.mass * scenario.gravity);
    CHECK(alpha / degree == doctest::Approx(21.2).epsilon(0.05 / 21.2));
    // Density times volume is 24.05 ug, which would make it 21.85 degrees.
    CHECK(slide_angle(7400.0 * 250e-6 * 130e-6 * 100e-6 * 9.81) / degree ==
          doctest::Approx(21.85).epsilon(0.005 / 21.85));
    scenario.effects.surface_tilt_angle = alpha * (1.0 - 1e-9);
    CHECK(simulate(scenario).final_body.x == 0.0);
    scenario.effects.surface_tilt_angle = alpha * (1.0 + 1e-9);
    CHECK(simulate(scenario).final_body.x > 0.0);
}
