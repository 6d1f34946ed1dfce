#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "stickslip/solver/arkode_session.hpp"
#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// A step of ARKODE, seen through its own interpolant.
template <class Phase>
struct ArkodeStep {
    using State = typename Phase::State;
    double start = 0.0, width = 0.0;  ///< s
    State first = {}, last = {};
    const ArkodeSession* session = nullptr;
    Phase* phase = nullptr;

    State dense(double s) const {
        if (s == 0.0) return first;
        if (s == 1.0) return last;
        // The interpolant asks for rates of its own, which must not move the expansion of the field
        // for the steps to come: a recording would change the motion.
        const auto state = phase->state();
        State y;
        session->interpolate(start + s * width, y.data());
        phase->restore(state);
        return y;
    }
};

/// Adaptive integration of a phase by SUNDIALS ARKODE's ERKStep with the pair of Dormand and Prince
/// (7 stages, orders 4 and 5): the independent check of Tsit5. Events are looked for on ARKODE's
/// interpolant, since its own root finding sees only what changes sign over a step.
class Arkode {
public:
    explicit Arkode(const StepperOptions& options) : options_(options) {}

    const StepperOptions& options() const { return options_; }
    const StepCounts& counts() const { return counts_; }

    void reset_counts() {
        counts_ = {};
        begun_ = 0;
    }

    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            typename Phase::State y, Observer&& observe);

private:
    template <class Phase>
    ArkodeSession begin(Phase& phase, bool stalled, double tau, double tau_end,
                        const typename Phase::State& y) const;
    template <class Phase>
    EventHit find_event(Phase& phase, PhaseMemory& memory, const ArkodeStep<Phase>& step,
                        typename Phase::Values& at_start);

    StepperOptions options_;
    StepCounts counts_;
    std::int64_t begun_ = 0;  // steps
};

/// Event functions somewhere.
template <class Phase>
typename Phase::Values event_values(Phase& phase, double tau, const typename Phase::State& y) {
    typename Phase::State unused;
    typename Phase::Values events;
    phase.rebase(y);
    phase.rates(phase.field_at(tau), y, unused, events);
    return events;
}

template <class Phase>
ArkodeSession Arkode::begin(Phase& phase, bool stalled, double tau, double tau_end,
                            const typename Phase::State& y) const {
    using State = typename Phase::State;
    ArkodeProblem problem;
    problem.dimension = Phase::kDim;
    problem.rates = [&phase](double t, const double* at, double* dydt) {
        State state, rates;
        std::copy_n(at, state.size(), state.begin());
        phase.rebase(state);
        typename Phase::Values unused;
        phase.rates(phase.field_at(t), state, rates, unused);
        std::copy_n(rates.begin(), rates.size(), dydt);
    };
    State tolerance = phase.scale(options_.scales);
    for (double& value : tolerance) value *= options_.tolerance;
    // A fast exponential of the currents would be leapt over, as in Tsit5.
    double first = std::min(0.02 / options_.swing_rate, std::max(phase.min_time_constant(), tau));
    if (stalled) first = std::min(first, kShortestStep);
    return ArkodeSession(problem, tau, y.data(), tolerance.data(), tau_end, options_.max_step,
                         first);
}

/// The first event of the step; `at_start` becomes the event functions at its end.
template <class Phase>
EventHit Arkode::find_event(Phase& phase, PhaseMemory& memory, const ArkodeStep<Phase>& step,
                            typename Phase::Values& at_start) {
    using Finder = EventFinder<Phase::kEvents>;
    const auto values = [&](double s) {
        return event_values(phase, step.start + s * step.width, step.dense(s));
    };
    EventSamples<Phase::kEvents> samples;
    samples.start = samples.lowest = at_start;
    samples.early = values(Finder::kEarly);
    samples.late = values(Finder::kLate);
    samples.end = at_start = values(1.0);
    for (const auto& g : {samples.early, values(0.4), values(0.65), samples.late, samples.end}) {
        for (std::size_t i = 0; i < g.size(); ++i) {
            samples.lowest[i] = std::min(samples.lowest[i], g[i]);
        }
    }
    return Finder::find(samples, memory.armed, memory.stalled,
                        [&](std::size_t i, double s) { return values(s)[i]; });
}

template <class Phase, class Observer>
PhaseEnd<Phase> Arkode::advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                                typename Phase::State y, Observer&& observe) {
    typename Phase::Values g = event_values(phase, tau, y);
    memory.begin(g, phase.event_rounding());
    ArkodeSession session = begin(phase, memory.stalled, tau, tau_end, y);
    ArkodeStep<Phase> step;
    step.session = &session;
    step.phase = &phase;
    step.last = y;
    PhaseEnd<Phase> end{
        Status::ok, Event::none, tau, y, {phase.angle(y), phase.angle(y), slip_place(phase, y)}};
    while (tau < tau_end) {
        if (options_.stop && options_.stop->load(std::memory_order_relaxed)) {
            end.status = Status::interrupted;
            break;
        }
        if (++begun_ > options_.most_steps) {
            end.status = Status::too_many_steps;
            break;
        }
        step.start = tau;
        step.first = step.last;
        const ArkodeSession::Outcome outcome = session.step(tau, step.last.data());
        if (outcome.failed || !(outcome.time > tau)) {
            end.status = Status::step_underflow;
            break;
        }
        tau = std::min(outcome.time, tau_end);
        step.width = tau - step.start;
        const EventHit hit = find_event(phase, memory, step, g);
        memory.stalled = false;
        const double stop = observe(step, hit.s);
        const bool stops = hit ? stop < hit.s : stop <= 1.0;
        const double s = stops ? stop : hit.s;
        end.tau = hit || stops ? step.start + s * step.width : tau;
        end.y = step.dense(s);
        phase.rebase(end.y);
        end.trace.step(phase, end.tau - step.start, step.first, end.y);
        if (stops) break;
        if (hit) {
            end.event = Phase::kEvent[static_cast<std::size_t>(hit.index)];
            break;
        }
        if (phase.outside()) {
            end.status = Status::left_workspace;
            break;
        }
    }
    session.add_counts(counts_);
    // ARKODE's last call of the rates was elsewhere.
    phase.rebase(end.y);
    return end;
}

}  // namespace stickslip
