#pragma once

#include "stickslip/lane_numbers.hpp"

/// One step of a pack of runs. Compiled once for each width of the processor's registers
/// (lane_kernel_*.cpp), so nothing here may be shared with other translation units: all is
/// templates over a pack of that width.
namespace stickslip {

/// The dynamics of a pack of robots without named effects; see Dynamics for the meaning.
template <class R>
class PackDynamics {
public:
    using Real = R;

    PackDynamics(const PlainDynamics<Real>& robot, const FieldStretch<Real>& field)
        : robot_(&robot), field_(&field), far_(Real(1.0) < Real(0.0)) {}

    const PlainDynamics<Real>& robot() const { return *robot_; }
    [[gnu::always_inline]] ExpansionOf<Real> field_at(Real tau) const { return field_->at(tau); }
    [[gnu::always_inline]] PoseOf<Real> pose(Real angle) const {
        const Real d = angle - robot_->base.angle;
        const Real dd = d * d;
        far_ = far_ | !(dd < PlainDynamics<Real>::kNearSquared);
        return robot_->turned(d, dd);
    }
    Real static_limit(double, Real, const PoseOf<Real>&, Real, Real) const {
        return robot_->static_friction;
    }
    Real corner_kinetic(Real, Real, Real, const PoseOf<Real>&, Real, const LoadOf<Real>&,
                        Real) const {
        return robot_->kinetic_friction;
    }
    [[gnu::always_inline]] LoadOf<Real> load_near_surface(const ExpansionOf<Real>& expansion,
                                                          Real x, Real z, const PoseOf<Real>& pose,
                                                          Real vx, Real vz, Real omega,
                                                          Real) const {
        return robot_->load(expansion(x, z), robot_->moment_x(pose), robot_->moment_z(pose), vx, vz,
                            omega);
    }
    /// Where an angle was too far from the base for the series.
    MaskOf<Real> far() const { return far_; }

private:
    const PlainDynamics<Real>* robot_;
    const FieldStretch<Real>* field_;
    mutable MaskOf<Real> far_;
};

template <template <class> class PhaseOf, class Real>
LaneRound lane_step(double* memory) {
    using Numbers = LaneNumbers<PhaseOf, PackDynamics<Real>>;
    Numbers& n = *reinterpret_cast<Numbers*>(memory);
    auto& p = n.progress;
    PackDynamics<Real> dynamics(n.robot, n.field);
    const auto phase = make_phase(n, dynamics);

    const auto to_end = p.begin_step(phase);
    p.attempt(phase);
    const Real angle = phase.angle(p.step.last);
    const PoseOf<Real> pose = dynamics.pose(angle);
    const auto far = dynamics.far();

    // What the caller has to see: a step that is not accepted, ends the stretch or may hold an
    // event; a base that has to be computed anew.
    auto flagged = (!(p.error <= 1.0)) | to_end | far | (p.accepted + 1.0 >= p.most_steps) |
                   (!(p.tau + p.step.width > p.tau)) | (n.stalled > 0.0);
    for (std::size_t i = 0; i < p.samples.end.size(); ++i) {
        const auto unarmed = n.unarmed[i] > 0.0;
        flagged = flagged |
                  ((!unarmed) & ((p.samples.start[i] <= 0.0) | (p.samples.end[i] <= 0.0) |
                                 p.samples.may_dip(i))) |
                  (unarmed & !p.samples.rises(i));
    }
    flagged = flagged | (n.robot.base.turns + 1.0 >= double{PlainDynamics<Real>::kMostTurns});
    const Point<Real> centre = phase.centre(p.step.last, pose);
    flagged =
        flagged | !((magnitude(centre.x) < n.workspace) & (magnitude(centre.z) < n.workspace));
    flagged = flagged | (magnitude(centre.x - n.field.centre_x) > p.half_reach) |
              (magnitude(centre.z - n.field.centre_z) > p.half_reach);

    const auto done = !flagged;
    const BasePose<Real> base = {angle, n.robot.base.turns + 1.0, pose};
    blend<Real>(done, n.robot.base, base);
    for (Real& unarmed : n.unarmed) unarmed = select(done, Real(0.0), unarmed);
    p.commit(phase, done, to_end);
    return {members(flagged), members(far), members(to_end)};
}

template <int N>
LaneKernels kernels_of() {
    static_assert(sizeof(LaneNumbers<CornerStickPhaseOf, PackDynamics<Pack<N>>>) ==
                  N * sizeof(LaneNumbers<CornerStickPhaseOf, Dynamics>));
    static_assert(sizeof(LaneNumbers<FlightPhaseOf, PackDynamics<Pack<N>>>) ==
                  N * sizeof(LaneNumbers<FlightPhaseOf, Dynamics>));
    static_assert(sizeof(LaneNumbers<CornerSlipPhaseOf, PackDynamics<Pack<N>>>) ==
                  N * sizeof(LaneNumbers<CornerSlipPhaseOf, Dynamics>));
    return {N, &lane_step<CornerStickPhaseOf, Pack<N>>, &lane_step<CornerSlipPhaseOf, Pack<N>>,
            &lane_step<FlightPhaseOf, Pack<N>>};
}

}  // namespace stickslip
