#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "stickslip/drive/coil.hpp"

namespace stickslip {

/// A breakpoint of a piecewise-linear voltage curve.
struct VoltagePoint {
    double time = 0.0;     ///< s, from the start of the block
    PerCoil voltage = {};  ///< V
};

/// Linear pieces of voltage that are played `repeats` times. Two points at one time
/// are a jump. The last point's time is the block's duration.
struct VoltageBlock {
    std::vector<VoltagePoint> points;
    std::int64_t repeats = 1;

    double duration() const { return points.empty() ? 0.0 : points.back().time; }
};

/// A linear segment of the program in absolute time.
struct VoltageSegment {
    double start = 0.0;  ///< s
    double end = 0.0;    ///< s
    PerCoil first = {};  ///< V at `start`
    PerCoil last = {};   ///< V at `end`
};

/// Rounding of the boundaries of segments in a span of time, s.
inline double boundary_slack(double span) {
    return 1e-9 * span;
}

/// Voltages of the five coils as a sequence of repeated blocks, so that a run of any number of
/// pulses needs the memory of one.
class VoltageProgram {
public:
    VoltageProgram() = default;

    /// Times that fall by rounding are made equal. Throws std::invalid_argument for an empty
    /// program, a block of less than two points, without a duration, that falls or does not begin
    /// at zero, a repeat count below one, or values that are not finite.
    explicit VoltageProgram(std::vector<VoltageBlock> blocks);

    const std::vector<VoltageBlock>& blocks() const { return blocks_; }
    double duration() const { return duration_; }  ///< s

    /// Largest |voltage| of each coil over the program, V; zero marks a coil that is never driven.
    const PerCoil& largest_voltage() const { return largest_; }

private:
    std::vector<VoltageBlock> blocks_;
    double duration_ = 0.0;
    PerCoil largest_ = {};
};

/// Walks through the linear segments of a program in order; segments of no duration are passed
/// over (they are jumps).
class SegmentCursor {
public:
    explicit SegmentCursor(const VoltageProgram& program) : program_(&program) {}

    /// Writes the next segment and returns true, or returns false at the end of the program.
    bool next(VoltageSegment& segment);

private:
    const VoltageProgram* program_;
    std::size_t block_ = 0;
    std::size_t point_ = 0;
    std::int64_t repeat_ = 0;
    double block_start_ = 0.0;
};

/// Voltages at a time of a segment, s.
PerCoil voltage_at(const VoltageSegment& segment, double t);

/// The digital-to-analogue converter: over each of its periods it holds the voltage that was asked
/// for at the period's start.
class SampleHold {
public:
    struct Memory {
        std::int64_t held = 0;  ///< periods so far
        PerCoil voltage = {};   ///< V
    };
    /// period: s, zero: the voltages are given as they are asked for.
    explicit SampleHold(double period) : period_(period) {}

    /// Writes the next segment that is given. `asked(segment)` writes the next one that is asked
    /// for and returns true, or false where none is for now; then what is held ends there, and
    /// false is returned after it.
    template <class Asked>
    bool next(Asked&& asked, VoltageSegment& segment) {
        if (period_ == 0.0) return asked(segment);
        const auto hold_until = [&](double end) {
            segment = {time_, end, memory_.voltage, memory_.voltage};
            time_ = end;
            return true;
        };
        while (true) {
            // Ends of segments carry rounding: a period that divides the pulse meets its jumps
            // but for that, and then holds what follows.
            constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
            const double instant = static_cast<double>(memory_.held) * period_;
            const double slack = std::max(boundary_slack(period_), kRounding * instant);
            if (instant < asked_.end - slack) {
                if (instant > time_ + slack) return hold_until(instant);
                memory_.voltage = voltage_at(asked_, std::max(instant, asked_.start));
                ++memory_.held;
            } else if (!asked(asked_)) {
                return asked_.end > time_ && hold_until(asked_.end);
            }
        }
    }

    const Memory& memory() const { return memory_; }
    /// Goes on from a memory at `time`, s, with no segment open.
    void restore(const Memory& memory, double time) {
        memory_ = memory;
        asked_.end = time_ = time;
    }

private:
    double period_;
    Memory memory_;
    VoltageSegment asked_;  // the segment that is sampled
    double time_ = 0.0;     // s, where the last segment that was given ends
};

/// The segments that the coils get of a program, cut at marks.
class SegmentStream {
public:
    /// hold_period in s, zero: none. latency: s, without a voltage before the first. marks:
    /// ascending times, s.
    SegmentStream(const VoltageProgram& program, double hold_period, double latency,
                  std::vector<double> marks)
        : cursor_(program),
          duration_(latency + program.duration()),
          hold_(hold_period),
          latency_(latency),
          marks_(std::move(marks)),
          rest_{0.0, latency, {}, {}},
          has_rest_(latency > 0.0) {}

    bool next(VoltageSegment& segment);

private:
    bool take(VoltageSegment& segment);

    SegmentCursor cursor_;
    double duration_;
    SampleHold hold_;
    double latency_;
    std::vector<double> marks_;
    VoltageSegment rest_;  // remainder of a segment that was cut
    bool has_rest_;
};

/// The curve, or the program, with every voltage limited to +-limit V.
std::vector<VoltagePoint> clipped(const std::vector<VoltagePoint>& curve, double limit);
VoltageProgram clipped(const VoltageProgram& program, double limit);

}  // namespace stickslip
