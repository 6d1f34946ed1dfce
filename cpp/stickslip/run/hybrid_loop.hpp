#pragma once

#include <optional>

#include "stickslip/run/hybrid_run.hpp"

namespace stickslip {

/// The hybrid loop: smooth phases, handed to the integrator, and the events between them.
template <class Integrator>
class HybridLoop : public HybridRun {
public:
    /// Ends early where `stop` says.
    HybridLoop(const Scenario& scenario, RunControl* control,
               std::optional<StopCondition> stop = std::nullopt)
        : HybridRun(scenario, control, stop), integrator_(options()) {}

    RunResult run() {
        try {
            go();
        } catch (...) {  // of an effect of the user
            hand_over_record();
            throw;
        }
        return take_result();
    }

    /// Plays to the end; the result is then to be taken.
    void go() {
        try {
            while (next_phase()) with_phase([&](auto phase) { play(phase); });
        } catch (const WrenchNotFinite& failure) {
            fail(failure);
        }
    }
    RunResult take_result() { return HybridRun::take_result(integrator_.counts()); }

    /// Integrates a phase up to its end, or that of the stretch of voltage.
    template <class Phase>
    void play(Phase& phase) {
        end_phase(phase, integrator_.advance(phase, memory(), tau(), tau_end(), phase.begin(body()),
                                             observer(phase)));
    }
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end) {
        HybridRun::end_phase(phase, end, integrator_.counts().accepted);
    }
    Integrator& integrator() { return integrator_; }

    /// Counts anew what solver.max_steps limits.
    void reset_counts() {
        integrator_.reset_counts();
        HybridRun::reset_counts();
    }

private:
    Integrator integrator_;
};

}  // namespace stickslip
