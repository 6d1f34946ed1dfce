#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>

#include "stickslip/solver/motion_trace.hpp"

/// Types that the two integrators share.
namespace stickslip {

/// Events that end a phase of smooth motion.
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
    inner_ahead,       ///< the inner mass meets its stop ahead, or lets go of it
    inner_behind,      ///< the same behind
    // In the whole plane:
    breaks_loose,   ///< friction holds no more, whichever way
    slip_slows,     ///< a slip slows down to the capture speed
    slip_quickens,  ///< a slow slip has left the capture speed behind
    heading,        ///< the horizontal field becomes too weak to turn the robot, or strong again
};

/// Sizes that make the tolerances relative: a length, and velocities of the free swing.
struct Scales {
    double length = 0.0;    ///< m
    double velocity = 0.0;  ///< m/s
    double rate = 0.0;      ///< rad/s
};

/// How a simulation ended.
enum class Status {
    ok,
    step_underflow,   ///< the integrator's step fell below the resolution of time
    too_many_events,  ///< events without end in no time
    not_finite,       ///< a coordinate or a force is not a number
    left_workspace,   ///< the robot reached the coils
    interrupted,      ///< stopped from outside
    no_arkode,        ///< the method `arkode` is not in this build
    too_many_steps,   ///< more than solver.max_steps
    heading_lost,     ///< the horizontal field came back from another side
    turns_too_fast,   ///< the horizontal field turned faster than the robot follows
};

struct StepperOptions {
    double tolerance = 1e-8;  ///< local error a step, relative to the scales of a phase
    double max_step = 0.0;    ///< s, zero: no limit
    double longest_rest = std::numeric_limits<double>::infinity();  ///< s, of a step at rest
    bool is_shaken = false;      ///< by a surface or an inner mass
    double surface_speed = 0.0;  ///< m/s, the most that the surface carries the robot with
    std::int64_t most_steps = std::numeric_limits<std::int64_t>::max();
    Scales scales;
    double swing_rate = 1.0;  ///< rad/s, of the fastest free swing: gives the first step of a phase
    const std::atomic<bool>* stop = nullptr;
};

/// First step (s) of a phase where the last events did not advance the time: far above the
/// resolution of time, far below anything that moves.
inline constexpr double kShortestStep = 1e-9;

struct StepCounts {
    std::int64_t accepted = 0;
    std::int64_t rejected = 0;
    std::int64_t evaluations = 0;
};

/// Answer of an observer of steps while the run goes on; to stop it, the observer returns the
/// fraction of the step, 0 to 1, at which it ends.
inline constexpr double kGoesOn = 2.0;

/// Which event functions have been positive since the phase began, or since the segment of voltage
/// did.
struct PhaseMemory {
    static constexpr std::size_t kMost = 8;
    std::array<bool, kMost> armed = {};
    bool born = true;      ///< begun by an event; else the phase goes on in a new segment
    bool stalled = false;  ///< the last events hardly advanced the time

    /// `least`: what a value has to exceed to be positive by more than rounding. In a phase that
    /// goes on, a function below it has fallen with the forces, which may jump between segments.
    void begin(const auto& values, double least) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            armed[i] = (born ? values[i] : std::abs(values[i])) > least;
        }
        born = false;
    }
};

/// How a phase, or its part within a segment of voltage, ended.
template <class Phase>
struct PhaseEnd {
    static_assert(Phase::kEvents <= PhaseMemory::kMost);
    Status status = Status::ok;
    Event event = Event::none;  ///< none: the end of the segment was reached
    double tau = 0.0;           ///< s
    typename Phase::State y = {};
    MotionTrace<double> trace = {};
};

}  // namespace stickslip
