#include <doctest/doctest.h>

#include <cmath>

#include "stickslip/contact/contact.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::kRounding;
using stickslip::test::paper_model;
using stickslip::test::Random;

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
