#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace stickslip {

/// Displacements pulse by pulse, and where they go on so steadily that the rest of the measuring
/// window need not be simulated: what is left is extrapolated along a line.
///
/// The displacements of the last pulses are averaged over three blocks of equal length. Their
/// second difference bounds what a line misses if the curvature stays; a motion of another period
/// than the pulses', or one that still settles, has a large one and is simulated on.
class SteadyPulses {
public:
    /// start, period: s, of the pulses; first, count: pulses before the window and in all; error:
    /// m/s, allowed of the mean velocity, at 0 nothing is extrapolated.
    SteadyPulses(double start, double period, std::size_t first, std::size_t count, double error)
        : start_(start),
          period_(period),
          first_(first),
          count_(count),
          allowed_(error * period * static_cast<double>(count - std::min(first, count))) {}

    /// Where a stretch of voltage ends; a pulse ends with a stretch.
    void pass(double t, double x) {
        if (!(allowed_ > 0.0)) return;
        const double pulses = std::floor((t - start_) / period_ + kRounding);
        if (pulses < 0.0 || pulses == static_cast<double>(place_.size()) - 1.0) return;
        place_.push_back(x);
    }

    /// Displacement over the whole window, m, once it is known well enough.
    std::optional<double> displacement() const {
        if (!(allowed_ > 0.0) || place_.size() < kFewest + 1) return std::nullopt;
        const std::size_t done = place_.size() - 1;
        if (done <= first_ || done >= count_ || count_ - done > done) return std::nullopt;
        const std::size_t block = (done - 1) / 3;
        const auto mean = [&](std::size_t number) {
            const std::size_t end = done - number * block;
            return (place_[end] - place_[end - block]) / static_cast<double>(block);
        };
        const double last = mean(0), slope = last - mean(1), bend = slope - (mean(1) - mean(2));
        // In blocks: those that are left, and the sums of their distances from the last one and of
        // what a constant curvature adds.
        const double left = static_cast<double>(count_ - done) / static_cast<double>(block);
        const double size = static_cast<double>(block);
        const double along = slope * size * left * (left + 1.0) / 2.0;
        const double missed = bend * size * left * (left + 1.0) * (left + 2.0) / 6.0;
        if (!(std::abs(missed) <= allowed_ && std::abs(along) <= kLargestTrend * allowed_)) {
            return std::nullopt;
        }
        return place_[done] - place_[first_] + last * size * left + along;
    }

private:
    static constexpr double kRounding = 1e-6;  // part of a pulse; chosen
    // The first pulse begins from rest and is of another kind than those after it.
    static constexpr std::size_t kFewest = 4;
    // How much more than the error the trend may add. Chosen: a motion whose pulses differ by
    // chance then hardly passes, and a robot that slowly walks out of the field does.
    static constexpr double kLargestTrend = 4.0;

    double start_, period_;
    std::size_t first_, count_;
    double allowed_;             // m, over the window
    std::vector<double> place_;  // m, at the start and at the end of each pulse
};

}  // namespace stickslip
