#pragma once

#include <cstdint>
#include <vector>

#include "stickslip/drive/coil.hpp"

namespace stickslip {

/// A breakpoint of a piecewise-linear voltage curve.
struct VoltagePoint {
    double time = 0.0;     ///< s, from the start of the block
    PerCoil voltage = {};  ///< V
};

/// A piecewise-linear stretch of voltages that is played `repeats` times. Two points at one time
/// are a jump. The last point's time is the block's duration.
struct VoltageBlock {
    std::vector<VoltagePoint> points;
    std::int64_t repeats = 1;

    double duration() const { return points.empty() ? 0.0 : points.back().time; }
};

/// A linear stretch of the program in absolute time.
struct VoltageSegment {
    double start = 0.0;  ///< s
    double end = 0.0;    ///< s
    PerCoil first = {};  ///< V at `start`
    PerCoil last = {};   ///< V at `end`
};

/// Voltages of the five coils as a sequence of repeated blocks, so that a run of any number of
/// pulses needs the memory of one.
class VoltageProgram {
public:
    VoltageProgram() = default;

    /// Throws std::invalid_argument for an empty program, an empty or falling block, a first point
    /// that is not at time zero, a repeat count below one, or values that are not finite.
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

/// Walks through the linear stretches of a program in order; stretches of no duration are passed
/// over (they are jumps).
class SegmentCursor {
public:
    explicit SegmentCursor(const VoltageProgram& program) : program_(&program) {}

    /// Writes the next stretch and returns true, or returns false at the end of the program.
    bool next(VoltageSegment& segment);

private:
    const VoltageProgram* program_;
    std::size_t block_ = 0;
    std::size_t point_ = 0;
    std::int64_t repeat_ = 0;
    double block_start_ = 0.0;
};

/// The stretches that the coils really get: those of a program, held constant over each period of
/// the digital-to-analogue converter if it has one (the voltage at its start), and cut at marks.
class SegmentStream {
public:
    /// hold_period in s, zero: none. marks: ascending times, s.
    SegmentStream(const VoltageProgram& program, double hold_period, std::vector<double> marks);

    bool next(VoltageSegment& segment);

private:
    bool next_uncut(VoltageSegment& segment);

    SegmentCursor cursor_;
    double duration_;
    double hold_period_;
    std::vector<double> marks_;
    VoltageSegment programmed_;  // the stretch of the program that is sampled
    std::int64_t held_ = 0;      // periods of the converter so far
    VoltageSegment rest_;        // what a cut left over
    bool has_rest_ = false;
};

/// The curve, or the program, with every voltage limited to +-limit V.
std::vector<VoltagePoint> clipped(const std::vector<VoltagePoint>& curve, double limit);
VoltageProgram clipped(const VoltageProgram& program, double limit);

}  // namespace stickslip
