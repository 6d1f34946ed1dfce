#pragma once

#include <cstdint>

#include "stickslip/body/model.hpp"
#include "stickslip/scenario/scenario.hpp"

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

/// The key that cut the time into a good part of the steps that a run may have, whatever moved.
struct StepBound {
    const char* key = nullptr;  ///< nullptr if there is none
    double value = 0.0;         ///< s
    double steps = 0.0;         ///< that it took at least
    double sane = 0.0;          ///< s, of which the whole run takes a tenth of its budget
};

/// What a run has spent.
struct Effort {
    double moving_time = 0.0;    ///< s, that was integrated
    double steps = 0.0;          ///< tried
    std::int64_t stretches = 0;  ///< of voltage, that took a step or were counted as one
};

/// What may make the steps of a scenario short.
class StepDemand {
public:
    /// swing_rate: rad/s; duration: s, of the whole run.
    StepDemand(const Scenario& scenario, const Model& model, double swing_rate, double duration);

    /// In a run that has come to an early end.
    Stiffness stiffness(const Effort& effort) const;
    StepBound bound(const Effort& effort) const;

private:
    Stiffness lasting_;  // of motions that go on
    Stiffness passing_;  // also of those that the body leaves as fast
    double swing_;
    double hold_period_, max_step_, duration_, most_steps_;
};

}  // namespace stickslip
