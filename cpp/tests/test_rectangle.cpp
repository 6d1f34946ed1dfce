#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "stickslip/body/rectangle.hpp"
#include "stickslip/contact/dynamics.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

constexpr double kLength = 250e-6, kHeight = 100e-6;

struct Point {
    double x, z;
};

// The four corners about the centre of mass, in the order of the quadrants, turned nose-down by
// theta: (u, w) -> (u cos + w sin, w cos - u sin).
std::array<Point, 4> corners(double theta) {
    const double u = 0.5 * kLength, w = 0.5 * kHeight;
    const std::array<Point, 4> body = {{{u, -w}, {u, w}, {-u, w}, {-u, -w}}};
    std::array<Point, 4> turned;
    const double c = std::cos(theta), s = std::sin(theta);
    for (std::size_t i = 0; i < 4; ++i) {
        turned[i] = {body[i].x * c + body[i].z * s, body[i].z * c - body[i].x * s};
    }
    return turned;
}

std::size_t corner_of(int quadrant) {
    return static_cast<std::size_t>(((quadrant % 4) + 4) % 4);
}

}  // namespace

TEST_CASE("rectangle: the pivot of a quadrant is the lowest of the four corners, in any turn") {
    const Rectangle shape(kLength, kHeight);
    Random random(1);
    for (int n = 0; n < 2000; ++n) {
        const int quadrant = random.integer(-9, 9);
        const double angle = random.between(0.0, kQuarterTurn);
        const std::array<Point, 4> explicit_corners = corners(quadrant * kQuarterTurn + angle);
        const Pose pose = shape.pose(quadrant, std::cos(angle), std::sin(angle));
        const Point& pivot = explicit_corners[corner_of(quadrant)];
        // The rounding of an angle of up to 16 rad times a radius of 135 um.
        const double tolerance = 16.0 * kRounding * shape.radius();
        CHECK(std::abs(pose.lever_arm - pivot.x) < tolerance);
        CHECK(std::abs(pose.height + pivot.z) < tolerance);
        for (const Point& corner : explicit_corners) CHECK(corner.z > -pose.height - tolerance);
    }
}

TEST_CASE("rectangle: gaps of the neighbouring corners by base, rise, sine and cosine") {
    const Rectangle shape(kLength, kHeight);
    Random random(2);
    for (int n = 0; n < 500; ++n) {
        const int quadrant = random.integer(-9, 9);
        const double angle = random.between(0.0, kQuarterTurn);
        const std::array<Point, 4> at = corners(quadrant * kQuarterTurn + angle);
        const double lowest = at[corner_of(quadrant)].z;
        const double tolerance = 16.0 * kRounding * 2.0 * shape.radius();
        const double behind = 2.0 * shape.half_base(quadrant) * std::sin(angle);
        const double ahead = 2.0 * shape.half_rise(quadrant) * std::cos(angle);
        CHECK(std::abs(at[corner_of(quadrant - 1)].z - lowest - behind) < tolerance);
        CHECK(std::abs(at[corner_of(quadrant + 1)].z - lowest - ahead) < tolerance);
        CHECK(std::abs(at[corner_of(quadrant + 2)].z - lowest - behind - ahead) < tolerance);
    }
}

TEST_CASE("rectangle: the end of a quadrant and the beginning of the next are one position") {
    const Rectangle shape(kLength, kHeight);
    for (int quadrant = -5; quadrant <= 5; ++quadrant) {
        const Pose end = shape.pose(quadrant, 0.0, 1.0);
        const Pose begin = shape.pose(quadrant + 1, 1.0, 0.0);
        CHECK(end.height == begin.height);         // both touch: at one height, exactly
        CHECK(end.lever_arm == -begin.lever_arm);  // the rear and the front end of the face
        CHECK(begin.lever_arm == shape.half_base(quadrant + 1));
        CHECK(begin.height == shape.half_rise(quadrant + 1));
    }
}

TEST_CASE("quarter turns: exact sines and cosines, also of negative turns") {
    for (int quadrant = -9; quadrant <= 9; ++quadrant) {
        const QuarterTurns turn(quadrant);
        CHECK(std::abs(turn.cosine) + std::abs(turn.sine) == 1.0);
        CHECK(std::abs(turn.cosine - std::cos(quadrant * kQuarterTurn)) < 1e-14);
        CHECK(std::abs(turn.sine - std::sin(quadrant * kQuarterTurn)) < 1e-14);
    }
}
