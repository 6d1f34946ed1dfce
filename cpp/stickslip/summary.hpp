#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "stickslip/recording.hpp"

namespace stickslip {

/// What a run comes to, in the world's frame. Velocities, angles and the flown part are taken over
/// the measuring window; counts over the whole run.
struct Summary {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // not measured

    double mean_velocity = kNone;  ///< m/s, section VII
    double theta_min = kNone;      ///< rad
    double theta_max = kNone;      ///< rad
    double slip_up = kNone;  ///< m/s, slip of the contact while theta rises, over the window's span
    double slip_down = kNone;  ///< m/s, the same while theta falls
    double slip_flat = kNone;  ///< m/s, the same of a face
    double airborne_fraction = kNone;
    double simulated_time = 0.0;  ///< s
    std::array<std::int64_t, kEventKinds> events = {};
};

/// Gathers a summary step by step, in memory that does not grow.
class SummaryObserver {
public:
    void open(double t, double x) {
        open_ = true;
        start_ = t;
        start_x_ = x;
    }
    void close(double t, double x, double frame_sign, Summary& summary) {
        open_ = false;
        const double span = t - start_;
        if (!(span > 0.0)) return;
        summary.mean_velocity = frame_sign * (x - start_x_) / span;
        summary.theta_min = lowest_;
        summary.theta_max = highest_;
        summary.slip_up = frame_sign * rising_ / span;
        summary.slip_down = frame_sign * falling_ / span;
        summary.slip_flat = frame_sign * flat_ / span;
        summary.airborne_fraction = airborne_ / span;
    }
    bool is_open() const { return open_; }

    /// Rest at an angle of quadrant pi/2.
    void rest(double theta) {
        if (open_) see(theta);
    }

    /// The part [0, s] of a step of a phase.
    template <class Phase, class Step>
    void step(const Phase& phase, const Step& step, double s, int quadrant) {
        if (!open_) return;
        const auto last = s == 1.0 ? step.last : step.dense(s);
        const double offset = quadrant * kQuarterTurn;
        see(offset + phase.angle(step.first));
        see(offset + phase.angle(last));
        const double omega_first = phase.omega(step.first), omega_last = phase.omega(last);
        auto middle = last;
        const bool turns = omega_first * omega_last < 0.0;
        if (turns) {
            middle = step.dense(turning_point(phase, step, s, omega_first, omega_last));
            see(offset + phase.angle(middle));
        }
        if constexpr (Phase::kSlips) {
            const double at_middle = phase.contact_x(middle);
            add_slip(omega_first != 0.0 ? omega_first : omega_last,
                     at_middle - phase.contact_x(step.first));
            if (turns) add_slip(omega_last, phase.contact_x(last) - at_middle);
        }
        if constexpr (Phase::kFlies) airborne_ += s * step.width;
    }

private:
    void see(double theta) {
        lowest_ = std::min(lowest_, theta);
        highest_ = std::max(highest_, theta);
    }
    void add_slip(double omega, double distance) {
        (omega > 0.0 ? rising_ : omega < 0.0 ? falling_ : flat_) += distance;
    }
    // Where omega changes sign. theta is stationary there, so a few secants find its extreme to
    // rounding.
    template <class Phase, class Step>
    static double turning_point(const Phase& phase, const Step& step, double high, double at_low,
                                double at_high) {
        double low = 0.0, s = high;
        for (int i = 0; i < 5; ++i) {
            s = low + (high - low) * at_low / (at_low - at_high);
            const double at_s = phase.omega(step.dense(s));
            if (at_s * at_low > 0.0) {
                low = s, at_low = at_s;
                at_high *= 0.5;
            } else {
                high = s, at_high = at_s;
                at_low *= 0.5;
            }
            if (at_s == 0.0) break;
        }
        return s;
    }

    bool open_ = false;
    double start_ = 0.0, start_x_ = 0.0;
    double lowest_ = std::numeric_limits<double>::infinity();
    double highest_ = -std::numeric_limits<double>::infinity();
    double rising_ = 0.0, falling_ = 0.0, flat_ = 0.0, airborne_ = 0.0;
};

}  // namespace stickslip
