#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/dynamics.hpp"
#include "stickslip/contact/frame.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

struct Corner {
    double lever, normal, friction;  // m, N (compressive, before adhesion), N
};

struct Acceleration {
    double x = 0.0, z = 0.0, angular = 0.0;
};

// Newton and Euler, Eqs. (10)-(12), for forces at corners that lie `height` below the centre.
Acceleration accelerations(const Model& model, const Load& load, double height, double adhesion,
                           const std::array<Corner, 2>& corners) {
    double fx = load.fx, fz = load.fz - adhesion, torque = load.torque;
    for (const Corner& corner : corners) {
        fx += corner.friction;
        fz += corner.normal;
        torque -= height * corner.friction + corner.lever * corner.normal;
    }
    return {fx / model.mass, fz / model.mass, torque / model.inertia};
}

// Acceleration along z of the corner at (lever, -height). Its centripetal part points up.
double gap_acceleration(const Acceleration& a, double omega, double lever, double height) {
    return a.z - a.angular * lever + omega * omega * height;
}

// One random robot on the surface: parameters, field, weight and tilt are drawn widely.
struct Draw {
    Model model = paper_model();
    BodyState body;
    double slip_velocity = 0.0;
    PerCoil currents = {};

    Draw(Random& random, Touch touch, double most_friction) {
        const double mu = random.between(0.0, most_friction);
        model.friction = {mu, mu * (random.coin() ? 1.0 : random.between(0.0, 1.0))};
        model.adhesion = random.coin() ? 0.0 : random.between(0.0, 0.5e-6);
        model.gravity_x = random.between(-10.0, 10.0);
        model.gravity_z = random.between(-10.0, 8.0);
        // Torques from far below to far above those of the weight.
        const double largest = std::pow(10.0, random.between(-4.0, 0.5));  // A
        for (double& current : currents) current = random.between(-largest, largest);
        slip_velocity = random.coin() ? 0.0 : random.between(-0.1, 0.1);

        body.quadrant = random.integer(-5, 5);
        body.x = random.between(-5e-3, 5e-3);
        if (touch == Touch::corner) {
            body.angle = random.between(0.0, kQuarterTurn);
            body.omega = random.coin() ? 0.0 : random.between(-1000.0, 1000.0);
        }
        const Pose pose =
            model.shape.pose(body.quadrant, std::cos(body.angle), std::sin(body.angle));
        body.z = pose.height;
        body.vx = slip_velocity + body.omega * pose.height;
        body.vz = body.omega * pose.lever_arm;
    }

    Dynamics dynamics() const {
        // Gradients act on this robot with up to 0.2 uN, torques with 20 uN times its length.
        LocalField field(paper_coils(), all_driven());
        field.set_segment(stickslip::test::steady(currents));
        return Dynamics(model, field);
    }
    // The forces lift the robot off as a whole, against all adhesion.
    bool lifts(Dynamics& robot) const {
        robot.set_quadrant(body.quadrant);
        robot.field().rebase({body.x, body.z});
        const Load load = robot.load(robot.field_at(0.0), body.x, body.z, robot.pose(body.angle),
                                     body.vx, body.vz, body.omega);
        return load.fz > load.contact_adhesion;
    }
    double force_scale(const Load& load) const {
        const double r = model.shape.radius();
        return std::abs(load.fx) + std::abs(load.fz) + std::abs(load.torque) / r + model.adhesion +
               model.mass * body.omega * body.omega * r;
    }
};

struct Tally {
    int stick = 0, slip = 0, flight = 0, tip = 0, impulse = 0;
};

// Everything that the complementarity conditions of section IV-C ask of `found`.
void check_consistent(const Draw& draw, Dynamics& dynamics, Touch touch, const Resolution& found,
                      Tally& tally) {
    const Model& model = draw.model;
    const BodyState& body = draw.body;
    const bool tipped_to_rear = found.quadrant != body.quadrant;
    const double angle = tipped_to_rear ? kQuarterTurn : body.angle;
    if (tipped_to_rear) {
        CHECK(touch == Touch::face);
        CHECK(found.quadrant == body.quadrant - 1);
    }
    dynamics.set_quadrant(found.quadrant);
    dynamics.field().rebase({body.x, body.z});
    const Pose pose = dynamics.pose(angle);
    const Load load =
        dynamics.load(dynamics.field_at(0.0), body.x, body.z, pose, body.vx, body.vz, body.omega);
    const double adhesion = model.adhesion;
    // A dozen operations on forces of this size; divided by the effective inertia where it is used.
    double tolerance = 1e-14 * draw.force_scale(load);
    const double per_mass = 1.0 / model.mass;

    if (found.impulse) {
        ++tally.impulse;
        CHECK(draw.slip_velocity != 0.0);
        const double sign = draw.slip_velocity > 0.0 ? 1.0 : -1.0;
        CHECK(painleve_inertia(dynamics.robot(), pose, sign * model.friction.kinetic_coefficient) <=
              0.0);
        // And flight is none: without a reaction the corner, which still adheres, would sink.
        std::array<Corner, 2> adhering = {};
        adhering[0] = {pose.lever_arm, -adhesion, 0.0};
        const Acceleration free = accelerations(model, load, pose.height, 0.0, adhering);
        CHECK(gap_acceleration(free, body.omega, pose.lever_arm, pose.height) <=
              8.0 * tolerance * per_mass);
        return;
    }
    if (found.mode.touch == Touch::none) {
        ++tally.flight;
        // A corner that touched must not go into the surface once it is let go.
        const Acceleration free = accelerations(model, load, pose.height, 0.0, {});
        CHECK(gap_acceleration(free, body.omega, pose.lever_arm, pose.height) >=
              -8.0 * tolerance * per_mass);
        if (touch == Touch::face) {
            CHECK(gap_acceleration(free, body.omega, -pose.lever_arm, pose.height) >=
                  -8.0 * tolerance * per_mass);
        }
        return;
    }
    (found.mode.slip == 0 ? tally.stick : tally.slip) += 1;
    if (found.mode.slip == 0) {
        CHECK(draw.slip_velocity == 0.0);
    } else if (draw.slip_velocity != 0.0) {
        CHECK(found.mode.slip * draw.slip_velocity > 0.0);
    }

    std::array<Corner, 2> corners = {};
    const double coefficient = found.mode.slip * model.friction.kinetic_coefficient;
    if (found.mode.touch == Touch::face) {
        const FaceReaction reaction =
            face_reaction(model, found.quadrant, load, found.mode.slip == 0, coefficient);
        corners[0] = {pose.lever_arm, reaction.ahead, reaction.friction};
        corners[1] = {-pose.lever_arm, reaction.behind, 0.0};
    } else if (found.mode.slip == 0) {
        const CornerStick stick = corner_stick(dynamics.robot(), pose, body.omega, load);
        corners[0] = {pose.lever_arm, stick.reaction.normal, stick.reaction.friction};
    } else {
        const CornerSlip slip = corner_slip(dynamics.robot(), pose, body.omega, load, coefficient);
        CHECK(slip.effective_inertia > 0.0);
        tolerance *= std::max(1.0, model.inertia / slip.effective_inertia);
        corners[0] = {pose.lever_arm, slip.normal, -coefficient * slip.normal};
    }
    const double normal = corners[0].normal + corners[1].normal;
    const double friction = corners[0].friction;
    CHECK(corners[0].normal >= -tolerance);
    CHECK(corners[1].normal >= -tolerance);
    CHECK(std::abs(friction) <= model.friction.static_coefficient * normal + 4.0 * tolerance);

    // The adhesion pulls where the contact is: at the pivot, or shared by both ends of a face.
    const double share = found.mode.touch == Touch::face ? 0.5 * adhesion : adhesion;
    corners[0].normal -= share;
    corners[1].normal -= adhesion - share;
    const Acceleration a = accelerations(model, load, pose.height, 0.0, corners);
    const double small = 40.0 * tolerance * per_mass;
    CHECK(std::abs(gap_acceleration(a, body.omega, pose.lever_arm, pose.height)) <= small);
    const double other = gap_acceleration(a, body.omega, -pose.lever_arm, pose.height);
    if (found.mode.touch == Touch::face) {
        CHECK(std::abs(other) <= small);
    } else if (touch == Touch::face) {
        ++tally.tip;
        CHECK(other >= -small);
    }
    const double slip_acceleration =
        a.x - a.angular * pose.height - body.omega * body.omega * pose.lever_arm;
    if (found.mode.slip == 0) {
        CHECK(std::abs(slip_acceleration) <= small);
    } else if (draw.slip_velocity == 0.0) {
        CHECK(found.mode.slip * slip_acceleration >= -small);
    }
}

enum class Lift { any, absent, present };

Tally resolve_many(std::uint64_t seed, Touch touch, double most_friction, Lift lift,
                   int count = 4000) {
    Random random(seed);
    Tally tally;
    for (int n = 0; n < count; ++n) {
        CAPTURE(n);
        const Draw draw(random, touch, most_friction);
        Dynamics dynamics = draw.dynamics();
        if (lift != Lift::any && draw.lifts(dynamics) != (lift == Lift::present)) continue;
        const Resolution found =
            resolve_contact(FixedFrame(dynamics), 0.0, draw.body, touch, {draw.slip_velocity}, 0);
        check_consistent(draw, dynamics, touch, found, tally);
    }
    return tally;
}

}  // namespace

TEST_CASE("resolve: a corner, friction without Painleve: every condition holds") {
    const Tally tally = resolve_many(11, Touch::corner, 4.0 / 3.0, Lift::any);
    CHECK(tally.impulse == 0);
    CHECK(tally.stick > 300);
    CHECK(tally.slip > 300);
    CHECK(tally.flight > 300);
}

TEST_CASE("resolve: a corner at friction above 4/3: an impulse where sliding has no solution") {
    const Tally tally = resolve_many(12, Touch::corner, 3.0, Lift::any);
    CHECK(tally.impulse > 60);
    CHECK(tally.stick > 300);
    CHECK(tally.slip > 300);
    CHECK(tally.flight > 300);
}

TEST_CASE("resolve: a face under load: every condition holds") {
    for (const double most_friction : {1.3, 3.0}) {
        const Tally tally = resolve_many(13, Touch::face, most_friction, Lift::absent);
        CHECK(tally.stick > 300);
        CHECK(tally.slip > 300);
        CHECK(tally.tip > 300);
        // A corner at angle 0 of the standing robot jams from mu = (50^2 + r^2/3)/(50 125) = 1.37.
        CHECK((tally.impulse > 0) == (most_friction > 1.37));
    }
}

TEST_CASE("resolve: a face that is lifted as a whole: every condition holds") {
    const Tally tally = resolve_many(14, Touch::face, 1.3, Lift::present, 400);
    CHECK(tally.flight > 20);
    CHECK(tally.tip > 10);
}

TEST_CASE("resolve: at the limit of friction the event says which way, not a rounded sign") {
    // mu_s = mu_k: stick and slip are one there, and the slip's acceleration is zero to rounding.
    Model model = paper_model();
    model.friction = {0.2, 0.2};
    Dynamics dynamics = stickslip::test::in_uniform_field(model, 0.0, 0.0);
    for (const int onset : {-1, 1}) {
        BodyState body;
        body.z = model.shape.half_rise(0);
        const Resolution on_face =
            resolve_contact(FixedFrame(dynamics), 0.0, body, Touch::face, {}, onset);
        CHECK(on_face.mode == ContactMode{Touch::face, onset});
        body.angle = 0.1;
        body.z = model.shape.pose(0, std::cos(0.1), std::sin(0.1)).height;
        const Resolution on_corner =
            resolve_contact(FixedFrame(dynamics), 0.0, body, Touch::corner, {}, onset);
        CHECK(on_corner.mode == ContactMode{Touch::corner, onset});
    }
}

TEST_CASE("resolve: nothing that touches stays so") {
    const Model model = paper_model();
    Dynamics dynamics = stickslip::test::in_uniform_field(model, 0.0, 0.0);
    BodyState body;
    body.quadrant = -2;
    const Resolution found = resolve_contact(FixedFrame(dynamics), 0.0, body, Touch::none, {}, 0);
    CHECK(found.mode == ContactMode{Touch::none, 0});
    CHECK(found.quadrant == -2);
}

TEST_CASE("impulse without collision: slip and nothing else, through the corner") {
    const Model model = paper_model();
    Random random(4);
    for (int n = 0; n < 200; ++n) {
        const double angle = random.between(0.0, kQuarterTurn), slip = random.between(-0.2, 0.2);
        const Pose pose = model.shape.pose(0, std::cos(angle), std::sin(angle));
        BodyState before;
        before.omega = random.between(-1000.0, 1000.0);
        before.vx = slip + before.omega * pose.height;
        before.vz = before.omega * pose.lever_arm;
        BodyState after = before;
        stop_slip_by_impulse(model, pose, slip, after);
        const double speed = std::abs(slip) + 1000.0 * model.shape.radius();
        CHECK(std::abs(corner_velocity_x(pose, after.vx, after.omega)) < 4.0 * kRounding * speed);
        CHECK(std::abs(corner_velocity_z(pose, after.vz, after.omega)) < 4.0 * kRounding * speed);
        // Angular momentum about the corner: J omega + m (height vx + lever vz).
        const auto momentum = [&](const BodyState& body) {
            return model.inertia * body.omega +
                   model.mass * (pose.height * body.vx + pose.lever_arm * body.vz);
        };
        CHECK(std::abs(momentum(after) - momentum(before)) <
              16.0 * kRounding * model.mass * model.shape.radius() * speed);
        const auto energy = [&](const BodyState& body) {
            return 0.5 * model.mass * (body.vx * body.vx + body.vz * body.vz) +
                   0.5 * model.inertia * body.omega * body.omega;
        };
        CHECK(energy(after) <= energy(before) * (1.0 + 8.0 * kRounding));
    }
}

TEST_CASE("pose: that of the C library but for rounding, in every quadrant and turns beyond") {
    const Model model = paper_model();
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    for (const int quadrant : {0, 1, -6}) {
        dynamics.set_quadrant(quadrant);
        for (const double angle :
             {-0.1, 0.0, 1e-9, 0.4, 0.785, 1.2, kQuarterTurn, 1.68, 1.69, -0.12, 3.0, -40.0}) {
            const Pose pose = dynamics.pose(angle);
            const Pose direct = model.pose(quadrant, angle);
            // That of `cosine_and_sine`, and what an angle of 40 loses; then two roundings.
            const double tolerance = (4.0 + std::abs(angle)) * kRounding;
            CHECK(std::abs(pose.cosine - direct.cosine) < tolerance);
            CHECK(std::abs(pose.sine - direct.sine) < tolerance);
            CHECK(std::abs(pose.lever_arm - direct.lever_arm) <
                  2.0 * tolerance * model.shape.radius());
            CHECK(std::abs(pose.height - direct.height) < 2.0 * tolerance * model.shape.radius());
            CHECK(pose.angle == angle);
        }
        // Where a face lies flat.
        CHECK(dynamics.pose(0.0).cosine == 1.0);
        CHECK(dynamics.pose(0.0).sine == 0.0);
        CHECK(dynamics.pose(kQuarterTurn).cosine == 0.0);
        CHECK(dynamics.pose(kQuarterTurn).sine == 1.0);
    }
}
