#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/phases.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

FreeShape random_shape(Random& random) {
    FreeShape shape{FreeReach::both_ways, random.between(0.2, 3.2)};
    for (double& knot : shape.knots) knot = random.between(-0.3, 0.3);
    return shape;
}

Model placed_model(const FreeShape& shape) {
    Model model = paper_model();
    model.place = ContactPlace(shape, model.shape.half_base(0));
    return model;
}

}  // namespace

TEST_CASE("contact place: nothing jumps at a knot, at zero or where a quadrant ends") {
    Random random(3);
    for (int n = 0; n < 100; ++n) {
        const FreeShape shape = random_shape(random);
        const Model model = placed_model(shape);
        for (const double theta : {-shape.span, -0.5 * shape.span, 0.0, 0.5 * shape.span,
                                   shape.span, 0.25 * shape.span, kQuarterTurn}) {
            constexpr double kNear = 1e-11;
            const PlaceShift a = model.place.at(theta - kNear), b = model.place.at(theta + kNear);
            const double rounding = 1e-9 * model.shape.radius();
            CHECK(std::abs(a.lever_arm - b.lever_arm) < rounding);
            CHECK(std::abs(a.height - b.height) < rounding);
            CHECK(std::abs(a.rolled_distance - b.rolled_distance) < rounding);
            CHECK(std::abs(a.curvature_radius - b.curvature_radius) < 100.0 * rounding);
        }
        for (int quadrant = -4; quadrant < 4; ++quadrant) {
            const Pose end = model.pose(quadrant, kQuarterTurn),
                       next = model.pose(quadrant + 1, 0.0);
            const Face face = model.face(quadrant + 1);
            CHECK(end.height == doctest::Approx(next.height).epsilon(1e-12));
            CHECK(face.height == doctest::Approx(next.height).epsilon(1e-12));
            CHECK(face.shift + face.half_base == doctest::Approx(next.lever_arm).epsilon(1e-12));
            CHECK(face.shift - face.half_base == doctest::Approx(end.lever_arm).epsilon(1e-12));
        }
    }
}

TEST_CASE("contact place: motions satisfy Newton's and Euler's equations") {
    Random random(4);
    for (int n = 0; n < 500; ++n) {
        const Model model = placed_model(random_shape(random));
        Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
        const int quadrant = random.integer(-2, 1);
        dynamics.set_quadrant(quadrant);
        const double angle = random.between(0.0, kQuarterTurn);
        const double omega = random.between(-3000.0, 3000.0);
        const Pose pose = dynamics.pose(angle);
        const Load load = {random.between(-1e-6, 1e-6), random.between(-1e-6, 1e-6),
                           random.between(-1e-10, 1e-10), random.between(0.0, 0.5e-6)};
        const double m = model.mass, ww = omega * omega;
        // Accelerations of the centre of mass from the constraints z = h(theta), and vx = h omega
        // where it rolls.
        const double bend = -pose.height + pose.curvature_radius;  // slope of the lever
        const auto check = [&](double alpha, double slip, const Reaction& reaction) {
            const double ax = slip + alpha * pose.height + ww * pose.lever_arm;
            const double az = alpha * pose.lever_arm + ww * bend;
            const double up = reaction.normal - load.contact_adhesion;
            const double force = m * (std::abs(ax) + std::abs(az)) + std::abs(up) + 1e-6;
            CHECK(std::abs(m * ax - load.fx - reaction.friction) < 1e-13 * force);
            CHECK(std::abs(m * az - load.fz - up) < 1e-13 * force);
            const double torque =
                load.torque - pose.height * reaction.friction - pose.lever_arm * up;
            const double size = model.inertia * std::abs(alpha) + force * model.shape.radius();
            CHECK(std::abs(model.inertia * alpha - torque) < 1e-12 * size);
        };
        const CornerStick stick = corner_stick(dynamics.robot(), pose, omega, load);
        check(stick.angular_acceleration, 0.0, stick.reaction);
        const CornerSlip slip = corner_slip(dynamics.robot(), pose, omega, load, 0.1);
        if (std::abs(slip.effective_inertia) < 0.1 * model.inertia) continue;
        check(slip.angular_acceleration, slip.slip_acceleration, {slip.normal, -0.1 * slip.normal});
    }
}

TEST_CASE("contact place: a face carries its load where its ends are") {
    Random random(5);
    for (int n = 0; n < 200; ++n) {
        const Model model = placed_model(random_shape(random));
        const int quadrant = random.integer(-2, 2);
        const Load load = {random.between(-1e-6, 1e-6), random.between(-1e-6, 1e-6),
                           random.between(-1e-10, 1e-10), random.between(0.0, 0.5e-6)};
        const FaceReaction r = face_reaction(model, quadrant, load, true, 0.0);
        const Face face = model.face(quadrant);
        const double adhesion = 0.5 * load.contact_adhesion;
        const double torque = load.torque - face.height * r.friction -
                              (face.shift + face.half_base) * (r.ahead - adhesion) -
                              (face.shift - face.half_base) * (r.behind - adhesion);
        CHECK(std::abs(torque) < 1e-13 * 1e-6 * model.shape.radius() * 10.0);
        CHECK(r.normal() == doctest::Approx(load.contact_adhesion - load.fz));
    }
}
