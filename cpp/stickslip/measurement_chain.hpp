#pragma once

#include "stickslip/recording.hpp"
#include "stickslip/summary.hpp"

namespace stickslip {

/// What the laboratory's instruments make of the motion: named effects of the measurement. They
/// change what a run reports, not how the robot moves.
struct MeasurementChain {
    double length_scale = 0.0;  ///< -, lengths read too long by this part
    double clock_scale = 0.0;   ///< -, times read too long by this part
    double angle_offset = 0.0;  ///< rad, added to theta

    double length_factor() const { return 1.0 + length_scale; }
    double time_factor() const { return 1.0 + clock_scale; }

    void apply(Summary& summary, Recording& recording) const;
};

}  // namespace stickslip
