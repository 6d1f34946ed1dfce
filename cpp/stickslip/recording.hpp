#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stickslip/phase_types.hpp"

namespace stickslip {

/// Changes of the contact that a run counts and that a recording "events" holds.
enum class EventKind {
    slip_start,  ///< a sticking contact slips
    stick,       ///< a slipping contact sticks
    reversal,    ///< a slip stops and goes on the other way
    lift_off,    ///< the last contact is lost
    touch_down,  ///< a corner meets the surface out of flight
    landing,     ///< a body on one corner comes to lie on a face
    tip,         ///< a body on a face goes to one corner
    roll_over,   ///< a body on one corner goes to the next at once, as the face between lands
    rebound,     ///< the second corner of a body on one corner meets the surface and bounces off
    painleve,    ///< sliding had no solution and was stopped by an impulse
};
inline constexpr std::size_t kEventKinds = 10;
const char* name(EventKind kind);

/// Names of the contact modes, indexed by `contact_code`.
inline constexpr std::array<const char*, 7> kContactNames = {
    "flight",     "corner_stick",      "corner_slip_forward", "corner_slip_backward",
    "face_stick", "face_slip_forward", "face_slip_backward"};
std::int8_t contact_code(const ContactMode& mode, double frame_sign);

/// Recorded columns, in the world's frame and SI units, one entry a sample. theta, omega: nose-down
/// positive in the robot's own frame.
struct Recording {
    std::vector<double> t, x, z, theta, vx, vz, omega;
    std::vector<double> normal_force, friction_force;     ///< N; zero in flight
    std::vector<double> contact_x, slip_velocity;         ///< NaN in flight
    std::vector<double> bx, by, bz;                       ///< T at the centre of mass
    std::vector<std::array<double, kCoilCount>> current;  ///< A
    std::vector<std::int8_t> contact;
    std::vector<std::int8_t> event;  ///< EventKind; "events" only
};

/// Writes samples on a uniform grid or at events.
class Recorder {
public:
    /// rate in Hz; zero records no grid.
    Recorder(double rate, bool at_events, double frame_sign)
        : rate_(rate), at_events_(at_events), sign_(frame_sign) {}

    bool at_events() const { return at_events_; }
    bool on_grid() const { return rate_ > 0.0; }
    /// Time of the next sample of the grid, s; infinite without a grid.
    double next_time() const {
        return rate_ > 0.0 ? static_cast<double>(count_) / rate_
                           : std::numeric_limits<double>::infinity();
    }
    /// across: B_y, T.
    void add(double t, const Snapshot& snapshot, const ContactMode& mode, const PlanarField& field,
             double across, const PerCoil& current);
    void add_event(EventKind kind) { recording_.event.push_back(static_cast<std::int8_t>(kind)); }
    Recording take() { return std::move(recording_); }

private:
    double rate_;
    bool at_events_;
    double sign_;
    std::int64_t count_ = 0;
    Recording recording_;
};

}  // namespace stickslip
