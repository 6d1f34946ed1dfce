#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "stickslip/drive/circuit.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

// Table I.
constexpr double kResistance = 10.0;
constexpr double kInductance = 0.07;
constexpr double kTimeConstant = kInductance / kResistance;

VoltageSegment segment(double start, double end, double first, double last) {
    VoltageSegment segment{start, end, {}, {}};
    segment.first[0] = first;
    segment.last[0] = last;
    return segment;
}

// Ramps, a jump up, a hold, a jump through zero.
const std::vector<VoltageSegment> kProgram = {
    segment(0.0, 0.02, 0.0, 12.0), segment(0.02, 0.03, 40.0, 5.0), segment(0.03, 0.05, 5.0, 5.0),
    segment(0.05, 0.051, -30.0, 25.0)};

}  // namespace

TEST_CASE("circuit: a lag equal to L/R") {
    // The step response is 1 - (1 + u) exp(-u) with u = t / T. Its derivative by ln(lag) is at most
    // u^2/2 exp(-u) = 0.271 (at u = 2), so the shift by 1e-6 that keeps the form costs 2.8e-7.
    const double time = 2.0 * kTimeConstant;
    const auto response = [&](double lag) {
        Circuit circuit = test::equal_coils(kResistance, kInductance, lag);
        return circuit.advance(segment(0.0, 0.1, 10.0, 10.0)).field_currents(time)[0];
    };
    const double expected = 1.0 - 3.0 * std::exp(-2.0);
    CHECK(std::abs(response(kTimeConstant) - expected) < 2.8e-7);
    // From either side; between, the shift is no more than twice as large.
    for (const double shift : {-3e-6, -0.9e-6, -1e-9, 1e-9, 0.9e-6, 3e-6}) {
        CAPTURE(shift);
        const double lag = kTimeConstant * (1.0 + shift);
        CHECK(std::abs(response(lag) - expected) < 0.28 * (std::abs(shift) + 2e-6));
    }
}

TEST_CASE("circuit: a lag that is far shorter than anything else is no lag") {
    Circuit with = test::equal_coils(kResistance, kInductance, 1e-9);
    Circuit without = test::equal_coils(kResistance, kInductance, 0.0);
    for (const VoltageSegment& voltages : kProgram) {
        const double middle = 0.5 * (voltages.end - voltages.start);
        // The field is late by the lag: 1e-9 s times the current's rate of at most 70 V / L.
        const double difference = with.advance(voltages).field_currents(middle)[0] -
                                  without.advance(voltages).currents(middle)[0];
        CHECK(std::abs(difference) < 1.01 * 1e-9 * 70.0 / kInductance);
    }
}

namespace {

CircuitParameters table_one(double coupling) {
    CircuitParameters parameters;
    parameters.resistance.fill(kResistance);
    parameters.inductance.fill(kInductance);
    parameters.coupling = coupling;
    return parameters;
}

VoltageProgram played(std::vector<VoltagePoint> points, std::int64_t repeats = 1) {
    return VoltageProgram({{std::move(points), repeats}});
}

// |R/R0 - 1 - k P| of the coil where it is largest, over R/R0; P from the currents of warm coils.
double heating_error(const VoltageProgram& program, CircuitParameters parameters,
                     double coefficient) {
    const PerCoil cold = parameters.resistance;
    const PerCoil warm = warm_resistances(program, parameters, coefficient);
    parameters.resistance = warm;
    const PerCoil squared = mean_square_currents(program, parameters);
    double worst = 0.0;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const double ratio = warm[k] / cold[k];
        const double error = ratio - 1.0 - coefficient * warm[k] * squared[k];
        worst = std::max(worst, std::abs(error) / ratio);
    }
    return worst;
}

}  // namespace

TEST_CASE("heated coils: the power is that of the warm coils, pulsed, coupled or both") {
    // Faster and slower than L/R. (Currents over segments far shorter than L/R are small
    // differences, whose squares carry rounding of (L/R over the segment)^2.)
    for (const double period : {2e-3, 0.02, 1.0}) {
        const PerCoil off = {}, on = {60.0, -20.0, 0.0, 5.0, 40.0};
        const VoltageProgram program =
            played({{0.0, off}, {0.3 * period, on}, {0.3 * period, off}, {period, on}}, 50);
        for (const double coupling : {0.0, 0.2, -0.15}) {
            for (const double coefficient : {1e-3, 0.02, 5.0, 1000.0}) {
                CAPTURE(period);
                CAPTURE(coupling);
                CAPTURE(coefficient);
                CircuitParameters parameters = table_one(coupling);
                CHECK(heating_error(program, parameters, coefficient) < 1e-12);
                parameters.resistance = {8.0, 12.0, 10.0, 3.0, 40.0};
                parameters.inductance = {0.07, 0.02, 0.1, 0.07, 0.05};
                CHECK(heating_error(program, parameters, coefficient) < 1e-12);
            }
        }
    }
}
