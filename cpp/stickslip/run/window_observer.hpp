#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "stickslip/numbers/function_ref.hpp"
#include "stickslip/run/drive_observer.hpp"
#include "stickslip/run/player.hpp"
#include "stickslip/run/summary.hpp"

namespace stickslip {

/// Gathers the summary of a run from the motion of a Player, over the measuring window and over the
/// whole run.
class WindowObserver {
public:
    using BodyAt = FunctionRef<BodyState(double tau)>;

    /// The player has to outlive this. period: s, from pulse to pulse. Without `sees_drive` the
    /// summary says nothing of coils and field, without `asks_pull` nothing of the pull.
    WindowObserver(const Window& window, double period, const Player& player, bool sees_drive,
                   bool asks_pull)
        : player_(player),
          window_(window),
          observer_(period),
          drive_(player.circuit()),
          sees_drive_(sees_drive),
          asks_pull_(asks_pull) {}

    /// Opens or closes the window where a segment begins or the run ends, at `time` s. Boundaries
    /// of segments carry rounding; the window's ends are some of them.
    void watch_window(double time);
    /// Closes the window at `time` s, where a run stops before its end, or at the end.
    void close(double time) {
        if (observer_.is_open()) close_window(time);
    }
    /// The run begins.
    void begin() { start_fields_ = player_.field_of_coils(); }
    /// Lists the times at which |B| may turn in the segment that has just begun.
    void plan_looks();
    /// Time in the segment from which the field has to be looked at within steps, s.
    double next_look() const { return next_look_; }
    /// The field in what has been played from one time of the segment to another, where it may
    /// turn. `body_at(tau)` gives the body at any time in that span.
    void look_at_field(double from, double to, BodyAt body_at);
    /// Whether `weigh` has to see every step.
    bool weighs() const { return asks_pull_ && observer_.is_open(); }
    /// The pull in a step, or its part, from one time of the segment to another.
    void weigh(double from, double to, BodyAt body_at);
    /// Adds a phase, or its part within a segment, that took `duration` s.
    template <class Phase>
    void phase(const Phase& phase, const PhaseEnd<Phase>& end, double duration) {
        observer_.phase(phase, end, duration, player_.body().quadrant);
    }
    /// Adds a segment that has ended, or its first `duration` s.
    void end_segment(double duration);
    /// Writes all numbers of the summary; those of the window are empty unless it has closed.
    void write(Summary& summary) const;

private:
    void end_segment(const VoltageSegment& voltages, const CurrentSegment& played);
    void close_window(double time);
    void end_look();
    double squared_field(double tau, const BodyState& body) const {
        const std::array<double, 3> b = player_.field(tau, body);
        return b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    }

    static constexpr double kNoLook = std::numeric_limits<double>::infinity();

    const Player& player_;
    const Window window_;
    SummaryObserver observer_;
    DriveObserver drive_;
    const bool sees_drive_;
    bool has_opened_ = false;
    // Where the field may turn in what is left of the segment, the next such time last.
    struct FieldLook {
        FieldTurn turn;
        bool for_most, for_least;
    };
    std::vector<FieldLook> looks_;
    double next_look_ = kNoLook;  // s
    PerCoilOf<CoilField> start_fields_ = {};
    double turned_before_ = 0.0;  // rad, of the heading before the window
    const bool asks_pull_;
    BodyState opened_;  // where the window begins
    Pull pulled_;       // N s, over the window
    Summary of_window_;
};

}  // namespace stickslip
