#include "stickslip/contact/contact.hpp"

#include <cmath>

namespace stickslip {
namespace {

int opposite_sign(double value) {
    return value > 0.0 ? -1 : 1;
}

class Resolver {
public:
    Resolver(Dynamics& dynamics, double tau, const BodyState& body)
        : dynamics_(dynamics), model_(dynamics.model()), tau_(tau), body_(body) {}

    Resolution corner(int quadrant, double angle, double slip_velocity, int onset) {
        const Pose pose = pose_at(quadrant, angle);
        const Load load = dynamics_.load(dynamics_.field_at(tau_), body_.x, body_.z, pose, body_.vx,
                                         body_.vz, body_.omega);
        if (slip_velocity != 0.0) return sliding(quadrant, pose, load, slip_velocity);
        if (onset != 0) return breaking_loose(quadrant, pose, load, onset);

        const CornerStick stick = corner_stick(dynamics_.robot(), pose, body_.omega, load);
        const int slip = opposite_sign(stick.reaction.friction);
        const double normal = stick.reaction.normal;
        const double limit =
            dynamics_.static_limit(slip, contact_x(pose), pose, normal, tau_) * normal;
        if (normal >= 0.0 && std::abs(stick.reaction.friction) <= limit) {
            return {{Touch::corner, 0}, quadrant};
        }
        return breaking_loose(quadrant, pose, load, slip);
    }

    Resolution face(int quadrant, double slip_velocity, int onset) {
        const Pose pose = pose_at(quadrant, 0.0);
        const Load load = dynamics_.load(dynamics_.field_at(tau_), body_.x, body_.z, pose, body_.vx,
                                         body_.vz, body_.omega);
        int slip = slip_velocity > 0.0 ? 1 : slip_velocity < 0.0 ? -1 : onset;
        FaceReaction reaction = face_reaction(model_, quadrant, load, true, 0.0);
        if (slip == 0) {
            const int way = opposite_sign(reaction.friction);
            const double normal = reaction.normal();
            const double limit = dynamics_.static_limit(way, body_.x, pose, normal, tau_) * normal;
            if (std::abs(reaction.friction) > limit) slip = way;
        }
        if (slip != 0) {
            const double coefficient =
                dynamics_.kinetic(slip, slip_velocity, body_.x, pose, reaction.normal(), tau_);
            reaction = face_reaction(model_, quadrant, load, false, slip * coefficient);
        }
        if (reaction.ahead >= 0.0 && reaction.behind >= 0.0) {
            return {{Touch::face, slip}, quadrant};
        }
        // The end that pulls more leaves, and the other takes its adhesion; it may turn out to hold
        // even where both pulled.
        if (reaction.behind < reaction.ahead) return corner(quadrant, 0.0, slip_velocity, onset);
        return corner(quadrant - 1, kQuarterTurn, slip_velocity, onset);
    }

private:
    double contact_x(const Pose& pose) const { return body_.x + pose.lever; }
    double coefficient(int slip, double slip_velocity, const Pose& pose, const Load& load) const {
        return dynamics_.corner_kinetic(slip, slip_velocity, contact_x(pose), pose, body_.omega,
                                        load, tau_);
    }

    Pose pose_at(int quadrant, double angle) {
        dynamics_.set_quadrant(quadrant);
        dynamics_.rebase_field(body_.x, body_.z);
        return dynamics_.pose(angle);
    }

    Resolution sliding(int quadrant, const Pose& pose, const Load& load, double slip_velocity) {
        const int slip = slip_velocity > 0.0 ? 1 : -1;
        const CornerSlip motion = corner_slip(dynamics_.robot(), pose, body_.omega, load,
                                              slip * coefficient(slip, slip_velocity, pose, load));
        if (motion.effective_inertia <= 0.0) {
            // A reaction that lifts presses here: the formula's N is positive where the free corner
            // rises (flight is consistent) and negative where nothing is, and the slip jams.
            const bool rises = motion.normal > 0.0;
            return {{rises ? Touch::none : Touch::corner, 0}, quadrant, !rises};
        }
        if (motion.normal < 0.0) return {{Touch::none, 0}, quadrant};
        return {{Touch::corner, slip}, quadrant};
    }

    // At rest but not able to stick. Without a sliding solution that has a positive effective
    // inertia the corner is free to rise: at slip velocity zero an inconsistent slip cannot occur,
    // so what is left is the indeterminate case, and of its answers flight is the one that is
    // stable.
    Resolution breaking_loose(int quadrant, const Pose& pose, const Load& load, int slip) {
        const CornerSlip motion = corner_slip(dynamics_.robot(), pose, body_.omega, load,
                                              slip * coefficient(slip, 0.0, pose, load));
        if (motion.effective_inertia <= 0.0 || motion.normal < 0.0) {
            return {{Touch::none, 0}, quadrant};
        }
        return {{Touch::corner, slip}, quadrant};
    }

    Dynamics& dynamics_;
    const Model& model_;
    double tau_;
    const BodyState& body_;
};

}  // namespace

Resolution resolve_contact(Dynamics& dynamics, double tau, const BodyState& body, Touch touch,
                           double slip_velocity, int onset) {
    Resolver resolver(dynamics, tau, body);
    switch (touch) {
        case Touch::corner:
            return resolver.corner(body.quadrant, body.angle, slip_velocity, onset);
        case Touch::face:
            return resolver.face(body.quadrant, slip_velocity, onset);
        case Touch::none:
            break;
    }
    return {{Touch::none, 0}, body.quadrant};
}

void stop_slip_by_impulse(const Model& model, const Pose& pose, double slip_velocity,
                          BodyState& body) {
    // The impulse passes through the corner, so the angular momentum about it is kept.
    const double inertia = model.place.absent() ? model.corner_inertia()
                                                : pivot_inertia(model.inertia, model.mass, pose);
    body.omega += model.mass * pose.height * slip_velocity / inertia;
    body.vx = body.omega * pose.height;
    body.vy = 0.0;
    body.vz = body.omega * pose.lever;
}

}  // namespace stickslip
