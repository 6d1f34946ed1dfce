#include "stickslip/drive/control_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stickslip {
namespace {

bool exceeds(const PerCoil& voltages, double limit) {
    return std::any_of(voltages.begin(), voltages.end(),
                       [limit](double each) { return std::abs(each) > limit; });
}

}  // namespace

void ControlSteps::give(const double* voltages, std::size_t count, double duration, bool linear) {
    if (duration != memory_.duration) {
        // Products, not running sums: the hundredth step starts as exactly as the first.
        memory_.origin = time();
        memory_.steps = 0;
        memory_.duration = duration;
    }
    rows_ = voltages;
    left_ = count;
    linear_ = linear;
}

bool ControlSteps::next(VoltageSegment& segment) {
    if (pending_.empty()) {
        if (left_ == 0) return false;
        --left_;
        begin_step(rows_);
        rows_ += kCoilCount;
    }
    segment = pending_.back();
    pending_.pop_back();
    return true;
}

void ControlSteps::begin_step(const double* row) {
    PerCoil target;
    std::copy_n(row, target.size(), target.begin());
    if (turned_) target = turned(target);
    const double start = time();
    ++memory_.steps;
    const VoltageSegment asked = {start, time(), linear_ ? memory_.last : target, target};
    memory_.last = target;
    add(asked);
    std::reverse(pending_.begin(), pending_.end());
}

// As the amplifiers give it.
void ControlSteps::add(const VoltageSegment& asked) {
    if (limit_ == 0.0 || !(exceeds(asked.first, limit_) || exceeds(asked.last, limit_))) {
        hold(asked);
        return;
    }
    const std::vector<VoltagePoint> points = clipped(
        std::vector<VoltagePoint>{{asked.start, asked.first}, {asked.end, asked.last}}, limit_);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const VoltagePoint &from = points[i], &to = points[i + 1];
        if (to.time > from.time) hold({from.time, to.time, from.voltage, to.voltage});
    }
}

// As the converter gives it: the voltage at the start of each of its periods.
void ControlSteps::hold(const VoltageSegment& given) {
    if (hold_period_ == 0.0) {
        pending_.push_back(given);
        return;
    }
    constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
    double t = given.start;
    while (t < given.end) {
        const double instant = static_cast<double>(memory_.held) * hold_period_;
        const double slack = std::max(1e-9 * hold_period_, kRounding * instant);
        if (instant >= given.end - slack) {
            pending_.push_back({t, given.end, memory_.held_voltage, memory_.held_voltage});
            return;
        }
        if (instant > t + slack) {
            pending_.push_back({t, instant, memory_.held_voltage, memory_.held_voltage});
            t = instant;
        }
        const double part = std::max(instant - given.start, 0.0) / (given.end - given.start);
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            memory_.held_voltage[k] = given.first[k] + part * (given.last[k] - given.first[k]);
        }
        ++memory_.held;
    }
}

}  // namespace stickslip
