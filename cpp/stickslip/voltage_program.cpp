#include "stickslip/voltage_program.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace stickslip {
namespace {

void check_block(const VoltageBlock& block, std::size_t index) {
    const std::string where = "voltage block " + std::to_string(index + 1) + ": ";
    if (block.points.size() < 2) throw std::invalid_argument(where + "needs at least two points");
    if (block.repeats < 1) {
        throw std::invalid_argument(where + "repeats = " + std::to_string(block.repeats) +
                                    ", allowed is 1 or more");
    }
    if (block.points.front().time != 0.0) {
        throw std::invalid_argument(
            where + "the first point is at t = " + std::to_string(block.points.front().time) +
            " s, it has to be at 0");
    }
    double previous = 0.0;
    for (const VoltagePoint& point : block.points) {
        if (!std::isfinite(point.time) || point.time < previous) {
            throw std::invalid_argument(where + "t = " + std::to_string(point.time) +
                                        " s follows " + std::to_string(previous) +
                                        " s, times have to be finite and must not fall");
        }
        previous = point.time;
        for (const double voltage : point.voltage) {
            if (!std::isfinite(voltage)) {
                throw std::invalid_argument(
                    where + "a voltage at t = " + std::to_string(point.time) + " s is not finite");
            }
        }
    }
    if (!(previous > 0.0)) throw std::invalid_argument(where + "has no duration");
}

}  // namespace

VoltageProgram::VoltageProgram(std::vector<VoltageBlock> blocks) : blocks_(std::move(blocks)) {
    if (blocks_.empty()) throw std::invalid_argument("the voltage program is empty");
    for (std::size_t index = 0; index < blocks_.size(); ++index) {
        const VoltageBlock& block = blocks_[index];
        check_block(block, index);
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
        if (to.time == from.time) continue;
        // A product, not a running sum: the hundredth pulse starts as exactly as the first.
        const double origin = block_start_ + block.duration() * static_cast<double>(repeat_);
        segment = {origin + from.time, origin + to.time, from.voltage, to.voltage};
        return true;
    }
    return false;
}

}  // namespace stickslip
