#include "stickslip/contact/contact.hpp"

#include "stickslip/contact/turning_frame.hpp"

namespace stickslip {
namespace {

template <class Frame>
class Resolver {
    using Vector = typename Frame::Vector;
    using Load = typename Frame::Load;

public:
    Resolver(const Frame& frame, double tau, const BodyState& body)
        : frame_(frame), dynamics_(frame.dynamics()), tau_(tau), body_(body) {}

    // onset: see resolve_contact.
    Resolution corner(int quadrant, double angle, const Vector& slip, int onset) {
        look_at(quadrant, angle);
        if (!frame_.is_slow(slip)) return sliding(slip);
        CornerStick stick;
        Vector friction;  // that would hold it; it would slip the other way
        move_corner([&](const Load& load) {
            stick = corner_stick(dynamics_.robot(), pose_, body_.omega, load);
            friction = frame_.vector(stick.reaction.friction, -frame_.across(load));
            return MovingCorner{0.0, stick.angular_acceleration};
        });
        const double normal = stick.reaction.normal;
        if (onset == 0 && normal >= 0.0) {
            const double limit = normal * dynamics_.static_limit(frame_.against(friction).along,
                                                                 contact_x(), pose_, normal, tau_);
            if (friction.size() <= limit) return {{Touch::corner, 0}, quadrant};
        }
        if (frame_.has_begun(slip)) return sliding(slip);
        return breaking_loose(friction, onset);
    }
    Resolution face(int quadrant, Vector slip, int onset) {
        look_at(quadrant, 0.0);
        const Model& model = dynamics_.model();
        FaceReaction reaction;
        Vector friction;
        dynamics_.move_with(tau_, pose_, [&] {
            const Load load = this->load(0.0, 0.0);
            reaction = face_reaction(model, quadrant, load, true, 0.0);
            friction = frame_.vector(reaction.friction, -frame_.across(load));
            return std::array{0.0, 0.0};
        });
        const double normal = reaction.normal();
        bool slips = !frame_.is_slow(slip) || onset != 0;
        if (!slips) {
            const double limit = normal * dynamics_.static_limit(frame_.against(friction).along,
                                                                 body_.x, pose_, normal, tau_);
            slips = friction.size() > limit;
        }
        int mark = 0;
        if (slips) {
            slip = frame_.begun(slip, frame_.against(friction));
            const Vector direction = frame_.direction_of(slip, friction, onset);
            dynamics_.move_with(tau_, pose_, [&] {
                const Load load = this->load(0.0, 0.0);
                const double pressing = load.contact_adhesion - load.fz;
                const double coefficient =
                    dynamics_.kinetic(direction.along, slip.size(), body_.x, pose_, pressing, tau_);
                const double along = direction.along * coefficient;
                reaction = face_reaction(model, quadrant, load, false, along);
                return std::array{(load.fx + reaction.friction) * dynamics_.robot().per_mass, 0.0};
            });
            mark = frame_.mark(direction);
        } else {
            slip = {};
        }
        if (reaction.ahead >= 0.0 && reaction.behind >= 0.0) {
            return {{Touch::face, mark}, quadrant, false, frame_.slip(slip)};
        }
        // The end that pulls more leaves, and the other takes its adhesion; it may turn out to hold
        // even where both pulled.
        if (reaction.behind < reaction.ahead) return corner(quadrant, 0.0, slip, onset);
        return corner(quadrant - 1, kQuarterTurn, slip, onset);
    }

private:
    Vector velocity() const { return frame_.vector({body_.vx, body_.vy}); }
    typename Frame::Place place() const { return frame_.place(body_.x, body_.y); }
    double contact_x() const { return frame_.moved(place(), seen_.heading, pose_.lever_arm)[0]; }

    void look_at(int quadrant, double angle) {
        dynamics_.set_quadrant(quadrant);
        frame_.field().rebase(frame_.in_ground(tau_, frame_.centre(place(), body_.z)));
        pose_ = dynamics_.pose(angle);
        seen_ = frame_.seen_at(frame_.field_at(tau_), place(), body_.z);
    }

    Load load(double vz, double omega) const {
        return frame_.load(seen_, tau_, pose_, velocity(), vz, omega);
    }

    // Accelerations of a corner along the surface and of the body about it, m/s^2 and rad/s^2.
    struct MovingCorner {
        double slip, angular;
    };
    // `motion`: what a load makes of it.
    void move_corner(auto&& motion) {
        dynamics_.move_with(tau_, pose_, [&] {
            const MovingCorner a = motion(load(body_.vz, body_.omega));
            return centre_acceleration(pose_, a.slip, body_.omega, a.angular);
        });
    }

    // At `speed` (m/s) along `direction`.
    struct Slipping {
        CornerSlip motion;
        double across;  // m/s^2
    };
    Slipping slipping(const Vector& direction, double speed) {
        Slipping result;
        move_corner([&](const Load& load) {
            const double coefficient = dynamics_.corner_kinetic(direction.along, speed, contact_x(),
                                                                pose_, body_.omega, load, tau_);
            const CornerSlip motion = corner_slip(dynamics_.robot(), pose_, body_.omega, load,
                                                  direction.along * coefficient);
            const double friction = direction.across * coefficient * motion.normal;
            result = {motion, (frame_.across(load) - friction) * dynamics_.robot().per_mass};
            return MovingCorner{motion.slip_acceleration, motion.angular_acceleration};
        });
        return result;
    }

    Resolution sliding(const Vector& slip) {
        const int quadrant = dynamics_.quadrant();
        const Vector direction = frame_.direction_of(slip, {}, 0);
        const CornerSlip motion = slipping(direction, slip.size()).motion;
        if (motion.effective_inertia <= 0.0) {
            // A reaction that lifts presses here: the formula's N is positive where the free corner
            // rises (flight is consistent) and negative where nothing is, and the slip jams.
            const bool rises = motion.normal > 0.0;
            const Touch touch = rises ? Touch::none : Touch::corner;
            return {{touch, 0}, quadrant, !rises, frame_.slip(slip)};
        }
        if (motion.normal < 0.0) return {{Touch::none, 0}, quadrant, false, frame_.slip(slip)};
        return {{Touch::corner, frame_.mark(direction)}, quadrant, false, frame_.slip(slip)};
    }

    // At rest but not able to stick. Without a sliding solution that has a positive effective
    // inertia the corner is free to rise: at slip velocity zero an inconsistent slip cannot occur,
    // so what is left is the indeterminate case, and of its answers flight is the one that is
    // stable.
    Resolution breaking_loose(const Vector& friction, int onset) {
        const int quadrant = dynamics_.quadrant();
        const auto acceleration = [&](const Vector& direction) {
            const auto [motion, across] = slipping(direction, 0.0);
            return frame_.vector(motion.slip_acceleration, across);
        };
        const Vector direction = frame_.direction_to_slip(friction, onset, acceleration);
        const CornerSlip motion = slipping(direction, 0.0).motion;
        if (motion.effective_inertia <= 0.0 || motion.normal < 0.0) {
            return {{Touch::none, 0}, quadrant};
        }
        const Vector slip = frame_.begun({}, direction);
        return {{Touch::corner, frame_.mark(direction)}, quadrant, false, frame_.slip(slip)};
    }

    const Frame& frame_;
    Dynamics& dynamics_;
    double tau_;
    const BodyState& body_;
    Pose pose_;
    typename Frame::Seen seen_;
};

}  // namespace

template <class Frame>
Resolution resolve_contact(const Frame& frame, double tau, const BodyState& body, Touch touch,
                           const Slip& slip, int onset) {
    Resolver<Frame> resolver(frame, tau, body);
    switch (touch) {
        case Touch::corner:
            return resolver.corner(body.quadrant, body.angle, frame.vector(slip), onset);
        case Touch::face:
            return resolver.face(body.quadrant, frame.vector(slip), onset);
        case Touch::none:
            break;
    }
    return {{Touch::none, 0}, body.quadrant, false, slip};
}
template Resolution resolve_contact(const FixedFrame<Dynamics>&, double, const BodyState&, Touch,
                                    const Slip&, int);
template Resolution resolve_contact(const TurningFrame&, double, const BodyState&, Touch,
                                    const Slip&, int);

void stop_slip_by_impulse(const Model& model, const Pose& pose, double slip_velocity,
                          BodyState& body) {
    // The impulse passes through the corner, so the angular momentum about it is kept.
    const double inertia = model.place.absent() ? model.corner_inertia()
                                                : pivot_inertia(model.inertia, model.mass, pose);
    body.omega += model.mass * pose.height * slip_velocity / inertia;
    body.vx = body.omega * pose.height;
    body.vy = 0.0;
    body.vz = body.omega * pose.lever_arm;
}

}  // namespace stickslip
