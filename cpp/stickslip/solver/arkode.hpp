#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "stickslip/solver/arkode_session.hpp"
#include "stickslip/solver/loop.hpp"

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

template <class Phase>
struct ArkodeProgress {
    using State = typename Phase::State;
    using Values = typename Phase::Values;
    using Samples = EventSamples<Phase::kEvents>;

    double tau, tau_end;  ///< s
    double most_steps, accepted;
    MotionTrace<double> trace;
    ArkodeStep<Phase> step;
    Samples samples;
    std::unique_ptr<ArkodeSession> session;

    bool attempt(Phase& phase) {
        const ArkodeSession::Outcome outcome = session->step(tau, step.last.data());
        step.start = tau;
        step.width = outcome.failed ? 0.0 : std::min(outcome.time, tau_end) - tau;
        if (step.width > 0.0) look(phase);
        return outcome.time >= tau_end;
    }
    static bool is_accepted() { return true; }  // ARKODE tries again by itself
    static Status reject(StepCounts&) { return Status::ok; }
    double event(Phase& phase, std::size_t i, double s) const { return events(phase, s)[i]; }
    void commit(const Phase& phase, bool, bool to_end) {
        trace.step(phase, step.width, step.first, step.last);
        accepted += 1.0;
        tau = to_end ? tau_end : tau + step.width;
        step.first = step.last;
        samples.start = samples.end;
    }
    /// ARKODE's last call of the rates was elsewhere.
    void leave(Phase& phase, const State& y, StepCounts& counts) const {
        session->add_counts(counts);
        phase.field().rebase(phase.place_of(tau, y));
    }

private:
    Values events(Phase& phase, double s) const {
        const State y = step.dense(s);
        State unused;
        Values result;
        const double at = step.start + s * step.width;
        phase.field().rebase(phase.place_of(at, y));
        phase.rates(phase.field_at(at), y, unused, result);
        return result;
    }
    // Its own root finding sees only what changes sign over a step.
    void look(Phase& phase) {
        samples.lowest = samples.start;
        const auto see = [&](double s) {
            const Values g = events(phase, s);
            for (std::size_t i = 0; i < g.size(); ++i) {
                samples.lowest[i] = std::min(samples.lowest[i], g[i]);
            }
            return g;
        };
        samples.early = see(Samples::kEarly);
        see(0.4);
        see(0.65);
        samples.late = see(Samples::kLate);
        samples.end = see(1.0);
    }
};

/// SUNDIALS ARKODE's ERKStep with the pair of Dormand and Prince (7 stages, orders 4 and 5): the
/// independent check of Tsit5. It owns its steps and its interpolant, on which events are looked
/// for.
struct ArkodeMethod {
    template <class Phase>
    using Progress = ArkodeProgress<Phase>;

    explicit ArkodeMethod(const StepperOptions&) {}

    template <class Phase>
    void start(const StepperOptions& options, Phase& phase, const PhaseMemory& memory,
               const typename Phase::State&, ArkodeProgress<Phase>& p) const {
        using State = typename Phase::State;
        ArkodeProblem problem;
        problem.dimension = Phase::kDim;
        problem.rates = [&phase](double t, const double* at, double* dydt) {
            State state, rates;
            std::copy_n(at, state.size(), state.begin());
            phase.field().rebase(phase.place_of(t, state));
            typename Phase::Values unused;
            phase.rates(phase.field_at(t), state, rates, unused);
            std::copy_n(rates.begin(), rates.size(), dydt);
        };
        State tolerance = phase.scale(options.scales);
        for (double& value : tolerance) value *= options.tolerance;
        // A fast exponential of the currents would be leapt over, as in Tsit5.
        double first =
            std::min(0.02 / options.swing_rate, std::max(phase.min_time_constant(), p.tau));
        if (memory.stalled) first = std::min(first, kShortestStep);
        p.session =
            std::make_unique<ArkodeSession>(problem, p.tau, p.step.first.data(), tolerance.data(),
                                            p.tau_end, options.max_step, first);
        p.step.session = p.session.get();
        p.step.phase = &phase;
    }
};
using Arkode = StepLoop<ArkodeMethod>;

}  // namespace stickslip
