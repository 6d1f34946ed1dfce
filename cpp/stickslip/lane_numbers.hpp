#pragma once

#include <vector>

#include "stickslip/phases.hpp"
#include "stickslip/tsit5_step.hpp"

namespace stickslip {

/// All that the steps of a phase need, of one run (D is Dynamics) or of a pack of runs (D is
/// PackDynamics). The members are numbers throughout, in one order: number k of run i of a pack of
/// N is double k N + i of its memory.
template <template <class> class PhaseOf, class D>
struct LaneNumbers {
    using Real = typename D::Real;
    using Phase = PhaseOf<D>;

    Tsit5Progress<Phase> progress;
    PlainDynamics<Real> robot;
    FieldStretch<Real> field;
    Real contact_x, slip;                      ///< of a phase that has them, see make_phase
    Real workspace;                            ///< m, how far the robot may go
    std::array<Real, Phase::kEvents> unarmed;  ///< 1 while a function has not been positive, else 0
    Real stalled;                              ///< PhaseMemory::stalled
};

/// The phase of these numbers.
template <template <class> class PhaseOf, class D>
[[gnu::always_inline]] inline PhaseOf<D> make_phase(const LaneNumbers<PhaseOf, D>& numbers,
                                                    D& dynamics) {
    using Phase = PhaseOf<D>;
    if constexpr (Phase::kFlies) {
        return Phase(dynamics);
    } else if constexpr (Phase::kSlips) {
        return Phase(dynamics, numbers.contact_x, numbers.slip, 0.0);
    } else {
        return Phase(dynamics, numbers.contact_x);
    }
}

/// What came of a step of a pack; bit i is of run i. The steps of runs that are not flagged are
/// done; for the others the caller has to finish the attempt.
struct LaneRound {
    unsigned flagged = 0;
    unsigned far = 0;     ///< too far from a base for its series: the attempt is void
    unsigned to_end = 0;  ///< the attempt goes to the end of its stretch
};

/// The same step of a pack for the machine's registers. `numbers` are the pack's, aligned to 64
/// bytes.
struct LaneKernels {
    using Step = LaneRound (*)(double* numbers);
    int size = 0;  ///< runs in a pack; 1: there are no packs, and no steps of them
    Step corner_stick = nullptr, corner_slip = nullptr, flight = nullptr;
};

/// The widest that this processor has and that the environment variable STICKSLIP_LANES, a means of
/// measurement that is read once, allows: 2, 4 or 8; at 1 every run goes alone.
const LaneKernels& lane_kernels();
/// All that it has, narrowest first: all give the same bits.
const std::vector<LaneKernels>& all_lane_kernels();

}  // namespace stickslip
