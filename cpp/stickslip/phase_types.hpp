#pragma once

#include <limits>

#include "stickslip/contact.hpp"

namespace stickslip {

/// What ends a phase of smooth motion.
enum class Event {
    none,
    lift_off,         ///< the reaction of a single corner reaches zero
    breaks_forward,   ///< friction holds no more and the contact slips to +x
    breaks_backward,  ///< the same to -x
    slip_stops,
    behind_lands,      ///< the corner behind the pivot reaches the surface
    ahead_lands,       ///< the corner ahead of the pivot reaches the surface
    ahead_lifts,       ///< the front end of a face leaves
    behind_lifts,      ///< the rear end of a face leaves
    sliding_jams,      ///< sliding loses its solution (Painleve)
    pivot_touches,     ///< in flight, the lowest corner reaches the surface
    opposite_touches,  ///< in flight, the corner opposite to it does
    // In the whole plane:
    breaks_loose,   ///< friction holds no more, whichever way
    slip_slows,     ///< a slip slows down to the capture speed
    slip_quickens,  ///< a slow slip has left the capture speed behind
};

/// Sizes that make the tolerances relative: a length, and velocities of the free swing.
struct Scales {
    double length = 0.0;    ///< m
    double velocity = 0.0;  ///< m/s
    double rate = 0.0;      ///< rad/s
};

/// Everything at an instant that a recording may want.
struct Snapshot {
    BodyState body;
    Reaction reaction;
    double contact_x = std::numeric_limits<double>::quiet_NaN();      ///< m, of the pivot corner
    double slip_velocity = std::numeric_limits<double>::quiet_NaN();  ///< m/s, of the pivot corner
    // Of a run in the whole plane: y of the pivot, friction to the left of the heading, and slip
    // to the left, beside which the two above are along the heading.
    double contact_y = std::numeric_limits<double>::quiet_NaN();    ///< m
    double friction_across = 0.0;                                   ///< N
    double slip_across = std::numeric_limits<double>::quiet_NaN();  ///< m/s
};

}  // namespace stickslip
