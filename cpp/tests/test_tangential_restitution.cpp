#include <doctest/doctest.h>

#include <cmath>

#include "impact_draws.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

// Roundings of velocities of up to 1 m/s, and of 1e4 rad/s times 135 um.
constexpr double kSpeedTolerance = 1e-13;
// Relative tolerance of the kinetic energy, a sum of squares of those velocities.
constexpr double kEnergyTolerance = 1e-11;

}  // namespace

TEST_CASE("corner impact: the slip is reversed in part, or friction is at its limit") {
    Random random(11);
    int reversed = 0, limited = 0, reduced = 0;
    for (int n = 0; n < 10000; ++n) {
        CornerImpact impact(random, 3.0, random.between(0.01, 1.0));
        impact.model.tangential_restitution = random.between(0.01, 1.0);
        const auto& [model, pose, before] = impact;
        const ImpactResult result = corner_impact(model, pose, before);
        const BodyState& after = result.body;
        const double ratio = kinetic_energy(model, after) / kinetic_energy(model, before);
        REQUIRE(ratio <= 1.0 + kEnergyTolerance);

        const double rebound = -corner_velocity_z(pose, after.vz, after.omega) /
                               corner_velocity_z(pose, before.vz, before.omega);
        // Factor on both restitutions; less than one only where all energy was kept.
        const double part = rebound / model.restitution;
        CHECK(part <= 1.0 + 1e-9);
        if (part < 1.0 - 1e-9) {
            CHECK(ratio >= 1.0 - kEnergyTolerance);
            ++reduced;
        }
        const double slip = corner_velocity_x(pose, after.vx, after.omega);
        const double target =
            -part * model.tangential_restitution * corner_velocity_x(pose, before.vx, before.omega);
        CHECK(std::abs(slip - result.slip_velocity) <= kSpeedTolerance);
        const double limit =
            model.friction.kinetic_coefficient * model.mass * (after.vz - before.vz);
        const double tangential = model.mass * (after.vx - before.vx);
        // As in test_impact.cpp, a momentum of m times 1 m/s; the restitutions' part is as exact.
        const double small = 1e-11 * model.mass;
        if (std::abs(slip - target) <= 1e-11) {
            CHECK(std::abs(tangential) <= limit + small);
            ++reversed;
        } else {
            CHECK(std::abs(tangential + (slip > target ? limit : -limit)) <= small);
            ++limited;
        }
    }
    CHECK(reversed > 1000);
    CHECK(limited > 1000);
    CHECK(reduced > 20);
}

TEST_CASE("face impact: no energy comes from the tangential restitution") {
    Random random(12);
    int matters = 0;
    for (int n = 0; n < 20000; ++n) {
        FaceImpact face(random, 2.0, random.between(0.0, 1.0));
        const BodyState without =
            face_impact(face.model, face.before, face.arrival, face.old_slips).body;
        face.model.tangential_restitution = random.between(0.01, 1.0);
        const BodyState with =
            face_impact(face.model, face.before, face.arrival, face.old_slips).body;
        REQUIRE(kinetic_energy(face.model, with) <=
                kinetic_energy(face.model, face.before) * (1.0 + kEnergyTolerance));
        if (with.vx != without.vx) ++matters;
    }
    CHECK(matters > 1000);
}

TEST_CASE("impact: what does not rebound keeps no slip of the tangential restitution") {
    Random random(13);
    for (int n = 0; n < 2000; ++n) {
        CornerImpact corner(random, 3.0, 0.0);
        const BodyState stopped = corner_impact(corner.model, corner.pose, corner.before).body;
        corner.model.tangential_restitution = 0.7;
        const BodyState same = corner_impact(corner.model, corner.pose, corner.before).body;
        CHECK(same.vx == stopped.vx);
        CHECK(same.vz == stopped.vz);
        CHECK(same.omega == stopped.omega);
    }
}
