#include "stickslip/run/simulation.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "stickslip/run/assembly.hpp"
#include "stickslip/run/run.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

namespace {

std::vector<double> marks(const Scenario& scenario, const std::optional<StopCondition>& stop) {
    const Window window = measuring_window(scenario);
    std::vector<double> result = {window.start, window.end};
    if (stop && stop->quantity == StopCondition::Quantity::time) {
        result.push_back(stop->value);
        std::sort(result.begin(), result.end());
    }
    return result;
}

template <class... Parts>
std::string joined(const Parts&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    return text.str();
}

// Sentence with the times that the steps had to follow: a wrong unit shows in them.
std::string times(const RunResult& result) {
    std::string text;
    const StepCounts& steps = result.steps;
    if (steps.accepted > 0) {
        text = joined("its steps took ",
                      (result.summary.simulated_time - result.counted_from) /
                          static_cast<double>(steps.accepted),
                      " s in the mean, ");
    }
    text += joined("a free swing takes ", 2.0 * std::numbers::pi / result.swing_rate, " s");
    const Decay& decay = result.decay;
    if (!decay.key.empty()) {
        text += joined(", ", decay.key, " = ", decay.value, " damps a motion in ", 1.0 / decay.rate,
                       " s");
    }
    return text;
}

}  // namespace

std::string message(const RunResult& result) {
    const StatusRow& row = row_of(result.status);
    std::string what = row.message, then = row.remedy;
    switch (result.status) {
        case Status::ok:
            if (!result.stopped) return what;
            what = "the run met its condition";
            break;
        case Status::no_arkode:
            return what + "; " + then;
        case Status::step_underflow:
            what += ": " + times(result);
            break;
        case Status::too_many_steps:
            what =
                joined("the run had taken as many steps as solver.max_steps = ", result.most_steps,
                       " allows: ", times(result));
            break;
        case Status::not_finite:
            what += ": " + times(result);
            if (!result.effect.empty()) {
                what = joined("the function of effect ", result.effect,
                              " gave a force or torque that is not a finite number");
                then.clear();
            }
            break;
        case Status::left_workspace:
            if (result.map) {
                const auto& [low, high] = result.map->box();
                what =
                    joined("the robot left coil.map, which has the field from x = ", low.x(),
                           " to ", high.x(), " m and from z = ", low.z(), " to ", high.z(), " m");
                then = "give fewer pulses or less field, or a map that reaches farther";
            } else if (result.summary.simulated_time == 0.0) {
                what = "the robot was beyond the coils";
                then = "begin nearer to the centre (initial.x, initial.y)";
            }
            break;
        case Status::turns_too_fast:
            what = joined("the horizontal field turned at ", result.heading_end.rate,
                          " rad/s, faster than the robot can follow in a field of that size, ",
                          result.heading_end.limit, " rad/s");
            break;
        case Status::too_many_events:
        case Status::heading_lost:
        case Status::interrupted:
            break;
    }
    what = joined("at t = ", result.summary.simulated_time, " s ", what);
    return then.empty() ? what : what + "; " + then;
}

bool has_method(Method method) {
#ifdef STICKSLIP_WITH_ARKODE
    constexpr bool kHasArkode = true;
#else
    constexpr bool kHasArkode = false;
#endif
    return method == Method::tsit5 || kHasArkode;
}

// Here, so that run.cpp, which takes longest to compile, stays as it is when a key is added.
Run::Run(const Scenario& scenario, RunControl* control, std::optional<StopCondition> stop)
    : player_(scenario, marks(scenario, stop), control ? &control->stop : nullptr),
      window_observer_(measuring_window(scenario), pulse_period(scenario), player_,
                       !(control && control->motion_only), scenario.record.pull_share),
      recorder_(scenario.record, player_.sign(), player_.in_whole_plane(),
                !player_.model().inner.absent()),
      tsit5_(player_.options()),
      control_(control),
      stop_(stop) {
    if (scenario.solver.method == Method::arkode) {
#ifdef STICKSLIP_WITH_ARKODE
        arkode_.emplace(player_.options());
#else
        result_.status = Status::no_arkode;
        throw std::invalid_argument(stickslip::message(result_));
#endif
    }
    fits_kernels_ = is_tsit5() && !player_.in_whole_plane() && player_.model().fits_kernels() &&
                    player_.circuit().fades() &&
                    player_.circuit().exponentials() <= kMostPackedExponentials;
    result_.most_steps = scenario.solver.max_steps;
    result_.map = scenario.map;
    result_.swing_rate = player_.options().swing_rate;
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
