#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "stickslip/arkode_session.hpp"
#include "stickslip/stepping.hpp"

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
        // The interpolant asks for rates of its own, which must not move the bases of the steps to
        // come: a recording would change the motion.
        const Dynamics state = phase->state();
        State y;
        session->interpolate(start + s * width, y.data());
        phase->restore(state);
        return y;
    }
};

/// Adaptive integration of a phase by SUNDIALS ARKODE's ERKStep with the pair of Dormand and Prince
/// (7 stages, orders 4 and 5) and ARKODE's own root finding: the independent check of Tsit5. Roots
/// are seen where an event function changes sign over a step, so a dip inside one needs a smaller
/// max_step.
class Arkode {
public:
    explicit Arkode(const StepperOptions& options) : options_(options) {}

    const StepperOptions& options() const { return options_; }
    const StepCounts& counts() const { return counts_; }

    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            typename Phase::State y, Observer&& observe);

private:
    StepperOptions options_;
    StepCounts counts_;
};

template <class Phase, class Observer>
PhaseEnd<Phase> Arkode::advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                                typename Phase::State y, Observer&& observe) {
    using State = typename Phase::State;
    constexpr auto kEvents = static_cast<std::size_t>(Phase::kEvents);
    typename Phase::Values g;
    State slope;
    phase.rebase(y);
    phase.rates(phase.field_at(tau), y, slope, g);
    if (memory.fresh) {
        for (std::size_t i = 0; i < kEvents; ++i) memory.armed[i] = g[i] > 0.0;
        memory.fresh = false;
    }
    ArkodeProblem problem;
    problem.dimension = Phase::kDim;
    problem.events = Phase::kEvents;
    problem.rates = [&](double t, const double* at, double* dydt, double* values) {
        State state, rates;
        std::copy_n(at, state.size(), state.begin());
        phase.rebase(state);
        typename Phase::Values event_values;
        phase.rates(phase.field_at(t), state, rates, event_values);
        if (dydt) std::copy_n(rates.begin(), rates.size(), dydt);
        if (values) std::copy_n(event_values.begin(), event_values.size(), values);
    };
    State tolerance = phase.scale(options_.scales);
    for (double& value : tolerance) value *= options_.tolerance;

    ArkodeSession session(problem, tau, y.data(), tolerance.data(), tau_end, options_.max_step,
                          0.02 / options_.swing_rate);
    ArkodeStep<Phase> step;
    step.session = &session;
    step.phase = &phase;
    step.last = y;
    PhaseEnd<Phase> end{Status::ok, Event::none, tau, y,
                        {phase.angle(y), phase.angle(y), phase.contact_x(y)}};
    while (tau < tau_end) {
        if (options_.stop && options_.stop->load(std::memory_order_relaxed)) {
            end.status = Status::interrupted;
            break;
        }
        step.start = tau;
        step.first = step.last;
        const ArkodeSession::Outcome outcome = session.step(tau, step.last.data());
        if (outcome.failed) {
            end.status = Status::step_underflow;
            break;
        }
        if (outcome.time >= tau_end)
            tau = tau_end;
        else
            tau = outcome.time;
        step.width = tau - step.start;
        // ARKODE's last call of the rates was elsewhere.
        const State first_rates = slope;
        phase.rebase(step.last);
        phase.rates(phase.field_at(tau), step.last, slope, g);
        end.trace.step(phase, step.width, step.first, first_rates, step.last, slope);
        if (step.width > 0.0) observe(step, 1.0);
        end.tau = tau;
        end.y = step.last;
        if (outcome.root >= 0) {
            end.event = Phase::kEvent[static_cast<std::size_t>(outcome.root)];
            break;
        }
        // ARKODE takes a function that begins at zero for inactive until it has moved, and never
        // sees one that begins at zero and falls.
        for (std::size_t i = 0; i < kEvents && end.event == Event::none; ++i) {
            if (!memory.armed[i] && g[i] < 0.0) end.event = Phase::kEvent[i];
            memory.armed[i] = memory.armed[i] || g[i] > 0.0;
        }
        if (end.event != Event::none) break;
        if (phase.outside()) {
            end.status = Status::left_workspace;
            break;
        }
    }
    session.add_counts(counts_);
    phase.rebase(end.y);
    return end;
}

}  // namespace stickslip
