#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "stickslip/drive/control_steps.hpp"
#include "stickslip/drive/voltage_program.hpp"

namespace stickslip {

/// Where a run has its segments of voltage from: the drive of its scenario or, once `play_steps`
/// was called, steps from outside.
class SegmentSource {
public:
    /// hold_period: s, of the digital-to-analogue converter; zero: none. marks: s, where segments
    /// have to end besides.
    SegmentSource(const VoltageProgram& program, double hold_period,
                  const std::vector<double>& marks)
        : segments_(program, hold_period, marks) {}

    /// `on_step` is called at the end of each step.
    void play_steps(const ControlSteps& steps, std::function<void()> on_step) {
        steps_.emplace(steps);
        on_step_ = std::move(on_step);
    }
    bool is_stepped() const { return steps_.has_value(); }
    ControlSteps& steps() { return *steps_; }
    const ControlSteps& steps() const { return *steps_; }

    /// Writes the next segment and returns true; false where all is played. The segment before it
    /// has ended.
    bool next(VoltageSegment& voltages) {
        if (!steps_) return segments_.next(voltages);
        if (step_is_open_ && steps_->ends_step()) {
            step_is_open_ = false;
            on_step_();
        }
        if (!steps_->next(voltages)) return false;
        step_is_open_ = true;
        return true;
    }
    /// Goes on from other steps, none of them open.
    void restore(const ControlSteps::Memory& memory) {
        steps_->restore(memory);
        step_is_open_ = false;
    }

private:
    SegmentStream segments_;
    std::optional<ControlSteps> steps_;
    std::function<void()> on_step_;
    bool step_is_open_ = false;
};

}  // namespace stickslip
