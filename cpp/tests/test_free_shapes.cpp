#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/impact.hpp"
#include "stickslip/readings/probe.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

Law law_of(Quantity quantity, Argument argument, const FreeShape& shape) {
    return {.kind = {quantity, Acts::multiplies, argument, Form::curve}, .curve = shape};
}

struct Motion {
    int quadrant;
    double angle, x, vx, vz, omega;
};

Motion random_motion(Random& random) {
    return {random.integer(-4, 4),       random.between(0.0, kQuarterTurn),
            random.between(-1e-4, 1e-4), random.between(-0.1, 0.1),
            random.between(-0.1, 0.1),   random.between(-2e3, 2e3)};
}

Load load_at(Dynamics& dynamics, const Motion& m) {
    dynamics.set_quadrant(m.quadrant);
    dynamics.field().rebase({m.x, 5e-5});
    const Pose pose = dynamics.pose(m.angle);
    return dynamics.load(dynamics.field_at(0.0), m.x, 5e-5, pose, m.vx, m.vz, m.omega);
}

void set_knots(Scenario& scenario, const std::string& name, const std::vector<double>& knots) {
    for (std::size_t i = 0; i < knots.size(); ++i) {
        set_parameter(scenario, "effects." + name + ".knot_" + std::to_string(i + 1), knots[i]);
    }
}

}  // namespace

TEST_CASE("free friction of the load: a corner that slips presses with the force of its law") {
    Random random(3);
    int pressed = 0;
    for (int n = 0; n < 500; ++n) {
        FreeShape shape{FreeReach::from_zero, 1e-6};
        for (double& knot : shape.knots) knot = random.between(-0.8, 2.0);
        Model model = paper_model();
        model.friction = {0.4, random.between(0.05, 0.4)};
        model.laws = LawSet({law_of(Quantity::friction_by_load, Argument::load, shape)});
        Dynamics dynamics = in_uniform_field(model, random.between(-1e-3, 1e-3), -1e-3);
        const Motion m = random_motion(random);
        const Load load = load_at(dynamics, m);
        const Pose pose = dynamics.pose(m.angle);
        const double slip = random.coin() ? 1.0 : -1.0;
        const double coefficient =
            dynamics.corner_kinetic(slip, 0.01, m.x, pose, m.omega, load, 0.0);
        const CornerSlip motion =
            corner_slip(dynamics.robot(), pose, m.omega, load, slip * coefficient);
        if (motion.effective_inertia <= 0.0) continue;
        // The last secant is within some roundings of the normal force.
        CHECK(coefficient ==
              doctest::Approx(dynamics.kinetic(slip, 0.01, m.x, pose, motion.normal, 0.0))
                  .epsilon(1e-12));
        pressed += motion.normal > 0.0;
    }
    CHECK(pressed > 100);
}

TEST_CASE("free friction in an impact: that of the load's last knot and of the time") {
    Model shaped = paper_model(), same = paper_model();
    shaped.friction = {0.02, 0.01};
    shaped.laws = LawSet({law_of(Quantity::friction_by_load, Argument::load,
                                 {FreeReach::from_zero, 1e-6, {0.0, 0.0, 0.0, 0.0, 0.5}}),
                          law_of(Quantity::friction, Argument::time,
                                 {FreeReach::from_zero, 4.0, {0.0, 1.0, 2.0, 3.0, 4.0}}),
                          law_of(Quantity::sliding_friction, Argument::slip_speed,
                                 {FreeReach::anchored, 1.0, {3.0, 3.0, 3.0, 3.0, 3.0}})});
    same.friction = {0.02 * 1.5 * 3.0, 0.01 * 1.5 * 3.0};
    const Pose pose = shaped.shape.pose(0, std::cos(0.4), std::sin(0.4));
    const BodyState before = {0.0, pose.height, 0.4, 0.05, -0.02, 3.0, 0};
    const ImpactResult a = corner_impact(shaped, pose, before, 2.0);
    const ImpactResult b = corner_impact(same, pose, before);
    CHECK(a.slip_velocity != 0.0);
    CHECK(a.slip_velocity == doctest::Approx(b.slip_velocity).epsilon(1e-12));
    CHECK(a.body.omega == doctest::Approx(b.body.omega).epsilon(1e-12));
}

TEST_CASE("free field: a probe reads currents that are held") {
    Scenario scenario;
    set_knots(scenario, "free_field_time", {0.1, 0.5});
    set_knots(scenario, "free_field_frequency", {0.2, 0.5});
    set_knots(scenario, "free_field_amplitude", {0.3, 0.3, 0.3, 0.3, 0.3});
    const std::vector<double> place = {1e-4, 0.0, 1e-4}, currents = {1.0, 0.0, 0.0, 0.0, 0.5};
    const auto a = probe_readings(scenario, {}, {}, place, currents);
    const auto b = probe_readings(Scenario{}, {}, {}, place, currents);
    for (const std::size_t axis : {0u, 2u}) {
        CHECK(a[axis] == doctest::Approx(1.1 * 1.2 * 1.3 * b[axis]).epsilon(1e-13));
    }
}
