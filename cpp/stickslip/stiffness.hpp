#pragma once

#include "stickslip/model.hpp"
#include "stickslip/scenario.hpp"

namespace stickslip {

/// The key that makes the fastest motion of a scenario, and how fast. Steps have to be shorter than
/// the inverse of the rate, so that one far above the swing's makes a run long, or keeps it from
/// its end.
struct Stiffness {
    const char* key = nullptr;
    double value = 0.0;
    double rate = 0.0;   ///< 1/s
    double swing = 0.0;  ///< rad/s, of the free swing about a corner in the strongest field
    double sane = 0.0;   ///< value that makes the rate a hundred times the swing's

    bool is_stiff() const;
};

Stiffness stiffness(const Scenario& scenario, const Model& model, double swing_rate);

}  // namespace stickslip
