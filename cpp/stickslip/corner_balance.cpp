#include "stickslip/corner_balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "stickslip/assembly.hpp"
#include "stickslip/contact.hpp"
#include "stickslip/own_coils.hpp"

namespace stickslip {
namespace {

// Of the weight: a corner that presses less has no ratio of friction to normal force to speak of.
constexpr double kLeastNormal = 1e-3;

/// The model of a scenario with the field of its drive, at one time after another.
class Driven {
public:
    explicit Driven(const Scenario& scenario)
        : model_(make_model(scenario)),
          program_(make_program(scenario)),
          coils_(robot_coil_set(scenario)),
          circuit_(make_circuit(scenario, program_)),
          dynamics_(model_, make_local_field(scenario, program_, coils_)),
          stretches_(program_, scenario.effects.sample_hold_period, {}) {}
    Driven(const Driven&) = delete;
    Driven& operator=(const Driven&) = delete;

    /// The field about a place (m, the robot's own frame) at a time, s; times may not fall.
    Expansion field_at(double time, double x, double z, double contact_age) {
        VoltageSegment voltages;
        while (time >= stretch_.start + stretch_.duration && stretches_.next(voltages)) {
            stretch_ = circuit_.advance(voltages);
            dynamics_.set_start(stretch_.start);
            dynamics_.field().set_segment(stretch_);
        }
        const double tau = std::clamp(time - stretch_.start, 0.0, stretch_.duration);
        dynamics_.set_contact_age(contact_age - tau);
        dynamics_.rebase_field(x, z);
        return dynamics_.field_at(tau);
    }

    const Model& model() const { return model_; }
    Dynamics& dynamics() { return dynamics_; }

private:
    const Model model_;
    const VoltageProgram program_;
    const CoilSet coils_;
    Circuit circuit_;
    Dynamics dynamics_;
    SegmentStream stretches_;
    CurrentSegment stretch_;
};

/// Of one motion at a place whose quadrant is set.
CornerBalance balance(Dynamics& dynamics, const Expansion& field, double x, double z, int slip,
                      double weight, const CornerMotion& motion) {
    const Model& model = dynamics.model();
    const double angle = motion.theta - dynamics.quadrant() * kQuarterTurn;
    const Pose pose = dynamics.rebase_angle(angle);
    const double omega = motion.omega, alpha = motion.alpha;
    const auto load_at = [&](double vx) {
        return dynamics.load_near_surface(field, x, z, pose, vx, omega * pose.lever, omega, 0.0);
    };
    CornerBalance result;
    const Load pinned = load_at(omega * pose.height);
    const Reaction held = pivot_reaction(dynamics.robot(), pose, omega, alpha, pinned);
    // What the motion asks for beyond that of a contact that does not slip.
    const double inertia = model.place.absent() ? model.corner_inertia()
                                                : pivot_inertia(model.inertia, model.mass, pose);
    const double turning = model.mass * pose.lever * pose.bend * omega * omega;
    result.torque = inertia * alpha + turning - moment_about_corner(pose, pinned);
    result.friction_ratio = std::abs(held.friction) / std::max(held.normal, kLeastNormal * weight);

    const Load sliding = load_at(motion.vx);
    const double normal = pivot_reaction(dynamics.robot(), pose, omega, alpha, sliding).normal;
    const double speed = corner_velocity_x(pose, motion.vx, omega);
    result.contact_velocity = speed;
    const double friction =
        -slip * dynamics.kinetic(slip, speed, x + pose.lever, pose, normal, field.tau) * normal;
    result.force = model.mass * motion.ax - (sliding.fx + friction);
    return result;
}

}  // namespace

CornerBalances corner_balances(const Scenario& scenario, const std::vector<BalancePoint>& points,
                               const std::vector<CornerMotion>& motions) {
    if (points.empty() || motions.size() % points.size() != 0) {
        throw std::invalid_argument("each row needs a motion for each point");
    }
    const MeasurementChain chain = make_measurement_chain(scenario);
    const double length = chain.length_factor(), time = chain.time_factor();
    const double sign = frame_sign(scenario);
    Driven driven(scenario);
    Dynamics& dynamics = driven.dynamics();
    CornerBalances result;
    result.rows.resize(motions.size());
    result.weight = scenario.gravity * driven.model().mass + driven.model().adhesion.strength;

    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return points[a].t < points[b].t; });
    for (const std::size_t at : order) {
        const BalancePoint& point = points[at];
        const double x = sign * point.x / length, z = point.z / length;
        const double theta = point.theta - chain.angle_offset;
        const Expansion field = driven.field_at(point.t / time, x, z, point.contact_age / time);
        dynamics.set_quadrant(static_cast<int>(std::floor(theta / kQuarterTurn)));
        const Pose rest = dynamics.rebase_angle(theta - dynamics.quadrant() * kQuarterTurn);
        const Load still = dynamics.load(field, x, z, rest, 0.0, 0.0, 0.0);
        result.torque_scale = std::max(result.torque_scale, std::abs(still.torque));
        for (std::size_t i = at; i < motions.size(); i += points.size()) {
            const CornerMotion& read = motions[i];
            const CornerMotion motion = {read.theta - chain.angle_offset, read.omega * time,
                                         read.alpha * time * time, read.vx * time / length,
                                         read.ax * time * time / length};
            result.rows[i] = balance(dynamics, field, x, z, point.slip, result.weight, motion);
        }
    }
    return result;
}

}  // namespace stickslip
