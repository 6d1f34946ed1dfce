#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "stickslip/drive/circuit.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::kRounding;

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

// Current and lagging current by the classical Runge-Kutta method: Eq. (1) as it is printed.
struct Reference {
    double lag;
    double current = 0.0, effective = 0.0;

    void advance(const VoltageSegment& segment, int steps) {
        const double h = (segment.end - segment.start) / steps;
        const double slope = (segment.last[0] - segment.first[0]) / (segment.end - segment.start);
        struct Rates {
            double current, effective;
        };
        const auto rates = [&](double tau, double i, double e) {
            const double voltage = segment.first[0] + slope * tau;
            return Rates{-kResistance / kInductance * i + voltage / kInductance,
                         lag > 0.0 ? (i - e) / lag : 0.0};
        };
        for (int n = 0; n < steps; ++n) {
            const double t = n * h;
            const Rates a = rates(t, current, effective);
            const Rates b = rates(t + h / 2, current + h / 2 * a.current,  //
                                  effective + h / 2 * a.effective);
            const Rates c =
                rates(t + h / 2, current + h / 2 * b.current, effective + h / 2 * b.effective);
            const Rates d = rates(t + h, current + h * c.current, effective + h * c.effective);
            current += h / 6 * (a.current + 2 * b.current + 2 * c.current + d.current);
            effective += h / 6 * (a.effective + 2 * b.effective + 2 * c.effective + d.effective);
        }
    }
};

// Ramps, a jump up, a hold, a jump through zero.
const std::vector<VoltageSegment> kProgram = {
    segment(0.0, 0.02, 0.0, 12.0), segment(0.02, 0.03, 40.0, 5.0), segment(0.03, 0.05, 5.0, 5.0),
    segment(0.05, 0.051, -30.0, 25.0)};

}  // namespace

TEST_CASE("circuit: the closed form agrees with a Runge-Kutta integration of Eq. (1)") {
    for (const double lag : {0.0, 1e-3, 0.02}) {
        CAPTURE(lag);
        Circuit circuit = test::equal_coils(kResistance, kInductance, lag);
        Reference reference{lag};
        for (const VoltageSegment& voltages : kProgram) {
            const CurrentSegment segment = circuit.advance(voltages);
            // With h = T/2000 of the shorter time constant T the method's error is (h/T)^4 / 120
            // = 5e-16 a time constant, so rounding rules: 1e-16 of 4 A in each of up to 4e4 steps.
            const double shorter = lag > 0.0 ? std::min(lag, kTimeConstant) : kTimeConstant;
            const double duration = voltages.end - voltages.start;
            reference.advance(voltages, static_cast<int>(2000 * std::ceil(duration / shorter)));
            const double expected = lag > 0.0 ? reference.effective : reference.current;
            const double tolerance = 4e4 * 4.0 * kRounding;
            CHECK(std::abs(segment.field_currents(duration)[0] - expected) < tolerance);
            CHECK(std::abs(segment.currents(duration)[0] - reference.current) < tolerance);
        }
    }
}

TEST_CASE("circuit: a coil without voltage carries no current, and coils do not mix") {
    Circuit circuit = test::equal_coils(kResistance, kInductance, 0.0);
    const CurrentSegment segment = circuit.advance(kProgram.front());
    const PerCoil currents = segment.currents(0.013);
    CHECK(currents[0] > 0.0);
    for (std::size_t k = 1; k < kCoilCount; ++k) CHECK(currents[k] == 0.0);
}

TEST_CASE("circuit: a jump of the voltage does not jump the current") {
    for (const double lag : {0.0, 1e-3, kTimeConstant, 0.02}) {
        CAPTURE(lag);
        Circuit circuit = test::equal_coils(kResistance, kInductance, lag);
        double before = 0.0;
        for (const VoltageSegment& voltages : kProgram) {
            const CurrentSegment segment = circuit.advance(voltages);
            // A sum of terms of up to 1e6 (equal constants) or 30 times the current of 4 A.
            const double largest = lag == kTimeConstant ? 3e6 * 4.0 : 30.0 * 4.0;
            CHECK(std::abs(segment.currents(0.0)[0] - before) <= 4.0 * kRounding * largest);
            before = segment.currents(segment.duration)[0];
        }
    }
}

TEST_CASE("circuit: the first harmonic of a 100 Hz voltage reaches the current with gain 0.22") {
    constexpr double period = 0.01;
    constexpr double omega = 2.0 * std::numbers::pi / period;
    const double amplitude = 20.0;
    Circuit circuit = test::equal_coils(kResistance, kInductance, 0.0);
    std::complex<double> harmonic;
    // After 30 periods exp(-0.3/0.007) = 2e-19 of the transient is left.
    for (int n = 0; n <= 30; ++n) {
        for (const bool first_half : {true, false}) {
            const double start = n * period + (first_half ? 0.0 : period / 2);
            const double volts = first_half ? amplitude : -amplitude;
            const CurrentSegment half =
                circuit.advance(segment(start, start + period / 2, volts, volts));
            if (n < 30) continue;
            // Simpson's rule over n = 400 parts: (omega h)^4 / 180 = 3e-12.
            constexpr int parts = 400;
            const double h = half.duration / parts;
            for (int i = 0; i <= parts; ++i) {
                const double weight = (i == 0 || i == parts ? 1.0 : i % 2 ? 4.0 : 2.0) * h / 3.0;
                const double phase = omega * (half.start + i * h);
                harmonic += weight * half.currents(i * h)[0] * std::polar(1.0, -phase);
            }
        }
    }
    const double current = std::abs(harmonic) * 2.0 / period;
    const double voltage = 4.0 / std::numbers::pi * amplitude;  // of a square wave
    const double gain = current / (voltage / kResistance);
    CHECK(gain == doctest::Approx(1.0 / std::hypot(1.0, omega * kTimeConstant)).epsilon(1e-10));
    CHECK(gain == doctest::Approx(0.22).epsilon(0.01));  // two digits given
}

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

CircuitParameters table_one(double inductance = kInductance, double coupling = 0.0) {
    CircuitParameters parameters;
    parameters.resistance.fill(kResistance);
    parameters.inductance.fill(inductance);
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

TEST_CASE("heated coils: at a constant voltage the resistance solves a quadratic") {
    // R/R0 = 1 + k V^2/R, and L/R = 1e-10 s takes no part of a second.
    PerCoil volts = {50.0, 0.0, 0.0, -70.0, 10.0};
    const VoltageProgram program = played({{0.0, volts}, {1.0, volts}});
    for (const double coefficient : {0.0, 1e-4, 0.01, 1.0, 1000.0}) {
        const PerCoil warm = warm_resistances(program, table_one(1e-9), coefficient);
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double power = volts[k] * volts[k] / kResistance;
            const double ratio = 0.5 + std::sqrt(0.25 + coefficient * power);
            CHECK(warm[k] == doctest::Approx(kResistance * ratio).epsilon(1e-9));
        }
        CHECK(heating_error(program, table_one(1e-9), coefficient) < 1e-12);
    }
}

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
                CircuitParameters parameters = table_one(kInductance, coupling);
                CHECK(heating_error(program, parameters, coefficient) < 1e-12);
                parameters.resistance = {8.0, 12.0, 10.0, 3.0, 40.0};
                parameters.inductance = {0.07, 0.02, 0.1, 0.07, 0.05};
                CHECK(heating_error(program, parameters, coefficient) < 1e-12);
            }
        }
    }
}

TEST_CASE("heated coils: a coil without current stays cold") {
    const VoltageProgram program = played({{0.0, {30.0}}, {1.0, {30.0}}});
    const PerCoil warm = warm_resistances(program, table_one(), 0.05);
    CHECK(warm[0] > 1.5 * kResistance);
    for (std::size_t k = 1; k < kCoilCount; ++k) CHECK(warm[k] == kResistance);
}
