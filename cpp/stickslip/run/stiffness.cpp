#include "stickslip/run/stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace stickslip {
namespace {

// Rates above this many swing rates are told of: below, a run is not ten times as long as without.
constexpr double kFarAbove = 100.0;

struct Candidate {
    const char* key;
    double value;
    double rate_of_one;  // 1/s, of a value of one
    double power = 1.0;  // of the value in the rate
};

// Largest slope of a free shape between two knots, over a span of one, 1/(the argument's unit).
double steepest_knots(const FreeShape& shape) {
    double steepest = 0.0, last = 0.0;
    for (const double knot : shape.knots) {
        steepest = std::max(steepest, std::abs(knot - last));
        last = knot;
    }
    return steepest * static_cast<double>(kKnots);
}

Stiffness fastest(std::span<const Candidate> candidates, double swing) {
    Stiffness result;
    result.swing = swing;
    for (const Candidate& each : candidates) {
        if (!(each.value > 0.0) || each.rate_of_one == 0.0) continue;
        const double rate = each.rate_of_one * std::pow(each.value, each.power);
        if (rate <= result.rate) continue;
        const double sane = std::pow(kFarAbove * swing / each.rate_of_one, 1.0 / each.power);
        result = {each.key, each.value, rate, swing, sane};
    }
    return result;
}

}  // namespace

bool Stiffness::is_stiff() const {
    return rate > kFarAbove * swing;
}

StepDemand::StepDemand(const Scenario& s, const Model& model, double swing_rate, double duration)
    : hold_period_(s.effects.sample_hold_period),
      max_step_(s.solver.max_step),
      duration_(duration),
      most_steps_(static_cast<double>(s.solver.max_steps)) {
    const Effects& e = s.effects;
    const double mass = model.mass, inertia = model.inertia;
    const double speed = model.shape.radius() * swing_rate;
    const double load = mass * s.gravity + model.adhesion.strength;
    // Where nothing swings the rate is a stand-in, and no key is to blame for being above it.
    constexpr double kSlowSwing = 1e3;  // rad/s
    swing_ = std::max(swing_rate, kSlowSwing);
    // A damped motion is followed long after it has died away.
    const Candidate lasting[] = {
        {"drag.linear", s.drag.linear, 1.0 / mass},
        {"drag.rotational", s.drag.rotational, swing_rate / inertia},
        // Of a body that lies; a negative strength takes from the drag.
        {"effects.angle_drag.strength", e.angle_drag_strength, s.drag.linear / mass},
        {"effects.rotational_drag.coefficient", e.rotational_drag_coefficient, 1.0 / inertia},
        {"effects.quadratic_drag.coefficient", e.quadratic_drag_coefficient, speed / mass},
        {"effects.viscous_friction.coefficient", e.viscous_friction_coefficient, load / mass},
        {"effects.free_friction_speed.span", e.free_friction_speed.span,
         steepest_knots(e.free_friction_speed) * model.friction.kinetic_coefficient * load / mass,
         -1.0},
    };
    lasting_ = fastest(lasting, swing_);
    // Adhesion that falls with the gap pulls a corner of the mass 1/(1/m + r^2/J) off the surface,
    // and friction that falls with the velocity drives a slip on: what grows so fast is over before
    // it has taken many steps, unless the body is brought back to it again and again.
    const double corner_mass = mass * inertia / model.corner_inertia();
    const double drop = model.friction.static_coefficient - model.friction.kinetic_coefficient;
    const double steepest = std::sqrt(2.0 / std::numbers::e);  // slope of exp(-x^2)
    const Candidate passing[] = {
        {"contact.adhesion_range", model.adhesion.range,
         std::sqrt(model.adhesion.strength / corner_mass), -0.5},
        {"effects.stribeck_friction.velocity", e.stribeck_friction_velocity,
         steepest * drop * load / mass, -1.0},
    };
    passing_ = fastest(passing, swing_);
    if (passing_.rate < lasting_.rate) passing_ = lasting_;
    // The least mass at which the swing is that of a robot, not of a speck of dust; a field that
    // makes a robot of some mass swing so fast is not the mass's fault.
    constexpr double kFastestSwing = 1e6;  // rad/s
    constexpr double kDust = 1e-13;        // kg, of a cube of some 5 um
    if (!lasting_.is_stiff() && swing_rate > kFastestSwing && mass < kDust) {
        const double ratio = swing_rate / kFastestSwing;
        lasting_ = {"robot.mass", mass, swing_rate, kFastestSwing / kFarAbove,
                    std::min(mass * ratio * ratio, kDust)};
    }
}

Stiffness StepDemand::stiffness(const Effort& effort) const {
    const bool short_steps = effort.steps > kFarAbove * swing_ * effort.moving_time;
    return short_steps && !lasting_.is_stiff() ? passing_ : lasting_;
}

StepBound StepDemand::bound(const Effort& effort) const {
    // Of the budget. A stretch needs a step at least, and often a second.
    constexpr double kLeast = 0.25, kSane = 0.1;
    const double least = kLeast * most_steps_, sane = duration_ / (kSane * most_steps_);
    StepBound result;
    const auto stretches = static_cast<double>(effort.stretches);
    if (hold_period_ > 0.0 && stretches > least) {
        result = {"effects.sample_hold.period", hold_period_, stretches, sane};
    }
    const double limited = max_step_ > 0.0 ? effort.moving_time / max_step_ : 0.0;
    if (limited > std::max(least, result.steps)) {
        result = {"solver.max_step", max_step_, limited, sane};
    }
    return result;
}

}  // namespace stickslip
