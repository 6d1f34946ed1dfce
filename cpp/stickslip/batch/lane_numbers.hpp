#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "stickslip/contact/phases.hpp"
#include "stickslip/solver/tsit5.hpp"

namespace stickslip {

/// What runs with named effects have beside the numbers of plain ones.
template <class Real>
struct EffectNumbers {
    std::array<FurtherExponential<Real>, kMostPackedExponentials - 1> further;
    SmoothEffects<Real> effects;

    [[gnu::always_inline]] constexpr auto members() { return std::tie(further, effects); }
};
struct NoEffectNumbers {
    [[gnu::always_inline]] constexpr auto members() { return std::tuple<>(); }
};

/// All that the steps of a phase need, of one run or of a pack of runs, whose numbers are packs.
/// `kEffects`: whether of runs with named effects.
template <class Phase, bool kEffects>
struct LaneNumbers {
    using Real = typename Phase::Real;
    using Named = std::conditional_t<kEffects, EffectNumbers<Real>, NoEffectNumbers>;

    Tsit5Progress<Phase> progress;
    PlainDynamics<Real> robot;
    FieldSegment<Real> field;
    [[no_unique_address]] Named named;
    Real contact_x, slip;                      ///< of a phase that has them, see make_phase
    WorkspaceOf<Real> workspace;               ///< where the robot may be
    std::array<Real, Phase::kEvents> unarmed;  ///< 1 while a function has not been positive, else 0
    Real stalled;                              ///< PhaseMemory::stalled

    // Lists of numbers that a run puts into its place of a pack, or takes from there.

    /// What a phase, or the next segment, begins with.
    [[gnu::always_inline]] auto beginning() {
        auto& p = progress;
        return std::tuple_cat(
            std::tie(p.tau_end, p.most_steps, p.max_step, p.min_time_constant, p.half_reach,
                     p.step.weight, robot, contact_x, slip, workspace),
            around(), going_on());
    }
    /// What a step changes that the next one needs.
    [[gnu::always_inline]] auto going_on() {
        auto& p = progress;
        return std::tie(p.tau, p.look, p.accepted, p.control, p.trace, p.step.first,
                        p.step.slope[0], p.samples.start, unarmed, stalled);
    }
    /// The field about the robot, and effects.
    [[gnu::always_inline]] auto around() { return std::tie(field, named); }
    /// The last attempt, and what is known from those before.
    [[gnu::always_inline]] auto attempt() { return std::tie(progress, unarmed); }
};

static_assert(kListsAll<Tsit5Progress<CornerStickPhase>> && kListsAll<PlainDynamics<double>> &&
              kListsAll<FieldSegment<double>> && kListsAll<EffectNumbers<double>> &&
              kListsAll<WorkspaceOf<double>>);

/// What came of a step of a pack; bit i is of run i. The steps of runs that are not flagged are
/// done; for the others the caller has to finish the attempt.
struct LaneRound {
    unsigned flagged = 0;
    unsigned to_end = 0;  ///< the attempt goes to the end of its segment
};

/// What can be done with a pack of runs in phases of one kind. `pack`: memory for the numbers of
/// all of them, aligned to 64 bytes, which only this looks into.
template <class Phase, bool kEffects>
struct LaneKernel {
    using Numbers = LaneNumbers<Phase, kEffects>;
    using Copy = void (*)(void* pack, std::size_t place, Numbers& one);
    LaneRound (*step)(void* pack) = nullptr;
    Copy put_beginning = nullptr, put_going_on = nullptr, put_around = nullptr;
    Copy take_attempt = nullptr;
};

/// The kernels for the machine's registers.
struct LaneKernels {
    template <bool kEffects>
    struct Phases {
        LaneKernel<CornerStickPhase, kEffects> corner_stick;
        LaneKernel<CornerSlipPhase, kEffects> corner_slip;
        LaneKernel<FlightPhase, kEffects> flight;
    };
    int size = 1;                ///< runs in a pack; 1: there are no packs, and no steps of them
    Phases<false> plain = {};    ///< of runs without named effects
    Phases<true> extended = {};  ///< of runs with them
};

/// For the registers of one kind of processor, which has to be this one's (lane_kernel.cpp).
template <int N>
LaneKernels lane_kernels_of();
template <>
LaneKernels lane_kernels_of<4>();
template <>
LaneKernels lane_kernels_of<8>();

}  // namespace stickslip
