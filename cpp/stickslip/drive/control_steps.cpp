#include "stickslip/drive/control_steps.hpp"

#include <algorithm>

namespace stickslip {
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

// Writes the next segment of the step that is played, before the latency; false after its last.
bool ControlSteps::next_asked(VoltageSegment& segment) {
    const auto next_of_step = [this](VoltageSegment& asked) {
        if (asked_.empty()) return false;
        asked = asked_.back();
        asked_.pop_back();
        return true;
    };
    return hold_.next(next_of_step, segment);
}

bool ControlSteps::begin_next() {
    if (left_ == 0) return false;
    --left_;
    begin_step(rows_);
    rows_ += kCoilCount;
    return true;
}

bool ControlSteps::next(VoltageSegment& segment) {
    if (latency_ == 0.0) {
        while (!next_asked(segment)) {
            if (!begin_next()) return false;
        }
        given_until_ = segment.end;
        return true;
    }
    if (given_until_ == time()) {
        if (!begin_next()) return false;
        for (VoltageSegment asked; next_asked(asked);) {
            memory_.late.push_back(
                {asked.start + latency_, asked.end + latency_, asked.first, asked.last});
        }
    }
    // The part of a segment beyond the end of the step stays in `late`.
    VoltageSegment& first = memory_.late.front();
    segment = {given_until_, first.end, first.first, first.last};
    const double slack = boundary_slack(memory_.duration);
    if (first.end > time() + slack) {
        segment.last = voltage_at(first, time());
        first.start = time();
        first.first = segment.last;
    } else {
        memory_.late.erase(memory_.late.begin());
    }
    if (segment.end > time() - slack) segment.end = time();
    given_until_ = segment.end;
    return true;
}

void ControlSteps::begin_step(const double* row) {
    PerCoil target;
    std::copy_n(row, target.size(), target.begin());
    if (turned_) target = turned(target);
    const double start = time();
    ++memory_.steps;
    std::vector<VoltagePoint> points = {{start, linear_ ? memory_.last : target}, {time(), target}};
    memory_.last = target;
    if (limit_ > 0.0) points = clipped(points, limit_);  // as the amplifiers give them
    for (std::size_t i = points.size() - 1; i > 0; --i) {
        const VoltagePoint &from = points[i - 1], &to = points[i];
        if (i == 1 || to.time > from.time) {
            asked_.push_back({from.time, to.time, from.voltage, to.voltage});
        }
    }
}

}  // namespace stickslip
