#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "stickslip/contact/phases.hpp"
#include "stickslip/solver/tsit5_step.hpp"

namespace stickslip {

/// What runs with named effects have beside the numbers of plain ones.
template <class Real>
struct EffectNumbers {
    std::array<FurtherExponential<Real>, kMostPackedExponentials - 1> further;
    SmoothEffects<Real> effects;
};
struct NoEffectNumbers {};

/// All that the steps of a phase need, of one run (D is Dynamics) or of a pack of runs (D is
/// PackDynamics). The members are numbers throughout, in one order: number k of run i of a pack of
/// N is double k N + i of its memory. `kEffects`: whether of runs with named effects.
template <template <class> class PhaseOf, class D, bool kEffects>
struct LaneNumbers {
    using Real = typename D::Real;
    using Phase = PhaseOf<D>;

    Tsit5Progress<Phase> progress;
    PlainDynamics<Real> robot;
    FieldStretch<Real> field;
    [[no_unique_address]] std::conditional_t<kEffects, EffectNumbers<Real>, NoEffectNumbers> named;
    Real contact_x, slip;                      ///< of a phase that has them, see make_phase
    WorkspaceOf<Real> workspace;               ///< where the robot may be
    std::array<Real, Phase::kEvents> unarmed;  ///< 1 while a function has not been positive, else 0
    Real stalled;                              ///< PhaseMemory::stalled
};

/// The phase of these numbers.
template <template <class> class PhaseOf, class D, bool kEffects>
[[gnu::always_inline]] inline PhaseOf<D> make_phase(
    const LaneNumbers<PhaseOf, D, kEffects>& numbers, D& dynamics) {
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
    unsigned to_end = 0;  ///< the attempt goes to the end of its stretch
};

/// The same step of a pack for the machine's registers. `numbers` are the pack's, aligned to 64
/// bytes.
struct LaneKernels {
    using Step = LaneRound (*)(double* numbers);
    struct Steps {
        Step corner_stick = nullptr, corner_slip = nullptr, flight = nullptr;
    };
    int size = 0;         ///< runs in a pack; 1: there are no packs, and no steps of them
    Steps plain = {};     ///< of runs without named effects
    Steps extended = {};  ///< of runs with them
};

/// For the registers of one kind of processor, which has to be this one's (lane_kernel.cpp).
template <int N>
LaneKernels lane_kernels_of();
template <>
LaneKernels lane_kernels_of<4>();
template <>
LaneKernels lane_kernels_of<8>();

/// The widest that this processor has and that the environment variable STICKSLIP_LANES, a means of
/// measurement that is read once, allows: 4 or 8; at 1 every run goes alone.
const LaneKernels& lane_kernels();
/// All that it has, narrowest first, perhaps none: all give the same bits.
const std::vector<LaneKernels>& all_lane_kernels();

}  // namespace stickslip
