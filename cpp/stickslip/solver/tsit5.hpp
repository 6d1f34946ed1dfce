#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/stepping.hpp"
#include "stickslip/solver/tsit5_step.hpp"

namespace stickslip {

/// Adaptive integration of a phase by Tsit5, with events located on the dense output.
class Tsit5 {
public:
    explicit Tsit5(const StepperOptions& options)
        : options_(options),
          first_width_(0.4 * std::pow(options.tolerance / 1e-6, 0.2) / options.swing_rate) {}

    const StepperOptions& options() const { return options_; }
    const StepCounts& counts() const { return counts_; }
    /// Counts anew, and with that what is left of options().most_steps.
    void reset_counts() { counts_ = {}; }

    /// Integrates from `tau` to `tau_end` or the first event. `observe(step, s)` is called
    /// for the steps on the way, with the fraction s that belongs to the phase; it answers at which
    /// fraction the run is to stop, or kGoesOn.
    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            typename Phase::State y, Observer&& observe) {
        Tsit5Progress<Phase> progress = begin(phase, memory, tau, tau_end, y);
        PhaseEnd<Phase> end;
        do {
            if (options_.stop && options_.stop->load(std::memory_order_relaxed)) {
                return leave(progress, {Status::interrupted, Event::none, progress.tau,
                                        progress.step.first, progress.trace});
            }
            const bool to_end = progress.begin_step(phase);
            progress.attempt(phase);
            if (finish(phase, memory, progress, to_end, observe, end)) return end;
        } while (true);
    }

    // The parts of `advance`, for lanes.

    template <class Phase>
    Tsit5Progress<Phase> begin(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                               const typename Phase::State& y);

    /// What follows an attempt: accepts the step or not, looks for events; true if the phase, or
    /// the stretch, has ended.
    template <class Phase, class Observer>
    bool finish(Phase& phase, PhaseMemory& memory, Tsit5Progress<Phase>& progress, bool to_end,
                Observer&& observe, PhaseEnd<Phase>& end);

private:
    template <class Phase>
    PhaseEnd<Phase> leave(const Tsit5Progress<Phase>& progress, const PhaseEnd<Phase>& end) {
        const auto accepted = static_cast<std::int64_t>(progress.accepted);
        counts_.accepted += accepted;
        counts_.evaluations += 6 * accepted;
        return end;
    }

    StepperOptions options_;
    StepCounts counts_;
    double first_width_;  // s, of a phase and of a stretch: a part of a free swing that the
                          // tolerance allows
};

template <class Phase>
Tsit5Progress<Phase> Tsit5::begin(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                                  const typename Phase::State& y) {
    Tsit5Progress<Phase> progress = {};
    Tsit5Step<Phase>& step = progress.step;
    step.first = y;
    const typename Phase::State scale = phase.scale(options_.scales);
    const double norm = options_.tolerance * std::sqrt(static_cast<double>(scale.size()));
    for (std::size_t i = 0; i < scale.size(); ++i) step.weight[i] = 1.0 / (scale[i] * norm);
    phase.rebase(y);
    phase.rates(phase.field_at(tau), y, step.slope[0], progress.samples.start);
    ++counts_.evaluations;
    // A phase begins with the first width: a longer step could leap over the whole of a short one.
    // One that goes on in a new stretch of voltage is known to last. Two modes may send the body to
    // each other without time going on: then the step is the shortest that is far above the
    // resolution of time.
    const double usual = memory.born ? first_width_ : 2.0 * first_width_;
    const double width = memory.stalled ? std::min(usual, kShortestStep) : usual;
    memory.begin(progress.samples.start, phase.event_rounding());
    progress.trace = {phase.angle(y), phase.angle(y), slip_place(phase, y)};
    progress.control = {width, WidthControl<double>::kLeastLogError, 0.0};
    progress.tau = tau;
    progress.tau_end = tau_end;
    progress.look = std::numeric_limits<double>::infinity();
    progress.accepted = 0.0;
    progress.most_steps = static_cast<double>(options_.most_steps - counts_.accepted);
    progress.max_step =
        options_.max_step > 0.0 ? options_.max_step : std::numeric_limits<double>::infinity();
    if constexpr (requires { Phase::kRests; }) {
        progress.max_step = std::min(progress.max_step, options_.longest_rest);
    }
    progress.min_time_constant = phase.min_time_constant();
    progress.half_reach = 0.5 * phase.reach();
    return progress;
}

template <class Phase, class Observer>
bool Tsit5::finish(Phase& phase, PhaseMemory& memory, Tsit5Progress<Phase>& p, bool to_end,
                   Observer&& observe, PhaseEnd<Phase>& end) {
    using Finder = EventFinder<Phase::kEvents>;
    const Tsit5Step<Phase>& step = p.step;
    const auto ended = [&](Status status) {
        end = leave(p, {status, Event::none, p.tau, step.first, p.trace});
        return true;
    };
    if (!(p.tau + step.width > p.tau)) return ended(Status::step_underflow);
    if (!(p.error <= 1.0)) {
        ++counts_.rejected;
        counts_.evaluations += 6;
        p.control.reject(step.width, p.error);
        if (p.control.proposal >= 1e-15 * std::max(1e-3, p.tau_end)) return false;
        return ended(std::isfinite(p.error) ? Status::step_underflow : Status::not_finite);
    }
    const auto value = [&](std::size_t i, double s) {
        ++counts_.evaluations;
        const typename Tsit5Step<Phase>::At at(step, s);
        return phase.event(i, step.start + s * step.width, at);
    };
    const EventHit hit = Finder::find(p.samples, memory.armed, memory.stalled, value);
    memory.stalled = false;
    const double stop = observe(step, hit.s);
    const bool stops = hit ? stop < hit.s : stop <= 1.0;
    if (hit || stops) {
        const double s = stops ? stop : hit.s;
        const double tau = p.tau + s * step.width;
        const typename Phase::State last = s == 0.0 ? step.first : step.dense(s);
        p.trace.step(phase, s * step.width, step.first, last);
        p.accepted += 1.0;
        const Event event =
            stops ? Event::none : Phase::kEvent[static_cast<std::size_t>(hit.index)];
        end = leave(p, {Status::ok, event, tau, last, p.trace});
        return true;
    }
    p.commit(phase, true, to_end);
    phase.rebase(step.first);
    if (phase.outside()) return ended(Status::left_workspace);
    if (to_end) return ended(Status::ok);
    return p.accepted >= p.most_steps && ended(Status::too_many_steps);
}

}  // namespace stickslip
