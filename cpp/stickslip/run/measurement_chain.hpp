#pragma once

namespace stickslip {

struct Recording;
struct Summary;

/// What the laboratory's instruments make of the motion: named effects of the measurement. They
/// change what a run reports, not how the robot moves.
struct MeasurementChain {
    double length_scale = 0.0;  ///< -, lengths read too long by this part
    double clock_scale = 0.0;   ///< -, times read too long by this part
    double angle_offset = 0.0;  ///< rad, added to theta

    double length_factor() const { return 1.0 + length_scale; }
    double time_factor() const { return 1.0 + clock_scale; }

    bool scales_nothing() const { return length_scale == 0.0 && clock_scale == 0.0; }
    void apply(Summary& summary) const;
    void apply(Recording& recording) const;
};

}  // namespace stickslip
