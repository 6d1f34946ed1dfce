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
using stickslip::test::in_coil_field;
using stickslip::test::in_uniform_field;
using stickslip::test::paper_coils;
using stickslip::test::paper_model;
using stickslip::test::Random;

namespace {

FreeCurve random_curve(Random& random, FreeReach reach, double span) {
    FreeShape shape{reach, span};
    for (double& knot : shape.knots) knot = random.between(-0.8, 2.0);
    return FreeCurve(shape);
}

FreeCurve constant_curve(FreeReach reach, double value) {
    FreeShape shape{reach, 1.0};
    shape.knots.fill(value);
    return FreeCurve(shape);
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
    dynamics.rebase_field(m.x, 5e-5);
    const Pose pose = dynamics.pose(m.angle);
    return dynamics.load(dynamics.field_at(0.0), m.x, 5e-5, pose, m.vx, m.vz, m.omega);
}

double tilt(const Motion& m) {
    return std::remainder(m.quadrant * kQuarterTurn + m.angle, 4.0 * kQuarterTurn);
}

void set_knots(Scenario& scenario, const std::string& name, const std::vector<double>& knots) {
    for (std::size_t i = 0; i < knots.size(); ++i) {
        set_parameter(scenario, "effects." + name + ".knot_" + std::to_string(i + 1), knots[i]);
    }
}

}  // namespace

TEST_CASE("free drag: the force times the factors of angle, speed and rate, the torque of rate") {
    Random random(1);
    Model plain = paper_model();
    plain.translational_drag_quadratic = 2e-3;
    plain.angle_drag = 0.7;
    plain.rotational_drag_linear = 1e-13;
    for (int n = 0; n < 200; ++n) {
        Model model = plain;
        model.drag_shape = {random_curve(random, FreeReach::both_ways, 1.0),
                            random_curve(random, FreeReach::from_zero, 0.1),
                            random_curve(random, FreeReach::from_zero, 1e3)};
        Model dry = plain;
        dry.translational_drag = dry.translational_drag_quadratic = dry.angle_drag = 0.0;
        dry.rotational_drag_linear = dry.rotational_drag_quadratic = 0.0;
        Dynamics shaped = in_uniform_field(model, 0.0, 0.0);
        Dynamics wet = in_uniform_field(plain, 0.0, 0.0);
        Dynamics none = in_uniform_field(dry, 0.0, 0.0);
        const Motion m = random_motion(random);
        const Load a = load_at(shaped, m), b = load_at(wet, m), c = load_at(none, m);
        const double rate = model.drag_shape.rate.factor(std::abs(m.omega));
        const double force = model.drag_shape.angle.factor(tilt(m)) *
                             model.drag_shape.speed.factor(std::hypot(m.vx, m.vz)) * rate;
        CHECK(a.fx - c.fx == doctest::Approx(force * (b.fx - c.fx)).epsilon(1e-10));
        CHECK(a.fz - c.fz == doctest::Approx(force * (b.fz - c.fz)).epsilon(1e-10));
        CHECK(a.torque - c.torque == doctest::Approx(rate * (b.torque - c.torque)).epsilon(1e-10));
        // It takes energy, whatever the knots.
        CHECK((a.fx - c.fx) * m.vx + (a.fz - c.fz) * m.vz <= 0.0);
        CHECK((a.torque - c.torque) * m.omega <= 0.0);
    }
}

TEST_CASE("free friction: each law is a factor at its argument") {
    Random random(2);
    FrictionExtensions e;
    e.smooth.anisotropy = 0.2;
    e.smooth.viscous = 3.0;
    const FrictionLaw named(0.2, 0.145, e);
    e.speed = random_curve(random, FreeReach::anchored, 0.02);
    e.angle = random_curve(random, FreeReach::both_ways, 1.0);
    e.load = random_curve(random, FreeReach::from_zero, 1e-6);
    e.time = random_curve(random, FreeReach::from_zero, 2.0);
    const FrictionLaw law(0.2, 0.145, e);
    for (int n = 0; n < 100; ++n) {
        const double theta = random.between(-3.1, 3.1), speed = random.between(-0.03, 0.03);
        const ContactPoint at = {1e-4, std::sin(theta), std::cos(theta), random.between(0.0, 2e-6),
                                 random.between(0.0, 3.0)};
        const double both =
            e.angle.factor(theta) * e.load.factor(at.normal) * e.time.factor(at.time);
        CHECK(law.static_limit(1, at) ==
              doctest::Approx(both * named.static_limit(1, at)).epsilon(1e-12));
        CHECK(law.kinetic(1, speed, at) ==
              doctest::Approx(both * e.speed.factor(std::abs(speed)) * named.kinetic(1, speed, at))
                  .epsilon(1e-12));
        // At no velocity the kinetic coefficient is that of the other laws.
        CHECK(law.kinetic(-1, 0.0, at) ==
              doctest::Approx(both * named.kinetic(-1, 0.0, at)).epsilon(1e-12));
        CHECK(law.impulsive(1, true, at) ==
              doctest::Approx(both * named.impulsive(1, true, at)).epsilon(1e-12));
    }
}

TEST_CASE("free friction of the load: a corner that slips presses with the force of its law") {
    Random random(3);
    int pressed = 0;
    for (int n = 0; n < 500; ++n) {
        FrictionExtensions e;
        e.load = random_curve(random, FreeReach::from_zero, 1e-6);
        Model model = paper_model();
        model.friction = {0.4, random.between(0.05, 0.4), e};
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
        // The Newton step at the end is within some roundings of the normal force.
        CHECK(coefficient ==
              doctest::Approx(dynamics.kinetic(slip, 0.01, m.x, pose, motion.normal, 0.0))
                  .epsilon(1e-12));
        pressed += motion.normal > 0.0;
    }
    CHECK(pressed > 100);
}

TEST_CASE("free friction in an impact: that of the load's last knot and of the time") {
    FrictionExtensions e;
    e.load = FreeCurve({FreeReach::from_zero, 1e-6, {0.0, 0.0, 0.0, 0.0, 0.5}});
    e.time = FreeCurve({FreeReach::from_zero, 4.0, {0.0, 1.0, 2.0, 3.0, 4.0}});
    e.speed = constant_curve(FreeReach::anchored, 3.0);
    Model shaped = paper_model(), same = paper_model();
    shaped.friction = {0.02, 0.01, e};
    same.friction = {0.02 * 1.5 * 3.0, 0.01 * 1.5 * 3.0};
    const Pose pose = shaped.shape.pose(0, std::cos(0.4), std::sin(0.4));
    const BodyState before = {0.0, pose.height, 0.4, 0.05, -0.02, 3.0, 0};
    const ImpactResult a = corner_impact(shaped, pose, before, 2.0);
    const ImpactResult b = corner_impact(same, pose, before);
    CHECK(a.slip_velocity != 0.0);
    CHECK(a.slip_velocity == doctest::Approx(b.slip_velocity).epsilon(1e-12));
    CHECK(a.body.omega == doctest::Approx(b.body.omega).epsilon(1e-12));
}

TEST_CASE("free adhesion: each law is a factor, and its slope the derivative by the angle") {
    Random random(4);
    Adhesion named;
    named.strength = 0.22e-6;
    named.smooth.angle_loss = 0.4;
    named.smooth.ageing_rate = 0.3;
    Adhesion shaped = named;
    shaped.angle = random_curve(random, FreeReach::both_ways, 1.0);
    shaped.age = random_curve(random, FreeReach::from_zero, 0.1);
    for (int n = 0; n < 100; ++n) {
        const double theta = random.between(-2.0, 2.0), age = random.between(-0.01, 0.2);
        const auto strength = [&](const Adhesion& a, double at) {
            return a.of_contact(std::sin(at), std::cos(at), age);
        };
        const double factor = shaped.angle.factor(theta) * shaped.age.factor(std::max(age, 0.0));
        CHECK(strength(shaped, theta) ==
              doctest::Approx(factor * strength(named, theta)).epsilon(1e-12));
    }
}

TEST_CASE("free field: the coils' field times the factors, and not the ambient one") {
    const PerCoil currents = {1.5, 0.0, -0.8, 0.0, 2.0};
    Random random(5);
    Model model = paper_model();
    model.field_shape = {random_curve(random, FreeReach::from_zero, 2.0),
                         random_curve(random, FreeReach::from_zero, 3.0)};
    const auto field_of = [&](const FieldShape* shape, const PerCoil& gain, double tau) {
        LocalField field(paper_coils(), gain, {1e-4, -2e-4});
        if (shape) field.set_shape(*shape);
        CurrentSegment segment = stickslip::test::steady(currents);
        segment.start = 0.4;
        field.set_segment(segment);
        field.rebase({1e-4, 1e-4});
        return field.at(tau)(1.2e-4, 0.9e-4);
    };
    for (const double tau : {0.0, 0.3, 0.9}) {
        const double factor =
            model.field_shape.time.factor(0.4 + tau) *
            model.field_shape.amplitude.factor(std::hypot(currents[0], currents[2]));
        PerCoil gain;
        gain.fill(factor);
        const PlanarField a = field_of(&model.field_shape, stickslip::test::all_driven(), tau);
        const PlanarField b = field_of(nullptr, gain, tau);
        CHECK(a.bx == doctest::Approx(b.bx).epsilon(1e-13));
        CHECK(a.bz == doctest::Approx(b.bz).epsilon(1e-13));
        CHECK(a.dbx_dx == doctest::Approx(b.dbx_dx).epsilon(1e-13));
        CHECK(a.dbx_dz == doctest::Approx(b.dbx_dz).epsilon(1e-13));
    }
    // A field that nothing else has told of: lanes must not have the run.
    Dynamics dynamics = in_coil_field(model, currents);
    CHECK_FALSE(dynamics.is_plain());
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
