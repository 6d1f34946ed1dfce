#include <doctest/doctest.h>

#include <cmath>

#include "stickslip/contact/dynamics.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::in_uniform_field;
using stickslip::test::kRounding;
using stickslip::test::paper_model;

TEST_CASE("pose: that of the C library but for rounding, in every quadrant and turns beyond") {
    const Model model = paper_model();
    Dynamics dynamics = in_uniform_field(model, 0.0, 0.0);
    for (const int quadrant : {0, 1, -6}) {
        dynamics.set_quadrant(quadrant);
        for (const double angle :
             {-0.1, 0.0, 1e-9, 0.4, 0.785, 1.2, kQuarterTurn, 1.68, 1.69, -0.12, 3.0, -40.0}) {
            const Pose pose = dynamics.pose(angle);
            const Pose direct = model.pose(quadrant, angle);
            // Errors of `cosine_and_sine` and of an angle as large as 40; then two roundings.
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
