#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/numbers/rows.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

/// Code of a contact mode in a recording: its place in `kContactWords` after `from_motion`.
std::int8_t contact_code(const ContactMode& mode, double frame_sign);
/// The mode of a robot in the whole plane as it is shown: a slip is forward or backward by its part
/// `along` the heading, m/s.
ContactMode seen_along(ContactMode mode, double along);

/// Recorded columns, in the world's frame, one entry a sample. Units and meanings are in
/// `kRecordColumns`. A column that is not kept is empty.
struct Recording {
    std::vector<double> t, x, z, theta, vx, vz, omega;
    std::vector<double> normal_force, friction_force;  ///< zero in flight
    std::vector<double> contact_x, slip_velocity;      ///< NaN in flight
    std::vector<double> bx, by, bz;
    std::vector<PerCoil> current;
    std::vector<std::int8_t> contact;
    std::vector<std::int8_t> event;  ///< EventKind; "events" only
    // In the whole plane, where friction and slip above are along the heading, these to its left.
    std::vector<double> y, vy, heading, friction_across, contact_y, slip_across;

    /// Calls `use(column, values)` for each of `kRecordColumns`.
    void for_each_column(auto&& use);
};

/// A column of a recording.
struct RecordColumn {
    using Member = std::variant<std::vector<double> Recording::*, std::vector<PerCoil> Recording::*,
                                std::vector<std::int8_t> Recording::*>;
    std::string_view name;
    const char* unit;  ///< SI, "1" for none
    const char* meaning;
    Member member;
    bool of_plane = false;  ///< of runs in the whole plane alone
};

inline constexpr std::array<RecordColumn, kColumns> kRecordColumns{{
    {"t", "s", "time", &Recording::t},
    {"x", "m", "position of the centre of mass along the surface", &Recording::x},
    {"z", "m", "height of the centre of mass above the surface", &Recording::z},
    {"theta", "rad", "tilt angle, nose-down positive in the robot's own frame", &Recording::theta},
    {"vx", "m/s", "velocity of the centre of mass along the surface", &Recording::vx},
    {"vz", "m/s", "velocity of the centre of mass away from the surface", &Recording::vz},
    {"omega", "rad/s", "rate of the tilt angle", &Recording::omega},
    {"normal_force", "N", "normal force of the surface, adhesion not subtracted",
     &Recording::normal_force},
    {"friction_force", "N", "friction force of the surface, along +x", &Recording::friction_force},
    {"contact_x", "m", "position of the contact point, nothing in flight", &Recording::contact_x},
    {"slip_velocity", "m/s", "velocity of the contact point, nothing in flight",
     &Recording::slip_velocity},
    {"bx", "T", "field along x at the centre of mass", &Recording::bx},
    {"by", "T", "field along y at the centre of mass, across the plane of motion", &Recording::by},
    {"bz", "T", "field along z at the centre of mass", &Recording::bz},
    {"current", "A", "current of each coil", &Recording::current},
    {"contact", "1", "mode of the contact", &Recording::contact},
    {"event", "1", "event of the contact", &Recording::event},
    {"y", "m", "position of the centre of mass across the x axis", &Recording::y, true},
    {"vy", "m/s", "velocity of the centre of mass across the x axis", &Recording::vy, true},
    {"heading", "rad", "where the robot faces, from +x to the left", &Recording::heading, true},
    {"friction_across", "N", "friction force of the surface, to the left of the heading",
     &Recording::friction_across, true},
    {"contact_y", "m", "position of the contact point across, nothing in flight",
     &Recording::contact_y, true},
    {"slip_across", "m/s", "velocity of the contact point to the left of the heading",
     &Recording::slip_across, true},
}};
inline constexpr std::size_t kEventColumn = place_of(kRecordColumns, "event");

void Recording::for_each_column(auto&& use) {
    for (const RecordColumn& column : kRecordColumns) {
        std::visit([&](auto member) { use(column, this->*member); }, column.member);
    }
}

/// Writes samples on a uniform grid or at events.
class Recorder {
public:
    /// Samples that a sink gets at a time: 11 MB, and enough for a chunk to compress well.
    static constexpr std::size_t kChunk = 65536;

    /// whole_plane: whether the run is one in the whole plane.
    Recorder(const RecordSettings& settings, double frame_sign, bool whole_plane);

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
    bool whole_plane_;
    std::int64_t count_ = 0;  // of the grid's samples, those before `from` among them
    Recording recording_;
};

}  // namespace stickslip
