#include "stickslip/contact/plane_contact.hpp"

#include <cmath>

#include "stickslip/contact/plane_phase.hpp"
#include "stickslip/solver/event_location.hpp"

namespace stickslip {
namespace {

// Slip that has only begun, the way `angle` rad to the left of the heading.
Slip least_slip(double angle) {
    return {kLeastSlip * std::cos(angle), kLeastSlip * std::sin(angle)};
}

class Resolver {
public:
    Resolver(PlaneDynamics& plane, double tau, const BodyState& body)
        : plane_(plane), upright_(plane.upright()), tau_(tau), body_(body) {}

    PlaneResolution corner(int quadrant, double angle, const Slip& slip, bool is_loose) {
        pose_at(quadrant, angle);
        const PlaneLoad load =
            plane_.load(field_, tau_, pose_, {body_.vx, body_.vy}, body_.vz, body_.omega);
        if (!is_slow(slip)) return sliding(quadrant, load, slip);
        const CornerStick stick = corner_stick(upright_.robot(), pose_, body_.omega, load.along);
        // Friction that would hold it; it would slip the other way.
        const Slip friction = {stick.reaction.friction, -load.across};
        const double normal = stick.reaction.normal, size = friction.size();
        if (!is_loose && normal >= 0.0) {
            const double way = size > 0.0 ? -friction.along / size : 1.0;
            const double limit =
                upright_.static_limit(way, contact_x(), pose_, normal, tau_) * normal;
            if (size <= limit) return {{{Touch::corner, 0}, quadrant}, {}};
        }
        if (slip.size() > kLeastSlip) return sliding(quadrant, load, slip);
        return breaking_loose(quadrant, load, std::atan2(-friction.across, -friction.along));
    }

    PlaneResolution face(int quadrant, Slip slip, bool is_loose) {
        pose_at(quadrant, 0.0);
        const PlaneLoad load = plane_.load_of_face(field_, tau_, pose_, {body_.vx, body_.vy});
        bool slips = !is_slow(slip);
        FaceReaction reaction = face_reaction(model(), quadrant, load.along, true, 0.0);
        const double normal = reaction.normal();
        if (!slips) {
            // A face is accelerated the way of the force, against its friction.
            const Slip force = {load.along.fx, load.across};
            const double size = force.size(), way = size > 0.0 ? force.along / size : 1.0;
            const double limit = upright_.static_limit(way, body_.x, pose_, normal, tau_) * normal;
            slips = is_loose || size > limit;
            if (!slips) {
                slip = {};
            } else if (slip.size() <= kLeastSlip) {
                slip = least_slip(std::atan2(force.across, force.along));
            }
        }
        if (slips) {
            const double speed = slip.size(), way = slip.along / speed;
            const double coefficient = upright_.kinetic(way, speed, body_.x, pose_, normal, tau_);
            reaction = face_reaction(model(), quadrant, load.along, false, way * coefficient);
        }
        if (reaction.ahead >= 0.0 && reaction.behind >= 0.0) {
            return {{{Touch::face, slips ? 1 : 0}, quadrant}, slip};
        }
        const bool on_front = reaction.behind < reaction.ahead;
        return corner(on_front ? quadrant : quadrant - 1, on_front ? 0.0 : kQuarterTurn, slip,
                      is_loose);
    }

private:
    const Model& model() const { return upright_.model(); }
    double contact_x() const { return body_.x + pose_.lever * field_.heading.cosine; }

    void pose_at(int quadrant, double angle) {
        upright_.set_quadrant(quadrant);
        plane_.field().rebase({body_.x, body_.y, body_.z});
        pose_ = upright_.pose(angle);
        field_ = plane_.headed(plane_.field().at(tau_), body_.x, body_.y, body_.z);
    }

    CornerSlip slipping(const PlaneLoad& load, double along, double speed) const {
        const double coefficient = upright_.corner_kinetic(along, speed, contact_x(), pose_,
                                                           body_.omega, load.along, tau_);
        return corner_slip(upright_.robot(), pose_, body_.omega, load.along, along * coefficient);
    }

    PlaneResolution sliding(int quadrant, const PlaneLoad& load, const Slip& slip) {
        const double speed = slip.size();
        const CornerSlip motion = slipping(load, slip.along / speed, speed);
        if (motion.effective_inertia <= 0.0) {
            // As in one plane: the free corner rises, or the slip jams.
            const bool rises = motion.normal > 0.0;
            return {{{rises ? Touch::none : Touch::corner, 0}, quadrant, !rises}, slip};
        }
        if (motion.normal < 0.0) return {{{Touch::none, 0}, quadrant}, slip};
        return {{{Touch::corner, 1}, quadrant}, slip};
    }

    // The way of the slip is that of the acceleration that it gets under friction against it. The
    // rod's turning makes the contact lighter along than across, so that the way is not quite that
    // of the force: it is looked for, from the force's on.
    PlaneResolution breaking_loose(int quadrant, const PlaneLoad& load, double force) {
        const auto turning = [&](double angle) { return acceleration(load, angle).across; };
        double way = force;
        // Slip goes to a way in which the acceleration does not turn it and to which others turn.
        search_around(force, [&](double low, double high) {
            if (!(turning(low) >= 0.0 && turning(high) <= 0.0)) return false;
            way = find_root(low, high, turning);
            return acceleration(load, way).along >= 0.0;
        });
        const CornerSlip motion = slipping(load, std::cos(way), 0.0);
        if (motion.effective_inertia <= 0.0 || motion.normal < 0.0) {
            return {{{Touch::none, 0}, quadrant}, {}};
        }
        return {{{Touch::corner, 1}, quadrant}, least_slip(way)};
    }

    // Of a contact that begins to slip at `angle` to the heading: along that way and across it.
    Slip acceleration(const PlaneLoad& load, double angle) const {
        const double cosine = std::cos(angle), sine = std::sin(angle);
        const double coefficient =
            upright_.corner_kinetic(cosine, 0.0, contact_x(), pose_, body_.omega, load.along, tau_);
        const CornerSlip motion =
            corner_slip(upright_.robot(), pose_, body_.omega, load.along, cosine * coefficient);
        const double along = motion.slip_acceleration;
        const double across =
            (load.across - sine * coefficient * motion.normal) * upright_.robot().per_mass;
        return {cosine * along + sine * across, cosine * across - sine * along};
    }

    PlaneDynamics& plane_;
    Dynamics& upright_;
    double tau_;
    const BodyState& body_;
    Pose pose_;
    HeadedField field_;
};

}  // namespace

PlaneResolution resolve_plane_contact(PlaneDynamics& plane, double tau, const BodyState& body,
                                      Touch touch, const Slip& slip, bool is_loose) {
    Resolver resolver(plane, tau, body);
    switch (touch) {
        case Touch::corner:
            return resolver.corner(body.quadrant, body.angle, slip, is_loose);
        case Touch::face:
            return resolver.face(body.quadrant, slip, is_loose);
        case Touch::none:
            break;
    }
    return {{{Touch::none, 0}, body.quadrant}, slip};
}

}  // namespace stickslip
