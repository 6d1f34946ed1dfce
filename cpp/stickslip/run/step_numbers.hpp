#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "stickslip/contact/phases.hpp"
#include "stickslip/solver/tsit5.hpp"

namespace stickslip {

/// Numbers that only runs with named effects have.
template <class Real>
struct EffectNumbers {
    std::array<FurtherExponential<Real>, kMostPackedExponentials - 1> further;
    LawMoment<Real> now;

    [[gnu::always_inline]] constexpr auto members() { return std::tie(further, now); }
};
struct NoEffectNumbers {
    [[gnu::always_inline]] constexpr auto members() { return std::tuple<>(); }
};

/// All that the steps of a phase need, of one run or of a pack of runs, whose numbers are packs.
/// `kEffects`: whether of runs with named effects.
template <class Phase, bool kEffects>
struct StepNumbers {
    using Real = typename Phase::Real;
    using Named = std::conditional_t<kEffects, EffectNumbers<Real>, NoEffectNumbers>;

    Tsit5Progress<Phase> progress;
    PlainDynamics<Real> robot;
    FarField<Real> far;
    FieldSegment<Real> field;
    [[no_unique_address]] Named named;
    Real contact_x, slip;                      ///< of a phase that has them, see make_phase
    WorkspaceOf<Real> workspace;               ///< where the robot may be
    std::array<Real, Phase::kEvents> unarmed;  ///< 1 while a function has not been positive, else 0
    Real stalled;                              ///< PhaseMemory::stalled
    Real done;                                 ///< 1 where the last attempt is to be committed
    PlaceOf<Real, 2> place;                    ///< m, of the centre of mass at its end

    // Lists of numbers that a run puts into its place of a pack, or takes from there.

    /// Numbers at the beginning of a phase, or of its next segment.
    [[gnu::always_inline]] auto beginning() {
        auto& p = progress;
        return std::tuple_cat(
            std::tie(p.tau_end, p.most_steps, p.max_step, p.min_time_constant, p.half_reach, p.tau,
                     p.accepted, p.trace, p.step.weight, p.step.first, p.step.slope[0],
                     p.samples.start, robot, contact_x, slip, workspace),
            around(), going_on());
    }
    /// Numbers that may change between an attempt and the next one.
    [[gnu::always_inline]] auto going_on() {
        return std::tie(progress.control, progress.look, unarmed, stalled, done);
    }
    /// The field about the robot, and effects.
    [[gnu::always_inline]] auto around() { return std::tie(far, field, named); }
    /// The last attempt, and what is known from those before.
    [[gnu::always_inline]] auto attempt() {
        return std::tie(progress, unarmed, field, named, place);
    }
};

static_assert(kListsAll<Tsit5Progress<CornerStickPhase>> && kListsAll<PlainDynamics<double>> &&
              kListsAll<FieldSegment<double>> && kListsAll<FarField<double>> &&
              kListsAll<EffectNumbers<double>> && kListsAll<WorkspaceOf<double>>);

/// Result of an attempt; bit i is of run i of a pack. Attempts that are not flagged are steps; the
/// caller decides about the others.
struct StepRound {
    unsigned flagged = 0;
    unsigned to_end = 0;    ///< the attempt goes to the end of its segment
    unsigned may_fire = 0;  ///< an event function may have fallen through zero in it

    /// Result of run `i` of a pack.
    StepRound of(std::size_t i) const {
        return {flagged >> i & 1u, to_end >> i & 1u, may_fire >> i & 1u};
    }
};

/// Most numbers of all laws of the runs in a pack.
inline constexpr std::size_t kMostPackedLawNumbers = 96;

/// Functions that step runs in phases of one kind.
template <class Phase, bool kEffects>
struct StepKernel {
    using Numbers = StepNumbers<Phase, kEffects>;
    using Copy = void (*)(void* pack, std::size_t place, Numbers& one);
    /// Steps of one run, until an attempt is flagged or many are done. laws: numbers of the laws of
    /// the table; of a pack, of each law for all its runs.
    StepRound (*run)(Numbers& one, const LawTable& table, const double* laws) = nullptr;
    /// A step of a pack. `pack`: memory for the numbers of all its runs, aligned to 64 bytes, which
    /// only this looks into.
    StepRound (*step)(void* pack, const LawTable& table, const double* laws) = nullptr;
    Copy put_beginning = nullptr, put_going_on = nullptr, put_around = nullptr;
    Copy take_attempt = nullptr;
};

/// The kernels for one kind of processor.
struct StepKernels {
    template <bool kEffects>
    struct Phases {
        StepKernel<CornerStickPhase, kEffects> corner_stick;
        StepKernel<CornerSlipPhase, kEffects> corner_slip;
        StepKernel<FlightPhase, kEffects> flight;

        const auto& of(const CornerStickPhase&) const { return corner_stick; }
        const auto& of(const CornerSlipPhase&) const { return corner_slip; }
        const auto& of(const FlightPhase&) const { return flight; }
    };
    Processor processor = Processor::baseline;
    int size = 1;                ///< runs in a pack; 1: there are no packs, and no steps of them
    Phases<false> plain = {};    ///< of runs without named effects
    Phases<true> extended = {};  ///< of runs with them
};

/// Kernels for one kind of processor, which has to be this one's (step_kernel.cpp).
template <Processor P>
StepKernels step_kernels_of();
template <>
StepKernels step_kernels_of<Processor::baseline>();
template <>
StepKernels step_kernels_of<Processor::x86_64_v3>();
template <>
StepKernels step_kernels_of<Processor::x86_64_v4>();

/// The widest for this processor that the environment variables STICKSLIP_PROCESSOR and
/// STICKSLIP_LANES, means of measurement that are read once, allow: baseline, x86-64-v3 or
/// x86-64-v4, and packs of 1 (every run goes alone), 4 or 8 runs. Those with fused multiply-add,
/// all but the baseline, give the same bits.
const StepKernels& step_kernels();
/// Name of a processor, as in STICKSLIP_PROCESSOR.
const char* name_of(Processor processor);

}  // namespace stickslip
