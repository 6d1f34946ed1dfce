#pragma once

#include <optional>

#include "stickslip/hybrid_run.hpp"
#include "stickslip/rosenbrock.hpp"

namespace stickslip {

/// The hybrid loop: smooth phases, handed to the integrator, and the events between them.
template <class Integrator>
class HybridLoop : public HybridRun {
public:
    /// Ends early where `stop` says.
    HybridLoop(const Scenario& scenario, RunControl* control,
               std::optional<StopCondition> stop = std::nullopt)
        : HybridRun(scenario, control, stop), integrator_(options()), stiff_(options()) {}

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
    RunResult take_result() { return HybridRun::take_result(counts()); }

    /// Integrates a phase up to its end, or that of the stretch of voltage.
    template <class Phase>
    void play(Phase& phase) {
        if constexpr (Phase::kStiff) {
            const std::int64_t left = options().most_steps - counts().accepted;
            end_phase(phase, stiff_.advance(phase, memory(), tau(), tau_end(), phase.begin(body()),
                                            left, observer(phase)));
        } else {
            end_phase(phase, integrator_.advance(phase, memory(), tau(), tau_end(),
                                                 phase.begin(body()), observer(phase)));
        }
    }
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end) {
        HybridRun::end_phase(phase, end, counts().accepted);
    }
    Integrator& integrator() { return integrator_; }

    /// Counts anew what solver.max_steps limits.
    void reset_counts() {
        integrator_.reset_counts();
        stiff_.reset_counts();
        HybridRun::reset_counts();
    }
    LoopMemory loop_memory() const {
        LoopMemory result = HybridRun::loop_memory();
        result.integrator = integrator_.memory();
        result.integrator.stiff_width = stiff_.memory();
        return result;
    }
    void restore(const LoopMemory& memory) {
        integrator_.restore(memory.integrator);
        stiff_.restore(memory.integrator.stiff_width);
        HybridRun::restore(memory);
    }

private:
    StepCounts counts() const {
        StepCounts sum = integrator_.counts();
        sum.accepted += stiff_.counts().accepted;
        sum.rejected += stiff_.counts().rejected;
        sum.evaluations += stiff_.counts().evaluations;
        return sum;
    }

    Integrator integrator_;
    Rosenbrock stiff_;  // of phases that ask for it
};

}  // namespace stickslip
