#include "stickslip/run/step_numbers.hpp"

// Steps of one run and of packs of runs. Compiled once for each kind of processor
// (STICKSLIP_PROCESSOR) and the width of its registers (STICKSLIP_WIDTH), so no function here may
// have the name of one in another file: all are templates over packs of that processor.
namespace stickslip {

/// The dynamics of a pack of robots without laws or with them; see Dynamics for the
/// meaning.
template <class R, bool kEffects>
class PackDynamics {
public:
    using Real = R;
    using Named = std::conditional_t<kEffects, EffectNumbers<Real>, NoEffectNumbers>;

    /// numbers: of the laws of the table, of each law for all robots.
    PackDynamics(const PlainDynamics<Real>& robot, const FieldSegment<Real>& field,
                 const Named& named, const LawTable& table, const double* numbers)
        : robot_(&robot), field_(&field), named_(&named), table_(&table), numbers_(numbers) {}

    const PlainDynamics<Real>& robot() const { return *robot_; }
    [[gnu::always_inline]] ExpansionOf<Real> field_at(Real tau) const {
        ExpansionOf<Real> result = field_->at(tau);
        if constexpr (kEffects) {
            for (const FurtherExponential<Real>& each : named_->further) {
                if (any(each.rate > 0.0)) each.add(tau, result);
            }
        }
        return result;
    }
    [[gnu::always_inline]] PoseOf<Real> pose(Real angle) const { return robot_->pose(angle); }
    [[gnu::always_inline]] Real static_coefficient(Real x, const PoseOf<Real>& pose, Real,
                                                   Real tau) const {
        const Real coefficient = robot_->static_friction;
        if constexpr (kEffects) return laws().static_coefficient(coefficient, x, pose, tau);
        return coefficient;
    }
    [[gnu::always_inline]] Real directional(Real coefficient, Real slip_sign) const {
        if constexpr (kEffects) return laws().directional(coefficient, slip_sign);
        return coefficient;
    }
    [[gnu::always_inline]] Real corner_kinetic(Real slip_sign, Real slip_velocity, Real x,
                                               const PoseOf<Real>& pose, Real, const LoadOf<Real>&,
                                               Real tau) const {
        const Real coefficient = robot_->kinetic_friction;
        if constexpr (kEffects) {
            return laws().kinetic_coefficient(coefficient, slip_sign, slip_velocity, x, pose, tau);
        }
        return coefficient;
    }
    [[gnu::always_inline]] LoadOf<Real> load(const PlanarFieldOf<Real>& field, Real tau, Real, Real,
                                             const PoseOf<Real>& pose, Real vx, Real vz,
                                             Real omega) const {
        if constexpr (kEffects) return robot_->load(field, tau, pose, vx, vz, omega, 0.0, laws());
        return robot_->load(field, tau, pose, vx, vz, omega, 0.0);
    }

private:
    [[gnu::always_inline]] Laws<Real> laws() const {
        return {*table_, reinterpret_cast<const Real*>(numbers_), named_->now};
    }

    const PlainDynamics<Real>* robot_;
    const FieldSegment<Real>* field_;
    const Named* named_;
    const LawTable* table_;
    const double* numbers_;
};

/// The phase of these numbers.
template <class Phase, bool kEffects>
[[gnu::always_inline]] inline Phase make_phase(const StepNumbers<Phase, kEffects>& numbers,
                                               auto& dynamics) {
    const FixedFrame frame(dynamics);
    if constexpr (Phase::kFlies) {
        return Phase(frame);
    } else if constexpr (Phase::kSlips) {
        return Phase(frame, {numbers.contact_x}, {numbers.slip, 0.0});
    } else {
        return Phase(frame, {numbers.contact_x});
    }
}

/// Moves the field's near centre to the robot where it has left its neighbourhood.
template <class Phase, bool kEffects>
[[gnu::always_inline]] inline void follow(StepNumbers<Phase, kEffects>& n,
                                          MaskOf<typename Phase::Real> done) {
    using Real = typename Phase::Real;
    const auto left =
        done & is_far(n.place, n.field.centre, 2.0 * LocalField::kNear * n.progress.half_reach);
    if (!any(left)) return;
    FieldSegment<Real> near = n.field;
    n.far.move(n.place, near);
    blend<Real>(left, n.field, near);
    if constexpr (kEffects) {
        for (FurtherExponential<Real>& each : n.named.further) {
            const auto there = left & (each.rate > 0.0);
            if (!any(there)) continue;
            auto moved = Series<Real, 2>::moved(each.far, n.far.distance_to(n.place));
            blend<Real>(there, each.basis, moved);
        }
    }
}

/// Where event functions have to be looked at, each as it is armed.
template <std::size_t M, class Real>
[[gnu::always_inline]] inline auto may_fire(const EventSamples<M, Real>& g,
                                            const std::array<Real, M>& unarmed, std::size_t i) {
    const auto not_yet = unarmed[i] > 0.0;
    return ((!not_yet) & ((g.start[i] <= 0.0) | (g.end[i] <= 0.0) | g.may_dip(i))) |
           (not_yet & !g.rises(i));
}

/// The same of all functions.
template <std::size_t M, class Real>
[[gnu::always_inline]] inline MaskOf<Real> may_fire(const EventSamples<M, Real>& g,
                                                    const std::array<Real, M>& unarmed) {
    using Some = typename SideBySide<Real>::Type;
    constexpr std::size_t kSome = Some::kSize;
    MaskOf<Real> result = {};
    std::size_t i = 0;
    if constexpr (kIsOne<Real> && kSome <= M) {
        const auto some = [](const std::array<Real, M>& from) __attribute__((always_inline)) {
            return std::array<Some, 1>{side_by_side<Some>(from[0])};
        };
        const EventSamples<1, Some> first = {some(g.start), some(g.end), some(g.early),
                                             some(g.late), some(g.lowest)};
        result = any(may_fire(first, some(unarmed), 0));
        i = kSome;
    }
    for (; i < M; ++i) result = result | may_fire(g, unarmed, i);
    return result;
}

/// Commits the last step where it is done, and makes the next attempt.
template <class Phase, bool kEffects>
[[gnu::always_inline]] inline StepRound next_attempt(StepNumbers<Phase, kEffects>& n,
                                                     auto&& dynamics) {
    using Real = typename Phase::Real;
    auto& p = n.progress;
    const Phase phase = make_phase(n, dynamics);
    const auto done = n.done > 0.0;
    p.commit(phase, done, MaskOf<Real>{});
    follow(n, done);

    const auto to_end = p.attempt(phase);

    // Flags attempts for the caller: a step that is not accepted, ends the segment or may hold an
    // event or a turn of the field; a robot that leaves the middle of the field's expansion.
    auto flagged = (!(p.error <= 1.0)) | to_end | (p.accepted + 1.0 >= p.most_steps) |
                   (!(p.tau + p.step.width > p.tau)) | (n.stalled > 0.0) |
                   (p.tau + p.step.width >= p.look);
    const auto fires = may_fire(p.samples, n.unarmed);
    flagged = flagged | fires;
    n.place = phase.centre(p.step.last, dynamics.pose(phase.angle(p.step.last)));
    flagged = flagged | !n.workspace.holds(n.place) | is_far(n.place, n.far.centre, p.half_reach);

    n.done = select(flagged, Real(0.0), Real(1.0));
    for (Real& unarmed : n.unarmed) unarmed = select(flagged, unarmed, Real(0.0));
    return {members(flagged), members(to_end), members(fires)};
}

template <template <class> class PhaseOf, class Real, bool kEffects>
struct StepsOf {
    using Phase = PhaseOf<PackDynamics<Real, kEffects>>;
    using Numbers = StepNumbers<Phase, kEffects>;
    using One = StepNumbers<PhaseOf<Dynamics>, kEffects>;
    static_assert(sizeof(Numbers) == Real::kSize * sizeof(One));

    static Numbers& of(void* pack) { return *static_cast<Numbers*>(pack); }
    template <auto kList>
    static void put(void* pack, std::size_t place, One& one) {
        const auto copy = [place](Real & to, const double& from) __attribute__((always_inline)) {
            to.v[place] = from;
        };
        visit_numbers(copy, kList(of(pack)), kList(one));
    }
    static void take_attempt(void* pack, std::size_t place, One& one) {
        const auto copy = [place](double& to, const Real& from) __attribute__((always_inline)) {
            to = from.v[place];
        };
        visit_numbers(copy, one.attempt(), of(pack).attempt());
    }
    static StepRound step(void* pack, const LawTable& table, const double* laws) {
        Numbers& n = of(pack);
        return next_attempt(n,
                            PackDynamics<Real, kEffects>(n.robot, n.field, n.named, table, laws));
    }
    /// Steps of one run, whose numbers are those of a pack of one.
    static StepRound run(One& one, const LawTable& table, const double* laws) {
        constexpr int kMany = 10'000;  // some ms of work: a stop is looked at that often
        Numbers& n = of(&one);
        PackDynamics<Real, kEffects> dynamics(n.robot, n.field, n.named, table, laws);
        StepRound round;
        for (int i = 0; i < kMany && round.flagged == 0; ++i) round = next_attempt(n, dynamics);
        return round;
    }
};

namespace {

constexpr Processor kProcessor = Processor::STICKSLIP_PROCESSOR;

template <template <class> class PhaseOf, bool kEffects>
StepKernel<PhaseOf<Dynamics>, kEffects> kernel_of() {
    using Alone = StepsOf<PhaseOf, Pack<1, kProcessor>, kEffects>;
    if constexpr (STICKSLIP_WIDTH == 1) {
        return {&Alone::run};
    } else {
        using Packed = StepsOf<PhaseOf, Pack<STICKSLIP_WIDTH, kProcessor>, kEffects>;
        return {&Alone::run,
                &Packed::step,
                &Packed::template put<[](auto& numbers) { return numbers.beginning(); }>,
                &Packed::template put<[](auto& numbers) { return numbers.going_on(); }>,
                &Packed::template put<[](auto& numbers) { return numbers.around(); }>,
                &Packed::take_attempt};
    }
}

template <bool kEffects>
StepKernels::Phases<kEffects> kernels_of_phases() {
    return {kernel_of<CornerStickPhaseOf, kEffects>(), kernel_of<CornerSlipPhaseOf, kEffects>(),
            kernel_of<FlightPhaseOf, kEffects>()};
}

}  // namespace

template <>
StepKernels step_kernels_of<kProcessor>() {
    return {kProcessor, STICKSLIP_WIDTH, kernels_of_phases<false>(), kernels_of_phases<true>()};
}

}  // namespace stickslip
