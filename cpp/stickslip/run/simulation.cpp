#include "stickslip/run/simulation.hpp"

#include <numbers>
#include <optional>
#include <sstream>

#include "stickslip/run/assembly.hpp"
#include "stickslip/run/run.hpp"

namespace stickslip {

const char* name(Status status) {
    switch (status) {
        case Status::ok:
            return "ok";
        case Status::step_underflow:
            return "step_underflow";
        case Status::too_many_events:
            return "too_many_events";
        case Status::not_finite:
            return "not_finite";
        case Status::left_workspace:
            return "left_workspace";
        case Status::interrupted:
            return "interrupted";
        case Status::no_arkode:
            return "no_arkode";
        case Status::too_many_steps:
            return "too_many_steps";
        case Status::heading_lost:
            return "heading_lost";
        case Status::turns_too_fast:
            return "turns_too_fast";
    }
    return "unknown";
}

namespace {

// What the steps had to follow: a wrong unit shows in these times.
std::string times(const RunResult& result) {
    std::ostringstream text;
    const StepCounts& steps = result.steps;
    if (steps.accepted > 0) {
        text << "its steps took "
             << result.summary.simulated_time / static_cast<double>(steps.accepted)
             << " s in the mean, ";
    }
    text << "a free swing takes " << 2.0 * std::numbers::pi / result.swing_rate << " s";
    const Decay& decay = result.decay;
    if (decay.key != nullptr) {
        text << ", " << decay.key << " = " << decay.value << " damps a motion in "
             << 1.0 / decay.rate << " s";
    }
    return text.str();
}

}  // namespace

std::string message(const RunResult& result) {
    std::ostringstream text;
    text << "at t = " << result.summary.simulated_time << " s ";
    switch (result.status) {
        case Status::ok:
            if (!result.stopped) return "the run reached its end";
            text << "the run met its condition";
            break;
        case Status::step_underflow:
            text << "the step fell below the resolution of time: " << times(result)
                 << "; loosen solver.rtol, or look for a force that grows without bound";
            break;
        case Status::too_many_events:
            text
                << "contact events followed each other without end; change solver.rtol, or look at "
                   "friction and restitution";
            break;
        case Status::too_many_steps:
            text << "the run had taken as many steps as solver.max_steps = " << result.most_steps
                 << " allows: " << times(result)
                 << "; look for a value in a wrong unit, raise solver.max_steps, or simulate less "
                    "time";
            break;
        case Status::not_finite:
            if (!result.effect.empty()) {
                text << "the function of effect " << result.effect
                     << " gave a force or torque that is not a finite number";
                break;
            }
            text << "a force or a coordinate was not a number: " << times(result)
                 << "; look for extreme values in the scenario";
            break;
        case Status::left_workspace:
            if (result.map) {
                const auto& [low, high] = result.map->box();
                text << "the robot left coil.map, which has the field from x = " << low.x()
                     << " to " << high.x() << " m and from z = " << low.z() << " to " << high.z()
                     << " m; give fewer pulses or less field, or a map that reaches farther";
                break;
            }
            if (result.summary.simulated_time == 0.0) {
                text << "the robot was beyond the coils; begin nearer to the centre (initial.x, "
                        "initial.y)";
                break;
            }
            text << "the robot reached the coils; give fewer pulses or less field, or look at "
                    "effects.surface_tilt and friction";
            break;
        case Status::heading_lost:
            text << "the horizontal field had been too weak to hold the robot's heading and came "
                    "back from another side, so that nobody knows where the robot faces; turn the "
                    "field without letting it fade, or keep it stronger than an ambient field "
                    "across "
                    "it (drive.base, the voltages)";
            break;
        case Status::turns_too_fast:
            text << "the horizontal field turned at " << result.heading_end.rate
                 << " rad/s, faster than the robot can follow in a field of that size, "
                 << result.heading_end.limit << " rad/s; turn it more slowly, or make it stronger";
            break;
        case Status::interrupted:
            text << "the run was stopped";
            break;
        case Status::no_arkode:
            return "this build has no arkode; use solver.method = \"tsit5\", or install SUNDIALS "
                   "and build again";
    }
    return text.str();
}

bool has_method(Method method) {
#ifdef STICKSLIP_WITH_ARKODE
    constexpr bool kHasArkode = true;
#else
    constexpr bool kHasArkode = false;
#endif
    return method == Method::tsit5 || kHasArkode;
}

RunResult simulate(const Scenario& scenario, RunControl* control,
                   std::optional<StopCondition> stop) {
    check(scenario);
    if (!has_method(scenario.solver.method)) {
        RunResult result;
        result.status = Status::no_arkode;
        return result;
    }
    Run run(scenario, control, stop);
    try {
        run.go();
    } catch (...) {  // of an effect of the user
        run.hand_over_record();
        throw;
    }
    return run.take_result();
}

}  // namespace stickslip
