#include "stickslip/contact/impact.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "stickslip/solver/event_location.hpp"

namespace stickslip {
namespace {

struct ImpactContact {
    double lever = 0.0;                    // m, from the centre of mass along x
    double backward = 0.0, forward = 0.0;  // coefficients of the impulse by the way of the slip
    double restitution = 0.0;
    double approach = 0.0;  // m/s, normal velocity before
    bool arriving = false;  // it meets the surface newly, and approaches it

    double friction(int slip) const { return slip > 0 ? forward : backward; }
    // Coefficient for a slip whose unit vector has the component `along` in the plane of motion; it
    // is linear in that component (`Quantity::directional_friction`).
    double friction_along(double along) const {
        return 0.5 * (forward + backward) + 0.5 * along * (forward - backward);
    }
};

struct Impulse {
    std::array<double, 2> normal = {};
    double tangential = 0.0;
    double across = 0.0;
};

// One or two corners at one height that share their tangential velocity.
class ImpactProblem {
public:
    // x, time: where and when friction is taken, m and s.
    ImpactProblem(const Model& model, double height, double x, double time, const BodyState& before)
        : model_(model), height_(height), before_(before), start_(before) {
        if (model.laws.empty()) return;
        at_.tau = time;
        at_.place = x;
        at_.load = std::numeric_limits<double>::infinity();
        at_.pose.angle = before.theta();
        at_.pose.sine = std::sin(before.theta());
        at_.pose.cosine = std::cos(before.theta());
    }

    // stuck: the corner touched before and did not slip.
    void add(double lever, bool arriving, bool stuck) {
        ImpactContact contact{lever, coefficient(-1.0, stuck),           coefficient(1.0, stuck),
                              0.0,   before_.vz - before_.omega * lever, arriving};
        contact.arriving = arriving && contact.approach < 0.0;
        if (contact.arriving && -contact.approach * model_.restitution > kCaptureSpeed) {
            contact.restitution = model_.restitution;
        }
        contacts_[count_++] = contact;
    }

    // The inner mass strikes the body at the same instant.
    void strike(const Strike& strike) {
        strike_ = strike;
        share_ = model_.inner.share(model_.mass);
        set_part(1.0);
    }
    // Velocity (m/s) at which a corner leaves before any impulse of the surface.
    double leaving(std::size_t i) const { return contacts_[i].approach; }
    double restitution_of_strike() const { return part_ * strike_.restitution; }

    // Newton's restitution, or the largest part of it with which the kinetic energy does not grow:
    // with friction it can grow, without restitution it cannot (docs/theory/contact.md).
    bool solve() {
        if (!solve_newton(1.0)) return false;
        if (!gains_energy()) return true;
        double kept = 0.0, too_much = 1.0;
        for (int bit = 0; bit < std::numeric_limits<double>::digits; ++bit) {
            const double middle = 0.5 * (kept + too_much);
            (solve_newton(middle) && !gains_energy() ? kept : too_much) = middle;
        }
        return solve_newton(kept);
    }

    // Stops the corners of `acting` by whatever impulse that takes, without friction where they
    // slide: a projection, so that the kinetic energy does not grow.
    void hold(const std::array<bool, 2>& acting, bool slides) {
        const bool sticks = !slides && (acting[0] || acting[1]);
        for (ImpactContact& contact : contacts_) contact.backward = contact.forward = 0.0;
        Impulse holding = impulse(acting, sticks ? std::nullopt : std::optional(1.0));
        if (sticks) holding.across = -model_.mass * before_.vy;
        accept(holding, acting, sticks);
    }

    bool closed(std::size_t i) const { return acting_[i] && !(rebound(i) > 0.0); }
    const BodyState& after() const { return after_; }
    double slip_velocity() const { return slip_.along; }
    double slip_across() const { return slip_.across; }

private:
    // Friction coefficient of an impulse at a contact that stuck before it, or did not.
    double coefficient(double slip_sign, bool stuck) {
        const Friction& friction = model_.friction;
        const double alone = stuck ? friction.static_coefficient : friction.kinetic_coefficient;
        if (model_.laws.empty()) return alone;
        at_.slip_sign = slip_sign;
        const Laws<double> laws(model_.laws.table(), model_.laws.numbers(), kFromStart);
        std::array<double, 1> value = {alone};
        laws.apply<Quantity::friction, Quantity::friction_by_load>(at_, value);
        return value[0];
    }

    // Tries the sets of acting corners, all first, then those that arrive; the complementarity
    // problem has one solution but for ties, where the larger set keeps what touches touching.
    bool solve_newton(double part) {
        set_part(part);
        if (count_ == 1) return try_set({true, false});
        if (try_set({true, true})) return true;
        for (const bool arriving : {true, false}) {
            for (std::size_t i = 0; i < 2; ++i) {
                if (contacts_[i].arriving == arriving && try_set({i == 0, i == 1})) return true;
            }
        }
        return false;
    }

    // A strike goes on as if the body had the inner mass along its line too: first of a body that
    // nothing touches, then with that mass against the impulses of the surface.
    void set_part(double part) {
        part_ = part;
        if (share_ == 0.0) return;
        const double gained = share_ * (1.0 + restitution_of_strike()) * strike_.speed;
        before_.vx = start_.vx + gained * strike_.x;
        before_.vz = start_.vz + gained * strike_.z;
        for (std::size_t i = 0; i < count_; ++i) {
            contacts_[i].approach = before_.vz - before_.omega * contacts_[i].lever;
        }
    }
    // Part of the mass's inverse that is left along two of the axes.
    double freedom(double own, double one, double other) const {
        return own - share_ * one * other;
    }

    double rebound(std::size_t i) const { return part_ * contacts_[i].restitution; }

    // inner: velocity of the inner mass in the body along the strike, m/s.
    double kinetic_energy(const BodyState& body, double inner) const {
        const double across = 0.5 * model_.mass * body.vy * body.vy;
        const double own = 0.5 * model_.mass * (body.vx * body.vx + body.vz * body.vz) +
                           0.5 * model_.inertia * body.omega * body.omega + across;
        if (share_ == 0.0) return own;
        const double moves = inner + body.vx * strike_.x + body.vz * strike_.z;
        return own + 0.5 * model_.inner.mass * moves * moves;
    }
    bool gains_energy() const {
        // Rounding of an impulse from a system whose condition number is about 100.
        constexpr double kRounding = 1e-13;
        const double back = -restitution_of_strike() * strike_.speed;
        return kinetic_energy(after_, back) >
               kinetic_energy(start_, strike_.speed) * (1.0 + kRounding);
    }

    // Velocities after `impulse`.
    BodyState apply(const Impulse& impulse) const {
        BodyState body = before_;
        double normal = 0.0, turning = -height_ * impulse.tangential;
        for (std::size_t i = 0; i < count_; ++i) {
            normal += impulse.normal[i];
            turning -= contacts_[i].lever * impulse.normal[i];
        }
        const double shared = share_ * (strike_.x * impulse.tangential + strike_.z * normal);
        body.vx += (impulse.tangential - shared * strike_.x) / model_.mass;
        body.vz += (normal - shared * strike_.z) / model_.mass;
        body.omega += turning / model_.inertia;
        body.vy += impulse.across / model_.mass;
        return body;
    }

    double tangential_velocity(const BodyState& body) const {
        return body.vx - body.omega * height_;
    }

    // Tangential velocity after the impact where friction suffices: none, unless all rebound.
    Slip tangential_target(const std::array<bool, 2>& acting) const {
        if (model_.tangential_restitution == 0.0) return {};
        for (std::size_t i = 0; i < count_; ++i) {
            if (acting[i] && contacts_[i].restitution == 0.0) return {};
        }
        const double part = -part_ * model_.tangential_restitution;
        return {part * tangential_velocity(before_), part * before_.vy};
    }

    // Unknowns: both normal impulses and the tangential one. Without a slip the tangential velocity
    // ends at its target; else friction is at its limit, and `slip` is the part of its way that
    // lies in the plane of motion, +-1 for one that lies there altogether.
    Impulse impulse(const std::array<bool, 2>& acting, std::optional<double> slip) const {
        const double per_mass = 1.0 / model_.mass, per_inertia = 1.0 / model_.inertia;
        const double x = strike_.x, z = strike_.z;
        const double along = per_mass * freedom(1.0, x, x), up = per_mass * freedom(1.0, z, z);
        const double both = per_mass * freedom(0.0, x, z);
        Eigen::Matrix3d a = Eigen::Matrix3d::Identity();
        Eigen::Vector3d b = Eigen::Vector3d::Zero();
        for (int i = 0; i < 2; ++i) {
            const auto u = static_cast<std::size_t>(i);
            if (!acting[u]) continue;
            const double lever = contacts_[u].lever;
            for (int j = 0; j < 2; ++j) {
                const auto v = static_cast<std::size_t>(j);
                a(i, j) = acting[v] ? up + lever * contacts_[v].lever * per_inertia : 0.0;
            }
            a(i, 2) = both + lever * height_ * per_inertia;
            b(i) = -(1.0 + rebound(u)) * contacts_[u].approach;
            if (!slip) {
                a(2, i) = both + lever * height_ * per_inertia;
            } else {
                a(2, i) = *slip * coefficient(contacts_[u], *slip);
            }
        }
        if (!slip) {
            a(2, 2) = along + height_ * height_ * per_inertia;
            // In this order: without a target the bits are those of stopping, signed zeros too.
            b(2) = -(tangential_velocity(before_) - tangential_target(acting).along);
        }
        const Eigen::Vector3d p = a.partialPivLu().solve(b);
        return {{p(0), p(1)}, p(2)};
    }

    static double coefficient(const ImpactContact& contact, double slip) {
        if (slip == 1.0 || slip == -1.0) return contact.friction(slip > 0.0 ? 1 : -1);
        return contact.friction_along(slip);
    }

    // Friction of the limit against a slip that way.
    Impulse sliding_impulse(const std::array<bool, 2>& acting, const Heading& direction) const {
        Impulse result = impulse(acting, direction.cosine);
        for (std::size_t i = 0; i < count_; ++i) {
            const double limit = coefficient(contacts_[i], direction.cosine) * result.normal[i];
            if (acting[i]) result.across -= direction.sine * limit;
        }
        return result;
    }

    // How far the slip that remains after an impulse is from its target, in the slip's frame.
    Slip beyond_target(const std::array<bool, 2>& acting, const Impulse& impulse,
                       const Heading& direction) const {
        const BodyState body = apply(impulse);
        const Slip target = tangential_target(acting);
        return direction.seen(tangential_velocity(body) - target.along, body.vy - target.across);
    }

    bool try_set(const std::array<bool, 2>& acting) {
        Impulse stick = impulse(acting, std::nullopt);
        stick.across = model_.mass * (tangential_target(acting).across - before_.vy);
        const double size = std::hypot(stick.tangential, stick.across);
        const double slip_sign = size > 0.0 ? -stick.tangential / size : 1.0;
        double limit = 0.0;
        for (std::size_t i = 0; i < count_; ++i) {
            if (acting[i]) limit += coefficient(contacts_[i], slip_sign) * stick.normal[i];
        }
        if (admissible(stick, acting) && size <= limit) {
            accept(stick, acting, true);
            return true;
        }
        if (before_.vy == 0.0) return try_sliding(acting, {slip_sign, 0.0});
        // The way in which the slip that remains is that against which friction acted. The body
        // turns more easily than it moves across, so it is not quite that of the sticking impulse.
        const auto turned = [&](double angle) {
            const Heading there = Heading::of_angle(angle);
            return beyond_target(acting, sliding_impulse(acting, there), there).across;
        };
        const double first = std::atan2(-stick.across, -stick.tangential);
        return search_around(first, [&](double low, double high) {
            if (turned(low) * turned(high) > 0.0) return false;
            return try_sliding(acting, Heading::of_angle(find_root(low, high, turned)));
        });
    }
    bool try_sliding(const std::array<bool, 2>& acting, const Heading& direction) {
        const Impulse sliding = sliding_impulse(acting, direction);
        const bool goes_on = beyond_target(acting, sliding, direction).along >= 0.0;
        if (!goes_on || !admissible(sliding, acting)) return false;
        accept(sliding, acting, false);
        return true;
    }

    bool admissible(const Impulse& impulse, const std::array<bool, 2>& acting) const {
        const BodyState body = apply(impulse);
        for (std::size_t i = 0; i < count_; ++i) {
            if (!(impulse.normal[i] >= 0.0)) return false;
            if (acting[i]) continue;
            const double leaving = body.vz - body.omega * contacts_[i].lever;
            if (leaving < -rebound(i) * contacts_[i].approach) return false;
        }
        return true;
    }

    void accept(const Impulse& impulse, const std::array<bool, 2>& acting, bool sticks) {
        after_ = apply(impulse);
        acting_ = acting;
        slip_ = sticks ? tangential_target(acting) : Slip{tangential_velocity(after_), after_.vy};
    }

    const Model& model_;
    double height_;
    // Angle and time are counted from the first quadrant and the start of the run.
    static constexpr LawMoment<double> kFromStart = {};
    LawInput<double> at_;
    BodyState before_, start_;  // the second: before a strike
    Strike strike_;
    double share_ = 0.0;  // of a strike's mass in that of both
    std::array<ImpactContact, 2> contacts_ = {};
    std::size_t count_ = 0;
    double part_ = 1.0;  // of both restitutions
    std::array<bool, 2> acting_ = {};
    BodyState after_;
    Slip slip_;
};

// All velocity of a face but a slip is gone.
ImpactResult laid_down(const BodyState& before, double slip_velocity, double slip_across) {
    ImpactResult result{before, Touch::face, slip_velocity, slip_across};
    result.body.vx = slip_velocity;
    result.body.vy = slip_across;
    result.body.vz = 0.0;
    result.body.omega = 0.0;
    return result;
}

// A face whose ends `ahead` and `behind` touch after the impact, or leave.
ImpactResult touching(const Model& model, const BodyState& after, double slip_velocity,
                      double slip_across, bool ahead, bool behind) {
    if (ahead && behind) return laid_down(after, slip_velocity, slip_across);
    ImpactResult result{after, Touch::none, slip_velocity, slip_across};
    if (!ahead && !behind) return result;
    const Face face = model.face(after.quadrant);
    result.touch = Touch::corner;
    if (behind) {
        result.body.quadrant -= 1;
        result.body.angle = kQuarterTurn;
    }
    const double lever = ahead ? face.half_base : -face.half_base;
    result.body.vz = result.body.omega * (lever + face.shift);
    result.body.vx = result.body.omega * face.height + result.slip_velocity;
    result.body.vy = result.slip_across;
    return result;
}

// Puts a body whose impact is solved on its pivot corner, if that stays closed.
void on_corner(const ImpactProblem& problem, const Pose& pose, ImpactResult& result) {
    result.slip_velocity = problem.slip_velocity();
    result.slip_across = problem.slip_across();
    if (!problem.closed(0)) return;
    result.touch = Touch::corner;
    result.body.vy = result.slip_across;
    result.body.vz = result.body.omega * pose.lever_arm;
    result.body.vx = result.body.omega * pose.height + result.slip_velocity;
}

}  // namespace

ImpactResult corner_impact(const Model& model, const Pose& pose, const BodyState& before,
                           double time, double cosine) {
    ImpactProblem problem(model, pose.height, before.x + pose.lever_arm * cosine, time, before);
    problem.add(pose.lever_arm, true, false);
    ImpactResult result{before, Touch::none};
    if (corner_velocity_z(pose, before.vz, before.omega) > kCaptureSpeed) return result;
    // With one corner that approaches the problem always has a solution; one that does not has
    // arrived by rounding.
    if (!problem.solve()) problem.hold({true, false}, true);
    result.body = problem.after();
    on_corner(problem, pose, result);
    return result;
}

ImpactResult face_impact(const Model& model, const BodyState& before, Arrival arrival,
                         bool old_slips, double time) {
    const Face face = model.face(before.quadrant);
    const double front = face.half_base + face.shift, rear = -face.half_base + face.shift;
    const bool new_ahead = arrival != Arrival::behind, new_behind = arrival != Arrival::ahead;
    const double ahead_leaves = before.vz - before.omega * front;
    const double behind_leaves = before.vz - before.omega * rear;
    const bool slides = old_slips || arrival == Arrival::both;

    ImpactProblem problem(model, face.height, before.x, time, before);
    problem.add(front, new_ahead, !new_ahead && !old_slips);
    problem.add(rear, new_behind, !new_behind && !old_slips);
    if (std::min(ahead_leaves, behind_leaves) >= -kCaptureSpeed) {
        problem.hold({ahead_leaves <= kCaptureSpeed, behind_leaves <= kCaptureSpeed}, slides);
    } else if (!problem.solve()) {
        return laid_down(before, 0.0, 0.0);
    }
    return touching(model, problem.after(), problem.slip_velocity(), problem.slip_across(),
                    problem.closed(0), problem.closed(1));
}

ImpactResult stop_impact(const Model& model, const Pose& pose, const BodyState& before, Touch touch,
                         bool slips, Strike& strike, double time) {
    const Face face = model.face(before.quadrant);
    const bool lies = touch == Touch::face;
    ImpactProblem problem(model, lies ? face.height : pose.height,
                          lies ? before.x : before.x + pose.lever_arm, time, before);
    const std::size_t count = lies ? 2 : touch == Touch::corner ? 1 : 0;
    if (lies) problem.add(face.half_base + face.shift, false, !slips);
    if (lies) problem.add(-face.half_base + face.shift, false, !slips);
    if (touch == Touch::corner) problem.add(pose.lever_arm, false, !slips);
    problem.strike(strike);
    std::array<bool, 2> stays = {};
    bool presses = false;  // by more than rounding
    const double least = 1e-12 * (strike.speed + std::hypot(before.vx, before.vz));
    for (std::size_t i = 0; i < count; ++i) {
        stays[i] = problem.leaving(i) <= kCaptureSpeed;
        presses = presses || problem.leaving(i) < -least;
    }
    // The surface answers a blow along it by no impulse, so that friction gives none either.
    if (!presses || !problem.solve()) problem.hold(stays, true);
    strike.restitution = problem.restitution_of_strike();
    if (lies) {
        return touching(model, problem.after(), problem.slip_velocity(), problem.slip_across(),
                        problem.closed(0), problem.closed(1));
    }
    ImpactResult result{problem.after(), Touch::none};
    on_corner(problem, pose, result);
    return result;
}

}  // namespace stickslip
