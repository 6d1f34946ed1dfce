#include "stickslip/stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stickslip {
namespace {

// Rates above this many swing rates are told of: below, a run is not ten times as long as without.
constexpr double kFarAbove = 100.0;

}  // namespace

bool Stiffness::is_stiff() const {
    return rate > kFarAbove * swing;
}

Stiffness stiffness(const Scenario& s, const Model& model, double swing_rate) {
    const double mass = model.mass, inertia = model.inertia;
    const double speed = model.shape.radius() * swing_rate;
    const double load = mass * s.gravity + model.adhesion.strength;
    struct Candidate {
        const char* key;
        double value, rate;
    };
    const Effects& e = s.effects;
    const std::array<Candidate, 5> candidates = {{
        {"drag.linear", s.drag.linear, s.drag.linear / mass},
        {"drag.rotational", s.drag.rotational, s.drag.rotational * swing_rate / inertia},
        {"effects.rotational_drag.coefficient", e.rotational_drag_coefficient,
         e.rotational_drag_coefficient / inertia},
        {"effects.quadratic_drag.coefficient", e.quadratic_drag_coefficient,
         e.quadratic_drag_coefficient * speed / mass},
        {"effects.viscous_friction.coefficient", e.viscous_friction_coefficient,
         e.viscous_friction_coefficient * load / mass},
    }};
    // Where nothing swings the rate is a stand-in, and no key is to blame for being above it.
    constexpr double kSlowSwing = 1e3;  // rad/s
    Stiffness result;
    result.swing = std::max(swing_rate, kSlowSwing);
    for (const Candidate& candidate : candidates) {
        if (candidate.rate <= result.rate) continue;
        result.key = candidate.key;
        result.value = candidate.value;
        result.rate = candidate.rate;
    }
    if (result.rate > 0.0) result.sane = result.value * (kFarAbove * result.swing / result.rate);
    // The least mass at which the swing is that of a robot, not of a speck of dust; a field that
    // makes a robot of some mass swing so fast is not the mass's fault.
    constexpr double kFastestSwing = 1e6;  // rad/s
    constexpr double kDust = 1e-13;        // kg, of a cube of some 5 um
    if (!result.is_stiff() && swing_rate > kFastestSwing && mass < kDust) {
        const double ratio = swing_rate / kFastestSwing;
        result = {"robot.mass", mass, swing_rate, kFastestSwing / kFarAbove,
                  std::min(mass * ratio * ratio, kDust)};
    }
    return result;
}

}  // namespace stickslip
