#include <doctest/doctest.h>

#include <cmath>

#include "stickslip/contact/face_phases.hpp"
#include "stickslip/solver/tsit5.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::all_driven;
using stickslip::test::paper_coils;
using stickslip::test::paper_model;

TEST_CASE("rest: after a jump of the voltage the event lies in the first time constant") {
    const Model model = paper_model();
    constexpr double kResistance = 10.0, kTimeConstant = 0.007, kVolts = -20.0;
    Circuit circuit = test::equal_coils(kResistance, kResistance * kTimeConstant, 0.0);
    const PerCoil volts = {0.0, 0.0, 0.0, 0.0, kVolts};
    const CurrentSegment segment = circuit.advance({0.0, 100.0, volts, volts});
    // Load lost by the rear end per ampere, from Eqs. (8)-(12).
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
    // Resolution of a root in a step no longer than T.
    CHECK(std::abs(end.tau - expected) < 4e-12 * kTimeConstant);
}
