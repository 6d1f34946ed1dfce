#include "stickslip/readings/static_tilt.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support.hpp"

using namespace stickslip;
using stickslip::test::paper_model;
using stickslip::test::Random;

namespace {

// Moment about the corner that the robot pivots on, N m, by hand from Eqs. (8), (12)-(14).
double moment_by_hand(const Model& model, double bx, double bz, double theta) {
    const double r = model.shape.radius();
    const double phi = std::atan2(50e-6, 125e-6);
    const double direction = theta + model.misalignment;
    const double magnetic = -model.moment * (bx * std::sin(direction) + bz * std::cos(direction));
    const double weight = -model.mass * model.gravity_z;
    const double lever = theta > 0.0 ? r * std::cos(theta + phi) : -r * std::cos(-theta + phi);
    return magnetic - weight * lever;
}

}  // namespace

TEST_CASE("a robot on a corner rests where magnet and weight balance") {
    Random random(5);
    int on_a_corner = 0;
    for (int i = 0; i < 500; ++i) {
        Model model = paper_model();
        model.misalignment = random.between(-0.5, 0.5);
        const double bx = random.between(0.0, 4e-3), bz = random.between(-4e-3, 4e-3);
        const double theta = static_tilt(model, bx, bz);
        const double upright = std::numbers::pi / 2;
        if (theta == 0.0 || std::abs(theta) >= upright) continue;
        ++on_a_corner;
        const double scale = model.moment * std::hypot(bx, bz) + model.mass * 9.81 * 135e-6;
        CHECK(std::abs(moment_by_hand(model, bx, bz, theta)) < 1e-10 * scale);
        // Stable: a little farther it is turned back, a little less and it is turned on.
        const double sense = theta > 0.0 ? 1.0 : -1.0, step = 1e-4 * sense;
        CHECK(sense * moment_by_hand(model, bx, bz, theta + step) < 0.0);
        CHECK(sense * moment_by_hand(model, bx, bz, theta - step) > 0.0);
    }
    CHECK(on_a_corner > 200);
}

TEST_CASE("an exact mirror") {
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        Model model = paper_model(), mirrored = paper_model();
        model.misalignment = random.between(-0.5, 0.5);
        mirrored.misalignment = -model.misalignment;
        const double bx = random.between(-1e-3, 4e-3), bz = random.between(-4e-3, 4e-3);
        CHECK(static_tilt(model, bx, bz) ==
              doctest::Approx(-static_tilt(mirrored, bx, -bz)).epsilon(1e-10));
    }
}

TEST_CASE("a robot without weight aligns, through as many faces as it takes") {
    Model model = paper_model();
    model.gravity_z = 0.0;
    model.adhesion.strength = 0.0;
    for (double theta = -3.1; theta < 3.15; theta += 0.2) {
        const double found = static_tilt(model, 2e-3 * std::cos(theta), -2e-3 * std::sin(theta));
        CHECK(found == doctest::Approx(theta).epsilon(1e-10));
    }
}

TEST_CASE("adhesion holds a face that has landed") {
    // The front face lies down at 90 degrees. The magnet turns on with 20 fN m; weight holds with
    // 13 fN m about the next corner, adhesion with another 11.
    Model model = paper_model();
    model.misalignment = -0.003;
    CHECK(static_tilt(model, 0.0, -4e-3) == std::numbers::pi / 2);
    model.adhesion.strength = 0.0;
    CHECK(static_tilt(model, 0.0, -4e-3) > std::numbers::pi / 2);
}

TEST_CASE("readings of many points") {
    const Scenario base;
    const std::vector<double> fields = {1e-3, -1e-3, 2e-3, 1e-3};
    const auto found =
        static_tilts(base, {"effects.misalignment.angle"}, {0.0, 0.1, 100.0}, fields);
    REQUIRE(found.size() == 6);
    CHECK(found[0] == static_tilt(paper_model(), 1e-3, -1e-3));
    Model turned = paper_model();
    turned.misalignment = 0.1;
    CHECK(found[3] == static_tilt(turned, 2e-3, 1e-3));
    CHECK(std::isnan(found[4]));
    CHECK_THROWS_AS(static_tilts(base, {"drag.linea"}, {0.0}, fields), std::invalid_argument);
    CHECK_THROWS_AS(static_tilts(base, {"drag.linear"}, {1.0}, {1e-3}), std::invalid_argument);
}
