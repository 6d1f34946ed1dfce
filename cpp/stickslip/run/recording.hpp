#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

/// Names of the contact modes, indexed by `contact_code`.
inline constexpr std::array<const char*, 7> kContactNames = {
    "flight",     "corner_stick",      "corner_slip_forward", "corner_slip_backward",
    "face_stick", "face_slip_forward", "face_slip_backward"};
std::int8_t contact_code(const ContactMode& mode, double frame_sign);
/// The mode of a robot in the whole plane as it is shown: a slip is forward or backward by its part
/// `along` the heading, m/s.
ContactMode seen_along(ContactMode mode, double along);

/// Names of the columns of a `Recording`, in their order.
inline constexpr std::array<const char*, kColumns> kColumnNames = {"t",
                                                                   "x",
                                                                   "z",
                                                                   "theta",
                                                                   "vx",
                                                                   "vz",
                                                                   "omega",
                                                                   "normal_force",
                                                                   "friction_force",
                                                                   "contact_x",
                                                                   "slip_velocity",
                                                                   "bx",
                                                                   "by",
                                                                   "bz",
                                                                   "current",
                                                                   "contact",
                                                                   "event",
                                                                   "y",
                                                                   "vy",
                                                                   "heading",
                                                                   "friction_across",
                                                                   "contact_y",
                                                                   "slip_across"};
/// The last ones, of runs in the whole plane alone.
inline constexpr std::size_t kPlaneColumns = 6, kEventColumn = kColumns - kPlaneColumns - 1;

/// Recorded columns, in the world's frame and SI units, one entry a sample. theta, omega: nose-down
/// positive in the robot's own frame. A column that is not kept is empty.
struct Recording {
    std::vector<double> t, x, z, theta, vx, vz, omega;
    std::vector<double> normal_force, friction_force;     ///< N; zero in flight
    std::vector<double> contact_x, slip_velocity;         ///< NaN in flight
    std::vector<double> bx, by, bz;                       ///< T at the centre of mass
    std::vector<std::array<double, kCoilCount>> current;  ///< A
    std::vector<std::int8_t> contact;
    std::vector<std::int8_t> event;  ///< EventKind; "events" only
    // In the whole plane, where friction and slip above are along the heading, these to its left.
    std::vector<double> y, vy, heading, friction_across, contact_y, slip_across;

    /// Calls `use(index, column)` for each column, in the order of `kColumnNames`.
    void for_each_column(auto&& use) {
        std::size_t index = 0;
        const auto each = [&](auto&... columns) { (use(index++, columns), ...); };
        each(t, x, z, theta, vx, vz, omega, normal_force, friction_force, contact_x, slip_velocity,
             bx, by, bz, current, contact, event, y, vy, heading, friction_across, contact_y,
             slip_across);
    }
};

/// Writes samples on a uniform grid or at events.
class Recorder {
public:
    /// Samples that a sink gets at a time: 11 MB, and enough for a chunk to compress well.
    static constexpr std::size_t kChunk = 65536;

    /// turns: whether the run is one in the whole plane.
    Recorder(const RecordSettings& settings, double frame_sign, bool turns);

    /// Whether an event at `t`, s, is recorded.
    bool at_event(double t) const {
        return settings_.kind == RecordKind::events && t >= settings_.from;
    }
    bool on_grid() const { return settings_.kind == RecordKind::uniform; }
    /// Time of the next sample of the grid, s; infinite without a grid.
    double next_time() const {
        return on_grid() ? static_cast<double>(count_) / settings_.rate
                         : std::numeric_limits<double>::infinity();
    }
    /// field: T.
    void add(double t, const Snapshot& snapshot, const ContactMode& mode,
             const std::array<double, 3>& field, const PerCoil& current);
    /// Of the sample that was added last.
    void add_event(EventKind kind) {
        if (!settings_.dropped[kEventColumn]) {
            recording_.event.push_back(static_cast<std::int8_t>(kind));
        }
    }
    /// What no sink has taken; with a sink, nothing.
    Recording take();

private:
    void hand_over();

    RecordSettings settings_;
    double sign_;
    bool turns_;
    std::int64_t count_ = 0;  // of the grid's samples, those before `from` among them
    Recording recording_;
};

}  // namespace stickslip
