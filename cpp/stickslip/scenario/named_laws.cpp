#include "stickslip/scenario/named_laws.hpp"

#include <numbers>

namespace stickslip {
namespace {

using enum Quantity;
using enum Argument;
using enum Form;
using enum Acts;

double one(const Scenario&) {
    return 1.0;
}

/// A named effect, absent where its amplitude is zero.
struct Row {
    const char* key;
    LawKind kind;  // one of kNamedKinds
    double (*amplitude)(const Scenario&);
    double (*scale)(const Scenario&) = one;
};

#define STICKSLIP_OF(expression)                       \
    [](const Scenario& s) {                            \
        [[maybe_unused]] const Effects& e = s.effects; \
        return expression;                             \
    }

// clang-format off
constexpr Row kRows[] = {
    {"effects.stribeck_friction.velocity", {sliding_friction, adds, slip_speed, gaussian},
     STICKSLIP_OF(e.stribeck_friction_velocity > 0.0
                  ? s.contact.static_friction - s.contact.kinetic_friction : 0.0),
     STICKSLIP_OF(e.stribeck_friction_velocity)},
    {"effects.viscous_friction.coefficient", {sliding_friction, adds, slip_speed, line},
     STICKSLIP_OF(e.viscous_friction_coefficient)},
    {"effects.friction_anisotropy.fraction", {friction_by_way, multiplies, way, line},
     STICKSLIP_OF(e.friction_anisotropy_fraction)},
    {"effects.friction_patches.amplitude", {friction, multiplies, place, wave},
     STICKSLIP_OF(e.friction_patches_amplitude),
     STICKSLIP_OF(e.friction_patches_period / (2.0 * std::numbers::pi))},
    {"effects.angle_adhesion.strength", {adhesion, multiplies, sine, square},
     STICKSLIP_OF(-e.angle_adhesion_strength)},
    {"effects.adhesion_ageing.rate", {adhesion, multiplies, age, logarithm},
     STICKSLIP_OF(e.adhesion_ageing_rate), STICKSLIP_OF(e.adhesion_ageing_time)},
    // Of the linear drag alone.
    {"effects.angle_drag.strength", {drag, adds, cosine, square},
     STICKSLIP_OF(e.angle_drag_strength * s.drag.linear)},
    {"effects.quadratic_drag.coefficient", {drag, adds, speed, line},
     STICKSLIP_OF(e.quadratic_drag_coefficient)},
};
// clang-format on

#undef STICKSLIP_OF

}  // namespace

std::vector<Law> all_laws(const Scenario& scenario, const RobotFrame& frame) {
    std::vector<Law> result = own_laws(scenario);
    for (const Row& row : kRows) {
        const double amplitude = row.amplitude(scenario);
        if (amplitude == 0.0) continue;
        Law law{
            .kind = row.kind, .amplitude = amplitude, .scale = row.scale(scenario), .key = row.key};
        result.push_back(law);
    }
    // Places are the world's; all else is of the robot's own frame.
    if (frame.sign < 0.0) {
        for (Law& law : result) {
            if (law.kind.argument == place) law.turn();
        }
    }
    return result;
}

}  // namespace stickslip
