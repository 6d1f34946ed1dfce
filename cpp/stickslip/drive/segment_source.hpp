#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "stickslip/drive/control_steps.hpp"
#include "stickslip/drive/voltage_program.hpp"

namespace stickslip {

/// Source of a run's segments of voltage: the drive of its scenario or, once `play_steps` was
/// called, steps from outside.
class SegmentSource {
public:
    /// hold_period: s, of the digital-to-analogue converter; zero: none. latency: s, of the
    /// voltages. marks: s, where segments have to end besides. next_kink(after): the first such
    /// time after another, of what repeats.
    SegmentSource(const VoltageProgram& program, double hold_period, double latency,
                  const std::vector<double>& marks, std::function<double(double)> next_kink)
        : segments_(program, hold_period, latency, marks), next_kink_(std::move(next_kink)) {}

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
        if (has_rest_) {
            voltages = rest_;
            has_rest_ = false;
        } else if (!next_whole(voltages)) {
            return false;
        }
        const double slack = boundary_slack(voltages.end - voltages.start);
        const double kink = next_kink_(voltages.start + slack);
        if (kink < voltages.end - slack) {
            const PerCoil volts = voltage_at(voltages, kink);
            rest_ = {kink, voltages.end, volts, voltages.last};
            has_rest_ = true;
            voltages = {voltages.start, kink, voltages.first, volts};
        }
        return true;
    }
    /// Goes on from the memory of other steps, none of them open.
    void restore(const ControlSteps::Memory& memory) {
        steps_->restore(memory);
        step_is_open_ = has_rest_ = false;
    }

private:
    bool next_whole(VoltageSegment& voltages) {
        if (!steps_) return segments_.next(voltages);
        if (step_is_open_ && steps_->ends_step()) {
            step_is_open_ = false;
            on_step_();
        }
        if (!steps_->next(voltages)) return false;
        step_is_open_ = true;
        return true;
    }
    SegmentStream segments_;
    std::function<double(double)> next_kink_;
    VoltageSegment rest_;  // behind a kink
    bool has_rest_ = false;
    std::optional<ControlSteps> steps_;
    std::function<void()> on_step_;
    bool step_is_open_ = false;
};

}  // namespace stickslip
