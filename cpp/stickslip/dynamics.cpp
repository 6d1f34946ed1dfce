#include "stickslip/dynamics.hpp"

namespace stickslip {

void Dynamics::extend(const Expansion& expansion, const PlanarField& field, double mx, double mz,
                      const Pose& pose, double vx, double vz, Load& load) const {
    const Model& m = *model_;
    const double cosine = turn_.cosine * pose.cosine - turn_.sine * pose.sine;
    const double sine = turn_.sine * pose.cosine + turn_.cosine * pose.sine;
    const double drag = m.linear_drag * m.angle_drag * cosine * cosine +
                        m.quadratic_linear_drag * std::hypot(vx, vz);
    load.fx += m.gradient_excess * (mx * field.dbx_dx + mz * field.dbx_dz) - drag * vx;
    load.fz += m.gradient_excess * (mx * field.dbx_dz + mz * field.dbz_dz) - drag * vz;
    load.contact_adhesion = m.adhesion.of_contact(sine, age_ + expansion.tau);
}

void Dynamics::add_ranged_adhesion(const Pose& pose, double gap, Load& load) const {
    const Adhesion& adhesion = model_->adhesion;
    const double base = model_->shape.half_base(quadrant_);
    const double rise = model_->shape.half_rise(quadrant_);
    // The two corners that share a side with the pivot; the fourth is never near.
    const double gap_behind = gap + 2.0 * base * pose.sine;
    const double gap_ahead = gap + 2.0 * rise * pose.cosine;
    const double pivot = adhesion.weight(gap);
    const double behind = adhesion.weight(gap_behind);
    const double ahead = adhesion.weight(gap_ahead);
    const double total = pivot + behind + ahead;
    const double pull_behind = load.contact_adhesion * Adhesion::share(behind, total);
    const double pull_ahead = load.contact_adhesion * Adhesion::share(ahead, total);
    load.contact_adhesion *= Adhesion::share(pivot, total);
    load.fz -= pull_behind + pull_ahead;
    load.torque += (pose.lever - 2.0 * base * pose.cosine) * pull_behind +
                   (pose.lever + 2.0 * rise * pose.sine) * pull_ahead;
    if (gap > 0.0) {
        load.fz -= load.contact_adhesion;
        load.torque += pose.lever * load.contact_adhesion;
        load.contact_adhesion = 0.0;
    }
}

}  // namespace stickslip
