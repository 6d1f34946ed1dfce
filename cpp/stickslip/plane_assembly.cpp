#include "stickslip/plane_assembly.hpp"

#include <cmath>
#include <stdexcept>

#include "stickslip/field_map.hpp"

namespace stickslip {

void check_plane(const Scenario& s) {
    if (!turns(s)) return;
    for (const UserSetting& each : s.user_effects) {
        if (each.absent()) continue;
        throw std::invalid_argument("effects." + each.effect->name +
                                    ": allowed is a robot that stays in the plane y = 0; an effect "
                                    "of one's own has no force across it");
    }
}

SurfaceDirection drive_direction(const Scenario& s) {
    const SurfaceDirection of_heading = surface_direction(s.drive.heading);
    if (s.drive.direction == Direction::plus_x) return of_heading;
    return {-of_heading.x, -of_heading.y};
}

Heading start_heading(const Scenario& s) {
    const bool is_told = s.drive.mode == DriveMode::program || s.initial.heading != 0.0;
    const SurfaceDirection start =
        is_told ? surface_direction(s.initial.heading) : drive_direction(s);
    return {start.x, start.y};
}

// The coils of y make no field across only together, as equal ones.
bool turns(const PerCoil& voltages) {
    constexpr double kRounding = 1e-9;  // of a state that was written in decimals
    const double across = voltages[2] + voltages[3];
    return std::abs(across) > kRounding * (std::abs(voltages[2]) + std::abs(voltages[3]));
}

Scenario in_whole_plane(const Scenario& scenario, const SimulationState& state) {
    Scenario result = scenario;
    result.initial = state;
    result.whole_plane = true;
    return result;
}

bool turns(const Scenario& s) {
    const Effects& e = s.effects;
    const SimulationState& start = s.initial;
    const bool pushed =
        e.ambient_field_by != 0.0 ||
        (e.surface_tilt_angle != 0.0 && surface_direction(e.surface_tilt_azimuth).y != 0.0);
    if (s.whole_plane || pushed || start.y != 0.0 || start.vy != 0.0) return true;
    // A field that was measured has a part across everywhere; one that was measured in the plane of
    // motion alone says nothing of it.
    if (s.map && s.map->box().low.y() < s.map->box().high.y()) return true;
    if (turns(start.current) || turns(start.field_lag)) return true;
    const bool alike = e.own_coils[2] == e.own_coils[3];
    if (!alike && e.mutual_inductance_coupling != 0.0) return true;
    if (s.drive.mode != DriveMode::program) return drive_direction(s).y != 0.0;
    for (const VoltageBlock& block : s.program.blocks()) {
        for (const VoltagePoint& point : block.points) {
            const bool driven = point.voltage[2] != 0.0 || point.voltage[3] != 0.0;
            if (driven && (!alike || turns(point.voltage))) return true;
        }
    }
    return false;
}

}  // namespace stickslip
