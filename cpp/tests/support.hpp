#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "stickslip/contact/dynamics.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/scenario.hpp"

/// Helpers that several test files share.
namespace stickslip::test {

/// Relative rounding of one operation.
inline constexpr double kRounding = std::numeric_limits<double>::epsilon();

inline const CoilSet& paper_coils() {
    static const CoilSet coils;
    return coils;
}

/// Tables I and II.
inline Model paper_model() {
    return make_model(Scenario{}, {});
}

/// Draws with a fixed seed: every run of a test sees the same numbers.
class Random {
public:
    explicit Random(std::uint64_t seed) : generator_(seed) {}

    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(generator_);
    }
    int integer(int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(generator_);
    }
    bool coin() { return integer(0, 1) == 1; }

private:
    std::mt19937_64 generator_;
};

/// Random currents of all coils, A.
inline PerCoil random_currents(Random& random) {
    PerCoil currents;
    for (double& current : currents) current = random.between(-7.0, 7.0);
    return currents;
}

/// Currents (A) that do not change.
inline CurrentSegment steady(const PerCoil& currents, double duration = 1.0) {
    CurrentSegment segment;
    segment.duration = duration;
    segment.rate[0] = 1.0;
    segment.coil[0] = segment.field[0] = currents;
    return segment;
}

inline PerCoil all_driven() {
    return {1.0, 1.0, 1.0, 1.0, 1.0};
}

/// Equal coils that are not coupled (ohm, H), and the field's lag (s).
inline Circuit equal_coils(double resistance, double inductance, double lag) {
    CircuitParameters parameters;
    parameters.resistance.fill(resistance);
    parameters.inductance.fill(inductance);
    parameters.lag = lag;
    return Circuit(parameters);
}

/// A robot in a uniform field (T), without gradient. The model has to outlive it.
inline Dynamics in_uniform_field(const Model&& model, double bx, double bz) = delete;
inline Dynamics in_uniform_field(const Model& model, double bx, double bz) {
    LocalField field(paper_coils(), {}, {bx, bz});
    field.set_segment(steady({}));
    return Dynamics(model, field);
}

/// p in error ~ h^p, from the errors at two widths.
inline double observed_order(double wide, double error_wide, double narrow, double error_narrow) {
    return std::log(error_wide / error_narrow) / std::log(wide / narrow);
}

}  // namespace stickslip::test
