#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <variant>
#include <vector>

#include "stickslip/drive/coil.hpp"
#include "stickslip/numbers/rows.hpp"

namespace stickslip {

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
    std::vector<double> inner_place, inner_velocity;  // with an inner mass

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
    bool of_inner = false;  ///< of robots with an inner mass alone
};

inline constexpr auto kRecordColumns = std::to_array<RecordColumn>({
    {"t", "s", "time", &Recording::t},
    {"x", "m", "position of the centre of mass along the surface", &Recording::x},
    {"z", "m", "height of the centre of mass above the surface", &Recording::z},
    {"theta", "rad", "pitch angle, nose-down positive in the robot's own frame", &Recording::theta},
    {"vx", "m/s", "velocity of the centre of mass along the surface", &Recording::vx},
    {"vz", "m/s", "velocity of the centre of mass away from the surface", &Recording::vz},
    {"omega", "rad/s", "rate of the pitch angle", &Recording::omega},
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
    {"inner_place", "m", "place of the inner mass in the body, beside that at rest",
     &Recording::inner_place, false, true},
    {"inner_velocity", "m/s", "velocity of the inner mass in the body", &Recording::inner_velocity,
     false, true},
});
inline constexpr std::size_t kColumns = kRecordColumns.size();
inline constexpr std::size_t kEventColumn = place_of(kRecordColumns, "event");

void Recording::for_each_column(auto&& use) {
    for (const RecordColumn& column : kRecordColumns) {
        std::visit([&](auto member) { use(column, this->*member); }, column.member);
    }
}

enum class RecordKind { none, events, uniform };

/// Type of the recorded numbers but t, which is always float64.
enum class Precision { float64, float32 };

struct RecordSettings {
    RecordKind kind = RecordKind::none;
    double rate = 0.0;                   ///< Hz, of the uniform grid
    double from = 0.0;                   ///< s, simulated time before which nothing is recorded
    std::bitset<kColumns> dropped = {};  ///< columns that are not kept, see `kRecordColumns`
    /// Takes the record chunk by chunk while the run goes on, on the thread that plays it; without
    /// it the record is kept to the end.
    std::function<void(Recording&&)> sink = nullptr;
    Precision dtype = Precision::float64;  ///< of the record's columns outside of the core
    bool pull_share = false;               ///< whether the summary has `pull_share`
};

}  // namespace stickslip
