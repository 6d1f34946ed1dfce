#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "stickslip/contact/face_phases.hpp"
#include "stickslip/contact/phases.hpp"
#include "stickslip/solver/tsit5.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

/// Convergence of whole integrations on smooth phases: a corner that sticks and a flight, in the
/// fields of two coils whose currents settle after a jump of the voltage.
namespace {

constexpr double kSwingRate = 2600.0;  // rad/s, at 2.5 mT: one swing takes 2.4 ms

StepperOptions options(double tolerance, double max_step) {
    StepperOptions result;
    result.tolerance = tolerance;
    result.max_step = max_step;
    const double radius = paper_model().shape.radius();
    result.scales = {radius, radius * kSwingRate, kSwingRate};
    result.swing_rate = kSwingRate;
    return result;
}

// Steps of one width: an error of any size is accepted. The first step, a part of a swing, grows
// with the tolerance and is cut to max_step as all others are.
StepperOptions fixed_steps(double width) {
    return options(1e12, width);
}

class Setup {
public:
    Setup() : model_(model()), dynamics_(model_, field()) {}
    Dynamics& dynamics() { return dynamics_; }

private:
    static Model model() {
        Model model = paper_model();
        model.friction = {1e3, 1e3};  // nothing slips
        model.adhesion = 1e-3;        // and nothing leaves
        // Omega |omega| has no second derivative where the swing turns: no order would be seen.
        model.rotational_drag_quadratic = 0.0;
        model.rotational_drag_linear = 1e-14;
        return model;
    }
    static LocalField field() {
        Circuit circuit = test::equal_coils(10.0, 0.07, 0.0);
        VoltageSegment jump{0.0, 1.0, {26.0, 0.0, 0.0, 0.0, -13.0}, {26.0, 0.0, 0.0, 0.0, -13.0}};
        LocalField result(paper_coils(), {true, false, false, false, true}, {1.0e-3, -0.6e-3});
        result.set_segment(circuit.advance(jump));
        return result;
    }
    Model model_;
    Dynamics dynamics_;
};

struct Stick {
    static CornerStickPhase phase(Dynamics& dynamics) { return {dynamics, {0.0}}; }
    static CornerStickPhase::State start() { return {0.6, 300.0}; }
    static constexpr double kEnd = 4e-3;
};

struct Flight {
    static FlightPhase phase(Dynamics& dynamics) { return FlightPhase(dynamics); }
    static FlightPhase::State start() { return {0.0, 0.01, 0.7, 0.02, 0.05, 200.0}; }
    static constexpr double kEnd = 2e-3;
};

template <class Case>
struct Run {
    using Phase = decltype(Case::phase(std::declval<Dynamics&>()));
    typename Phase::State end;
    StepCounts counts;
    std::vector<typename Phase::State> middles;  // dense output half way through each step

    explicit Run(const StepperOptions& how, double until = Case::kEnd) {
        Setup setup;
        Phase phase = Case::phase(setup.dynamics());
        Tsit5 integrator(how);
        PhaseMemory memory;
        const PhaseEnd<Phase> result = integrator.advance(phase, memory, 0.0, until, Case::start(),
                                                          [&](const auto& step, double) {
                                                              middles.push_back(step.dense(0.5));
                                                              return kGoesOn;
                                                          });
        REQUIRE(result.status == Status::ok);
        REQUIRE(result.event == Event::none);
        end = result.y;
        counts = integrator.counts();
    }
};

// Largest difference in units of the scales of a phase.
template <class Case>
double difference(const typename Run<Case>::Phase::State& a,
                  const typename Run<Case>::Phase::State& b) {
    Setup setup;
    const auto scale = Case::phase(setup.dynamics()).scale(options(1.0, 0.0).scales);
    double largest = 0.0;
    for (std::size_t i = 0; i < scale.size(); ++i) {
        largest = std::max(largest, std::abs(a[i] - b[i]) / scale[i]);
    }
    return largest;
}

template <class Case>
void check_order_of_steps() {
    // A reference of 1/16 of the narrowest step: its error is 1e-6 of the least that is measured.
    // With wider steps the sixth order is not yet small against the fifth.
    constexpr double end = Case::kEnd;
    const auto reference = Run<Case>(fixed_steps(end / 2048)).end;
    const double wide = difference<Case>(Run<Case>(fixed_steps(end / 64)).end, reference);
    const double narrow = difference<Case>(Run<Case>(fixed_steps(end / 128)).end, reference);
    CHECK(Run<Case>(fixed_steps(end / 128)).counts.accepted == 128);
    CHECK(narrow > 1e-11);  // far from rounding
    const double order = observed_order(2.0, wide, 1.0, narrow);
    CHECK(order == doctest::Approx(5.0).epsilon(0.3 / 5.0));
}

template <class Case>
void check_order_of_dense_output() {
    // Half way through a single step from exact data the error of a fourth-order interpolant is
    // h^5, where a fifth-order one would have h^6 and a third-order one h^4.
    const double h = Case::kEnd / 256;
    const auto error = [&](double width) {
        const auto exact = Run<Case>(fixed_steps(width / 64), 0.5 * width).end;
        return difference<Case>(Run<Case>(fixed_steps(width), width).middles.front(), exact);
    };
    const double order = observed_order(2.0, error(2.0 * h), 1.0, error(h)) - 1.0;
    CHECK(order == doctest::Approx(4.0).epsilon(0.3 / 4.0));
}

template <class Case>
void check_error_control() {
    const auto reference = Run<Case>(options(1e-13, 0.0)).end;
    double previous = 1.0;
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
        const double error = difference<Case>(Run<Case>(options(tolerance, 0.0)).end, reference);
        // The estimate is of the fourth order and the step of the fifth: with h ~ tolerance^(1/5)
        // the global error goes with h^5, that is with the tolerance. Two decades of it have to
        // bring one and a half at least. The absolute size: a local error a step, over some tens
        // of steps, carried on by an oscillation.
        CHECK(error < previous / 30.0);
        CHECK(error < 100.0 * tolerance);
        previous = error;
    }
}

}  // namespace

TEST_CASE("tsit5: fixed steps converge with order five") {
    check_order_of_steps<Stick>();
    check_order_of_steps<Flight>();
}

TEST_CASE("tsit5: dense output of order four") {
    check_order_of_dense_output<Stick>();
    check_order_of_dense_output<Flight>();
}

TEST_CASE("tsit5: the global error falls with the tolerance") {
    check_error_control<Stick>();
    check_error_control<Flight>();
}

TEST_CASE("tsit5: a slide that comes near the point without solution ends before it") {
    // Known since Genot and Brogliato 1999: as the effective inertia falls to zero, friction stops
    // the slip or turns the robot so fast that it lifts off. A fast enough slip reaches neither
    // stop, and turns nose-down all the way to lift-off.
    Model model = paper_model();
    model.adhesion = 1e-6;
    for (const double mu : {1.34, 1.4, 1.5}) {
        model.friction = {mu, mu};
        for (const double slip : {0.05, 5.0}) {
            Dynamics dynamics = stickslip::test::in_uniform_field(model, 0.0, 0.0);
            CornerSlipPhase phase(dynamics, {0.0}, {1, slip});
            Tsit5 integrator(options(1e-8, 0.0));
            PhaseMemory memory;
            const CornerSlipPhase::State start = {0.0, 0.3, slip, 0.0};
            const auto end = integrator.advance(phase, memory, 0.0, 1.0, start,
                                                [](auto&&...) { return kGoesOn; });
            CHECK(end.status == Status::ok);
            CHECK(end.event == (slip > 1.0 ? Event::lift_off : Event::slip_stops));
            const Pose pose = model.shape.pose(0, std::cos(end.y[1]), std::sin(end.y[1]));
            CHECK(painleve_inertia(dynamics.robot(), pose, mu) > 0.0);
            CHECK(painleve_inertia(dynamics.robot(), pose, mu) <
                  (slip > 1.0 ? 0.1 : 1.0) * model.inertia);
        }
    }
}

TEST_CASE("flight: a gap of rounding, of either sign, is no touch-down; a larger one is") {
    const Model model = paper_model();
    Dynamics dynamics = stickslip::test::in_uniform_field(model, 1e-3, -0.6e-3);
    FlightPhase phase(dynamics);
    stickslip::test::Random random(11);
    const auto pivot_gap = [&](double angle, double gap) {
        const Pose pose = model.shape.pose(0, std::cos(angle), std::sin(angle));
        return phase.event(0, 0.0, FlightPhase::State{0.0, pose.height + gap, angle, 0, 0, 0});
    };
    for (int n = 0; n < 3000; ++n) {
        const double angle = random.between(0.0, kQuarterTurn);
        CHECK(pivot_gap(angle, random.between(-1e-19, 1e-19)) > 0.0);
        CHECK(pivot_gap(angle, -1e-17) < 0.0);
    }
}

TEST_CASE("tsit5: a slide that begins without solution jams at once") {
    Model model = paper_model();
    model.friction = {2.0, 2.0};
    Dynamics dynamics = stickslip::test::in_uniform_field(model, 0.0, 0.0);
    CornerSlipPhase phase(dynamics, {0.0}, {1, 0.05});
    const CornerSlipPhase::State start = {0.0, 0.7, 0.05, 0.0};
    phase.field().rebase(phase.place_of(0.0, start));
    CHECK(phase.nearly_jams(0.0, start));
    BodyState body = phase.body(0.0, start);
    const Resolution found =
        resolve_contact(FixedFrame(dynamics), 0.0, body, Touch::corner, {0.05}, 0);
    CHECK(found.impulse);
    const Pose pose = model.shape.pose(0, std::cos(0.7), std::sin(0.7));
    stop_slip_by_impulse(model, pose, 0.05, body);
    CHECK(body.omega > 0.0);  // nose-down over the corner
    const Resolution after = resolve_contact(FixedFrame(dynamics), 0.0, body, Touch::corner, {}, 0);
    CHECK_FALSE(after.impulse);
}

TEST_CASE("rest: after a jump of the voltage the event lies in the first time constant") {
    const Model model = paper_model();
    constexpr double kResistance = 10.0, kTimeConstant = 0.007, kVolts = -20.0;
    Circuit circuit = test::equal_coils(kResistance, kResistance * kTimeConstant, 0.0);
    const PerCoil volts = {0.0, 0.0, 0.0, 0.0, kVolts};
    const CurrentSegment segment = circuit.advance({0.0, 100.0, volts, volts});
    // What the end behind carries less for each ampere, from Eqs. (8)-(12).
    const double base = model.shape.half_base(0), rise = model.shape.half_rise(0);
    const FieldAndGradient unit = paper_coils().unit_field(Coil::clamp, {0.0, 0.0, rise});
    const double tipping = (rise * unit.gradient(0, 0) - unit.field.z()) / (2.0 * base);
    const double lost = model.moment * (0.5 * unit.gradient(2, 0) + tipping);
    const double carried = 0.5 * (model.adhesion - model.mass * model.gravity_z);
    const double expected = -kTimeConstant * std::log1p(-carried / lost / (kVolts / kResistance));
    REQUIRE(expected < 1e-3);

    LocalField field(paper_coils(), all_driven());
    field.set_segment(segment);
    Dynamics dynamics(model, field);
    FaceRestPhase rest(dynamics);
    PhaseMemory memory;
    StepperOptions options;
    options.scales = {1e-4, 1.0, 1e4};
    options.swing_rate = 1e4;
    BodyState flat;
    flat.z = rise;
    const auto end = Tsit5(options).advance(rest, memory, 0.0, segment.duration, rest.begin(flat),
                                            [](auto&&...) { return kGoesOn; });
    CHECK(end.event == Event::behind_lifts);
    // Of a step no longer than T.
    CHECK(std::abs(end.tau - expected) < 4e-12 * kTimeConstant);
}
