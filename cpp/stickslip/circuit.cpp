#include "stickslip/circuit.hpp"

#include <cmath>

namespace stickslip {

PerCoil CurrentSegment::currents(double tau) const {
    PerCoil result = {};
    std::array<double, kMaxBasis> basis = {1.0, tau};
    for (int j = 0; j < exponentials; ++j) {
        basis[static_cast<std::size_t>(2 + j)] = std::exp(-rate[static_cast<std::size_t>(j)] * tau);
    }
    for (std::size_t b = 0; b < static_cast<std::size_t>(2 + exponentials); ++b) {
        for (std::size_t k = 0; k < kCoilCount; ++k) result[k] += coefficient[b][k] * basis[b];
    }
    return result;
}

Circuit::Circuit(double resistance, double inductance, double lag)
    : resistance_(resistance), time_constant_(inductance / resistance), lag_(lag) {
    // Equal time constants would need a third function, tau exp(-tau/T). A relative shift of 1e-6
    // of the lag is far below what it can be known to, and keeps one form for all.
    if (std::abs(lag_ - time_constant_) < 1e-6 * time_constant_)
        lag_ = time_constant_ * (1.0 + 1e-6);
}

CurrentSegment Circuit::advance(const VoltageSegment& segment) {
    CurrentSegment result;
    result.start = segment.start;
    result.duration = segment.end - segment.start;
    result.rate[0] = 1.0 / time_constant_;
    const bool lagging = lag_ > 0.0;
    if (lagging) {
        result.exponentials = 2;
        result.rate[1] = 1.0 / lag_;
    }
    const double decay = std::exp(-result.duration / time_constant_);
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const double slope = (segment.last[k] - segment.first[k]) / (resistance_ * result.duration);
        const double constant = segment.first[k] / resistance_ - slope * time_constant_;
        const double transient = current_[k] - constant;
        if (lagging) {
            const double level = constant - slope * lag_;
            const double through = transient / (1.0 - lag_ / time_constant_);
            result.coefficient[0][k] = level;
            result.coefficient[2][k] = through;
            result.coefficient[3][k] = effective_[k] - level - through;
        } else {
            result.coefficient[0][k] = constant;
            result.coefficient[2][k] = transient;
        }
        result.coefficient[1][k] = slope;
        current_[k] = constant + slope * result.duration + transient * decay;
    }
    effective_ = result.currents(result.duration);
    return result;
}

}  // namespace stickslip
