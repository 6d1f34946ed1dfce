#include "stickslip/batch/lane_numbers.hpp"

// One step of a pack of runs. Compiled once for each width of the processor's registers
// (STICKSLIP_LANE_WIDTH), so nothing here may be shared with other translation units: all is
// templates over a pack of that width.
namespace stickslip {

/// The dynamics of a pack of robots without named effects or with them; see Dynamics for the
/// meaning.
template <class R, bool kEffects>
class PackDynamics {
public:
    using Real = R;
    using Named = std::conditional_t<kEffects, EffectNumbers<Real>, NoEffectNumbers>;

    PackDynamics(const PlainDynamics<Real>& robot, const FieldSegment<Real>& field,
                 const Named& named)
        : robot_(&robot), field_(&field), named_(&named) {}

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
    [[gnu::always_inline]] Real static_limit(double slip, Real x, const PoseOf<Real>&, Real,
                                             Real) const {
        if constexpr (kEffects) return robot_->static_friction * friction().place(slip, x);
        return robot_->static_friction;
    }
    [[gnu::always_inline]] Real corner_kinetic(Real slip, Real slip_velocity, Real x,
                                               const PoseOf<Real>&, Real, const LoadOf<Real>&,
                                               Real) const {
        if constexpr (kEffects) {
            return friction().kinetic(robot_->static_friction, robot_->kinetic_friction,
                                      slip_velocity) *
                   friction().place(slip, x);
        }
        return robot_->kinetic_friction;
    }
    [[gnu::always_inline]] LoadOf<Real> load(const PlanarFieldOf<Real>& field, Real tau, Real, Real,
                                             const PoseOf<Real>& pose, Real vx, Real vz,
                                             Real omega) const {
        const Real mx = robot_->moment_x(pose), mz = robot_->moment_z(pose);
        LoadOf<Real> load = robot_->load(field, mx, mz, vx, vz, omega);
        if constexpr (kEffects) {
            const SmoothEffects<Real>& e = named_->effects;
            const Real cosine = e.turn_cosine * pose.cosine - e.turn_sine * pose.sine;
            const Real sine = e.turn_sine * pose.cosine + e.turn_cosine * pose.sine;
            e.forces.add(field, mx, mz, cosine, vx, vz, load);
            load.contact_adhesion =
                robot_->adhesion * e.adhesion.at_angle(sine) * e.adhesion.aged(e.contact_age + tau);
        }
        return load;
    }

private:
    const SmoothFriction<Real>& friction() const { return named_->effects.friction; }

    const PlainDynamics<Real>* robot_;
    const FieldSegment<Real>* field_;
    const Named* named_;
};

/// The phase of these numbers.
template <class Phase, bool kEffects>
[[gnu::always_inline]] inline Phase make_phase(const LaneNumbers<Phase, kEffects>& numbers,
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

template <template <class> class PhaseOf, class Real, bool kEffects>
struct PackOf {
    using Numbers = LaneNumbers<PhaseOf<PackDynamics<Real, kEffects>>, kEffects>;
    using One = LaneNumbers<PhaseOf<Dynamics>, kEffects>;
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
    static LaneRound step(void* pack);
    static LaneKernel<PhaseOf<Dynamics>, kEffects> kernel() {
        return {&step, &put<[](auto& numbers) { return numbers.beginning(); }>,
                &put<[](auto& numbers) { return numbers.going_on(); }>,
                &put<[](auto& numbers) { return numbers.around(); }>, &take_attempt};
    }
};

template <template <class> class PhaseOf, class Real, bool kEffects>
LaneRound PackOf<PhaseOf, Real, kEffects>::step(void* pack) {
    Numbers& n = of(pack);
    auto& p = n.progress;
    PackDynamics<Real, kEffects> dynamics(n.robot, n.field, n.named);
    const auto phase = make_phase(n, dynamics);

    const auto to_end = p.attempt(phase);

    // What the caller has to see: a step that is not accepted, ends the segment or may hold an
    // event or a turn of the field; a robot that leaves the middle of the field's expansion.
    auto flagged = (!(p.error <= 1.0)) | to_end | (p.accepted + 1.0 >= p.most_steps) |
                   (!(p.tau + p.step.width > p.tau)) | (n.stalled > 0.0) |
                   (p.tau + p.step.width >= p.look);
    for (std::size_t i = 0; i < p.samples.end.size(); ++i) {
        const auto unarmed = n.unarmed[i] > 0.0;
        flagged = flagged |
                  ((!unarmed) & ((p.samples.start[i] <= 0.0) | (p.samples.end[i] <= 0.0) |
                                 p.samples.may_dip(i))) |
                  (unarmed & !p.samples.rises(i));
    }
    const auto centre = phase.centre(p.step.last, dynamics.pose(phase.angle(p.step.last)));
    flagged = flagged | !n.workspace.holds(centre);
    flagged = flagged | (magnitude(centre[0] - n.field.centre[0]) > p.half_reach) |
              (magnitude(centre[1] - n.field.centre[1]) > p.half_reach);

    const auto done = !flagged;
    for (Real& unarmed : n.unarmed) unarmed = select(done, Real(0.0), unarmed);
    p.commit(phase, done, to_end);
    return {members(flagged), members(to_end)};
}

template <class Real, bool kEffects>
LaneKernels::Phases<kEffects> kernels_of_phases() {
    return {PackOf<CornerStickPhaseOf, Real, kEffects>::kernel(),
            PackOf<CornerSlipPhaseOf, Real, kEffects>::kernel(),
            PackOf<FlightPhaseOf, Real, kEffects>::kernel()};
}

template <>
LaneKernels lane_kernels_of<STICKSLIP_LANE_WIDTH>() {
    using Real = Pack<STICKSLIP_LANE_WIDTH>;
    return {Real::kSize, kernels_of_phases<Real, false>(), kernels_of_phases<Real, true>()};
}

}  // namespace stickslip
