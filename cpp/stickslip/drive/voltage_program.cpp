#include "stickslip/drive/voltage_program.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "stickslip/numbers/number_text.hpp"

namespace stickslip {
namespace {

// Part of a time by which sums of times may be rounded. Chosen: a thousand sums of doubles.
constexpr double kRounding = 1e-12;

// A time that falls by rounding becomes the one before it.
void check_block(VoltageBlock& block) {
    const std::size_t count = block.points.size();
    std::size_t k = 0;
    const auto refuse = [&](const std::string& why) {
        throw std::invalid_argument("point " + std::to_string(k + 1) +
                                    ": t = " + digits(block.points[k].time) + why);
    };
    if (count < 2) {
        throw std::invalid_argument("voltages: " + std::to_string(count) +
                                    " points; allowed are two or more");
    }
    if (block.repeats < 1) {
        throw std::invalid_argument("repeats = " + std::to_string(block.repeats) +
                                    ": allowed is 1 or more");
    }
    for (double risen = 0.0; k < count; ++k) {
        auto& [time, volts] = block.points[k];
        const auto finite = [](double volt) { return std::isfinite(volt); };
        if (k == 0 && time != 0.0) refuse(": the first time has to be at 0 s");
        if (!std::isfinite(time)) refuse(": allowed are finite times");
        if (!std::all_of(volts.begin(), volts.end(), finite)) refuse(": a voltage is not finite");
        if (risen - time > kRounding * risen) {
            refuse(" s follows " + digits(risen) + " s: times must not fall");
        }
        risen = time = std::max(risen, time);
        if (k + 1 == count && time == 0.0) refuse(": no duration; allowed is above 0 s");
    }
}

// Parts of a segment, 0 to 1, at which some coil's voltage meets +-limit.
std::vector<double> crossings(const PerCoil& from, const PerCoil& to, double limit) {
    std::vector<double> parts;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        for (const double bound : {-limit, limit}) {
            const double part = (bound - from[k]) / (to[k] - from[k]);
            if (part > 0.0 && part < 1.0) parts.push_back(part);
        }
    }
    std::sort(parts.begin(), parts.end());
    return parts;
}

}  // namespace

PerCoil voltage_at(const VoltageSegment& segment, double t) {
    const double part = (t - segment.start) / (segment.end - segment.start);
    PerCoil result;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        result[k] = segment.first[k] + part * (segment.last[k] - segment.first[k]);
    }
    return result;
}

VoltageProgram::VoltageProgram(std::vector<VoltageBlock> blocks) : blocks_(std::move(blocks)) {
    if (blocks_.empty()) throw std::invalid_argument("the voltage program is empty");
    for (VoltageBlock& block : blocks_) {
        try {
            check_block(block);
        } catch (const std::invalid_argument& error) {
            if (blocks_.size() == 1) throw;
            const auto number = &block - blocks_.data() + 1;
            throw std::invalid_argument("block " + std::to_string(number) + ": " + error.what());
        }
        duration_ += block.duration() * static_cast<double>(block.repeats);
        for (const VoltagePoint& point : block.points) {
            for (std::size_t coil = 0; coil < kCoilCount; ++coil) {
                largest_[coil] = std::max(largest_[coil], std::abs(point.voltage[coil]));
            }
        }
    }
}

bool SegmentCursor::next(VoltageSegment& segment) {
    const std::vector<VoltageBlock>& blocks = program_->blocks();
    while (block_ < blocks.size()) {
        const VoltageBlock& block = blocks[block_];
        if (point_ + 1 == block.points.size()) {
            point_ = 0;
            if (++repeat_ == block.repeats) {
                block_start_ += block.duration() * static_cast<double>(block.repeats);
                repeat_ = 0;
                ++block_;
            }
            continue;
        }
        const VoltagePoint& from = block.points[point_];
        const VoltagePoint& to = block.points[point_ + 1];
        ++point_;
        // Too short for the voltage to matter, and for times far from zero to resolve: a jump.
        if (to.time - from.time <= kRounding * block.duration()) continue;
        // A product, not a running sum: the hundredth pulse starts as exactly as the first.
        const double origin = block_start_ + block.duration() * static_cast<double>(repeat_);
        segment = {origin + from.time, origin + to.time, from.voltage, to.voltage};
        return true;
    }
    return false;
}

bool SegmentStream::take(VoltageSegment& segment) {
    if (!hold_.next([&](VoltageSegment& asked) { return cursor_.next(asked); }, segment)) {
        return false;
    }
    segment.start += latency_;
    segment.end += latency_;
    return true;
}

bool SegmentStream::next(VoltageSegment& segment) {
    if (has_rest_) {
        segment = rest_;
        has_rest_ = false;
    } else if (!take(segment)) {
        return false;
    }
    const double slack = boundary_slack(duration_);
    for (const double mark : marks_) {
        if (mark <= segment.start + slack || mark >= segment.end - slack) continue;
        const PerCoil volts = voltage_at(segment, mark);
        rest_ = {mark, segment.end, volts, segment.last};
        has_rest_ = true;
        segment = {segment.start, mark, segment.first, volts};
        break;
    }
    return true;
}

std::vector<VoltagePoint> clipped(const std::vector<VoltagePoint>& curve, double limit) {
    std::vector<VoltagePoint> points;
    for (const VoltagePoint& point : curve) {
        if (!points.empty() && point.time > points.back().time) {
            const VoltagePoint from = points.back();
            const VoltageSegment segment{from.time, point.time, from.voltage, point.voltage};
            for (const double part : crossings(from.voltage, point.voltage, limit)) {
                const double t = from.time + part * (point.time - from.time);
                points.push_back({t, voltage_at(segment, t)});
            }
        }
        points.push_back(point);
    }
    for (VoltagePoint& point : points) {
        for (double& volts : point.voltage) volts = std::clamp(volts, -limit, limit);
    }
    return points;
}

VoltageProgram clipped(const VoltageProgram& program, double limit) {
    std::vector<VoltageBlock> blocks = program.blocks();
    for (VoltageBlock& block : blocks) block.points = clipped(block.points, limit);
    return VoltageProgram(std::move(blocks));
}

}  // namespace stickslip
