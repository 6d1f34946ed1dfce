#pragma once

#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// Whether time goes on from event to event.
class ProgressWatch {
public:
    /// burst_span: s, in which only so many events may follow each other.
    explicit ProgressWatch(double burst_span) : burst_span_(burst_span) {}

    /// A segment of voltage begins.
    void begin() { *this = ProgressWatch(burst_span_); }

    /// An event at `now` s.
    void event(double now) {
        stalls_ = now - last_event_ < 10.0 * kShortestStep ? stalls_ + 1 : 0;
        last_event_ = now;
        if (now - burst_start_ > burst_span_) {
            burst_start_ = now;
            burst_ = 0;
        }
        ++burst_;
    }

    /// After a long step has been cut by an event at its very start, its dense output may well not
    /// show an acceleration that is zero to rounding: short steps do.
    bool stalled() const { return stalls_ > kMostStalls; }
    /// Events pile up: a fault of the model or of this program that would else be a hang. The limit
    /// is far above what ends by itself, such as the bounces of a restitution of 0.999.
    bool hangs() const { return burst_ > kMostInBurst; }

private:
    static constexpr int kMostStalls = 4, kMostInBurst = 200000;

    double burst_span_;
    double last_event_ = -1.0, burst_start_ = -1.0;  // s
    int stalls_ = 0, burst_ = 0;
};

}  // namespace stickslip
