#include "stickslip/scenario/whole_plane.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "stickslip/field/field_map.hpp"
#include "stickslip/numbers/number_text.hpp"

namespace stickslip {
namespace {

bool has_equal_coils_of_y(const Scenario& s) {
    return s.coils[2] == s.coils[3];
}

bool in_whole_plane(const Scenario& s) {
    const Effects& e = s.effects;
    const SimulationState& start = s.initial;
    const bool pushed =
        e.ambient_field_by != 0.0 ||
        (e.surface_tilt_angle != 0.0 && surface_direction(e.surface_tilt_azimuth).y != 0.0);
    if (s.whole_plane || pushed || start.y != 0.0 || start.vy != 0.0) return true;
    // In one plane a robot faces the drive's direction, and a state that it has left says so.
    if (start.heading != 0.0) {
        constexpr double kRounding = 1e-9;
        const double faced = drive_direction(s).x < 0.0 ? std::numbers::pi : 0.0;
        const double off = std::remainder(start.heading - faced, 2.0 * std::numbers::pi);
        if (std::abs(off) > kRounding) return true;
    }
    // A field that was measured has a part across everywhere; one that was measured in the plane of
    // motion alone says nothing of it.
    if (s.map && s.map->box().low.y() < s.map->box().high.y()) return true;
    if (in_whole_plane(s, start.current) || in_whole_plane(s, start.field_lag)) return true;
    if (!has_equal_coils_of_y(s) && e.mutual_inductance_coupling != 0.0) return true;
    if (s.drive.kind() != DriveKind::program) return drive_direction(s).y != 0.0;
    for (const VoltageBlock& block : s.program.blocks()) {
        for (const VoltagePoint& point : block.points) {
            if (in_whole_plane(s, point.voltage)) return true;
        }
    }
    return false;
}

}  // namespace

void check_plane(const Scenario& s, const RobotFrame& frame) {
    if (!frame.whole_plane) return;
    if (!s.shake.absent()) {
        throw std::invalid_argument(
            "shake: the surface moves in the plane y = 0: allowed is a robot that stays in it");
    }
    if (!s.inner.absent()) {
        throw std::invalid_argument(
            "inner.mass: it moves in the plane y = 0: allowed is a robot that stays in it");
    }
    for (const UserSetting& each : s.user_effects) {
        if (each.absent()) continue;
        throw std::invalid_argument("effects." + each.effect->name +
                                    ": an effect of your own has no force across the plane y = 0: "
                                    "allowed is a robot that stays in it");
    }
}

SurfaceDirection drive_direction(const Scenario& s) {
    const bool is_program = s.drive.kind() == DriveKind::program;
    const SurfaceDirection ahead = surface_direction(is_program ? 0.0 : s.drive.heading);
    if (s.drive.direction == Direction::plus_x) return ahead;
    return {-ahead.x, 0.0 - ahead.y};  // the opposite of +x is at pi, and not at -pi
}

Heading start_heading(const Scenario& s) {
    const bool is_told = s.initial.heading != 0.0;
    const SurfaceDirection start =
        is_told ? surface_direction(s.initial.heading) : drive_direction(s);
    return {start.x, start.y};
}

// The coils of y make no field across only together, as equal ones.
bool in_whole_plane(const Scenario& s, const PerCoil& of_coils) {
    constexpr double kRounding = 1e-9;  // of a state that was written in decimals
    const double plus = of_coils[2], minus = of_coils[3];
    if (!has_equal_coils_of_y(s)) return plus != 0.0 || minus != 0.0;
    return std::abs(plus + minus) > kRounding * (std::abs(plus) + std::abs(minus));
}

void check_planar_step(const Scenario& scenario, const PerCoil& voltages) {
    if (!in_whole_plane(scenario, voltages)) return;
    throw std::invalid_argument(
        "voltages: yp = " + digits(voltages[2]) + ", ym = " + digits(voltages[3]) +
        " make a field across, which turns the robot: allowed is whole_plane = True from the "
        "start, or yp = -ym of equal coils");
}

RobotFrame frame_of(const Scenario& s) {
    const bool whole_plane = in_whole_plane(s);
    return {whole_plane, !whole_plane && drive_direction(s).x < 0.0 ? -1.0 : 1.0};
}

}  // namespace stickslip
