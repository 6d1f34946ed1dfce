#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "stickslip/run/recording.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// Summary of a run, in the world's frame. Units and meanings are in `kSummaryNumbers`; a number
/// that was not measured is NaN.
struct Summary {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

    double mean_velocity = kNone, mean_velocity_y = kNone, turning_speed = kNone;
    double theta_min = kNone, theta_max = kNone;
    double slip_up = kNone, slip_down = kNone, slip_flat = kNone;
    double airborne_fraction = kNone, velocity_growth = kNone;
    double pull_ratio = kNone, pull_share = kNone, field_change = kNone;
    double field_max = 0.0, field_min = kNone;
    double current_max = 0.0, voltage_max = 0.0, power_mean = kNone;
    double simulated_time = 0.0;
    std::array<std::int64_t, kEventKinds> events = {};
};

/// A number of a summary.
struct SummaryNumber {
    std::string_view name;
    const char* unit;  ///< SI, "1" for none
    const char* meaning;
    double Summary::*member;
};

inline constexpr auto kSummaryNumbers = std::to_array<SummaryNumber>({
    {"mean_velocity", "m/s", "mean velocity along the surface, measuring window",
     &Summary::mean_velocity},
    {"mean_velocity_y", "m/s", "the same across the x axis", &Summary::mean_velocity_y},
    {"turning_speed", "m/s",
     "mean speed at which the heading's turning to and fro swings an edge about the "
     "centre of mass, which the slip leaves out, measuring window",
     &Summary::turning_speed},
    {"theta_min", "rad", "smallest pitch angle, measuring window", &Summary::theta_min},
    {"theta_max", "rad", "largest pitch angle, measuring window", &Summary::theta_max},
    {"slip_up", "m/s", "slip of the contact while the pitch angle rises, over the window",
     &Summary::slip_up},
    {"slip_down", "m/s", "slip of the contact while the pitch angle falls, over the window",
     &Summary::slip_down},
    {"slip_flat", "m/s", "slip of the contact while a face lies flat, over the window",
     &Summary::slip_flat},
    {"airborne_fraction", "1", "part of the measuring window in flight",
     &Summary::airborne_fraction},
    {"velocity_growth", "1",
     "least growth of the speed from a quarter of the pulses to the next, over the "
     "largest speed of a quarter; 0 of a program and of fewer than four pulses",
     &Summary::velocity_growth},
    {"pull_ratio", "1",
     "largest pull of the in-plane coils' gradient on the robot, lying flat, over the "
     "friction limit of weight and adhesion",
     &Summary::pull_ratio},
    {"pull_share", "1",
     "impulse of the field's gradient on the robot along its way, over what static friction could "
     "have held of the surface's normal impulse, measuring window; asked for by record.pull_share",
     &Summary::pull_share},
    {"field_change", "1",
     "change of the field of the largest voltages from the run's first place to its "
     "last, over the first",
     &Summary::field_change},
    {"field_max", "T", "largest |B| at the robot in the whole run", &Summary::field_max},
    {"field_min", "T", "least |B| at the robot, measuring window", &Summary::field_min},
    {"current_max", "A", "largest current of any coil in the whole run", &Summary::current_max},
    {"voltage_max", "V", "largest voltage of any coil in the whole run", &Summary::voltage_max},
    {"power_mean", "W", "mean power in all coils, measuring window", &Summary::power_mean},
    {"simulated_time", "s", "simulated time", &Summary::simulated_time},
});

/// Gathers a summary phase by phase, in memory that does not grow.
class SummaryObserver {
public:
    /// period: s, from pulse to pulse; zero without pulses.
    explicit SummaryObserver(double period) : period_(period) {}

    /// end: s, of the window.
    void open(double t, double end, const BodyState& body) {
        open_ = true;
        if (period_ > 0.0) {
            const double quarter = 0.25 * std::round((end - t) / period_);
            for (std::size_t i = 0; i < marks_.size(); ++i) {
                marks_[i].pulses = std::llround(static_cast<double>(i) * quarter);
            }
        }
        marks_[0] = {0, t, body.x, body.y};
        passed_ = 1;
        start_ = t;
        start_x_ = body.x;
        start_y_ = body.y;
    }
    /// Passes the end of a segment of voltage within the window; a pulse ends with a segment.
    void pass(double t, const BodyState& body) {
        if (!(period_ > 0.0)) return;
        // Ends of segments carry rounding.
        const auto pulses =
            static_cast<std::int64_t>(std::floor((t - start_) / period_ + kRounding));
        if (pulses <= pulses_) return;
        pulses_ = pulses;
        if (passed_ < marks_.size() && pulses >= marks_[passed_].pulses) {
            marks_[passed_] = {pulses, t, body.x, body.y};
            ++passed_;
        }
    }
    void close(double t, const BodyState& body, double frame_sign, Summary& summary) {
        pass(t, body);
        open_ = false;
        const double span = t - start_;
        if (!(span > 0.0)) return;
        summary.mean_velocity = frame_sign * (body.x - start_x_) / span;
        summary.mean_velocity_y = (body.y - start_y_) / span;
        summary.theta_min = lowest_;
        summary.theta_max = highest_;
        summary.slip_up = frame_sign * rising_ / span;
        summary.slip_down = frame_sign * falling_ / span;
        summary.slip_flat = frame_sign * flat_ / span;
        summary.airborne_fraction = airborne_ / span;
        summary.velocity_growth = passed_ == marks_.size() ? growth() : 0.0;
    }
    bool is_open() const { return open_; }
    double start() const { return start_; }  ///< s

    /// Adds a phase, or its part within a segment of voltage, that took `duration` s.
    template <class Phase>
    void phase(const Phase& phase, const PhaseEnd<Phase>& end, double duration, int quadrant) {
        if (!open_) return;
        const double offset = quadrant * kQuarterTurn;
        see(offset + end.trace.lowest);
        see(offset + end.trace.highest);
        if constexpr (Phase::kSlips) {
            rising_ += end.trace.rising;
            falling_ += end.trace.falling;
            add_slip(phase.omega(end.y), phase.slip_place(end.y) - end.trace.slip_x);
        }
        if constexpr (Phase::kFlies) airborne_ += duration;
    }

private:
    void see(double theta) {
        lowest_ = std::min(lowest_, theta);
        highest_ = std::max(highest_, theta);
    }
    void add_slip(double omega, double distance) {
        (omega > 0.0 ? rising_ : omega < 0.0 ? falling_ : flat_) += distance;
    }
    double growth() const {
        std::array<double, 4> speed;
        for (std::size_t i = 0; i < speed.size(); ++i) {
            const Mark &from = marks_[i], &to = marks_[i + 1];
            speed[i] = std::hypot(to.x - from.x, to.y - from.y) / (to.t - from.t);
        }
        const double least =
            std::min({speed[1] - speed[0], speed[2] - speed[1], speed[3] - speed[2]});
        const double largest = *std::max_element(speed.begin(), speed.end());
        return largest > 0.0 ? least / largest : 0.0;
    }

    static constexpr double kRounding = 1e-6;  // part of a pulse; chosen

    double period_;
    bool open_ = false;
    std::int64_t pulses_ = 0;
    /// Time and place where a quarter of the window's pulses ends, or the first begins.
    struct Mark {
        std::int64_t pulses = 0;
        double t = 0.0, x = 0.0, y = 0.0;
    };
    std::array<Mark, 5> marks_ = {};
    std::size_t passed_ = 0;
    double start_ = 0.0, start_x_ = 0.0, start_y_ = 0.0;
    double lowest_ = std::numeric_limits<double>::infinity();
    double highest_ = -std::numeric_limits<double>::infinity();
    double rising_ = 0.0, falling_ = 0.0, flat_ = 0.0, airborne_ = 0.0;
};

}  // namespace stickslip
