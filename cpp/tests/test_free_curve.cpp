#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "stickslip/numbers/free_curve.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

namespace {

constexpr std::array<FreeReach, 3> kReaches = {FreeReach::from_zero, FreeReach::anchored,
                                               FreeReach::both_ways};

// Place of a knot over the span.
double place(FreeReach reach, std::size_t knot) {
    const auto n = static_cast<double>(knot);
    switch (reach) {
        case FreeReach::from_zero:
            return n / 4.0;
        case FreeReach::anchored:
            return (n + 1.0) / 5.0;
        case FreeReach::both_ways:
            break;
    }
    return n / 2.0 - 1.0;
}

FreeShape random_shape(Random& random, FreeReach reach) {
    FreeShape shape{reach, random.between(0.01, 100.0)};
    for (double& knot : shape.knots) knot = random.between(-1.0, 3.0);
    return shape;
}

}  // namespace

TEST_CASE("free curve: its slope is its derivative and does not jump at a knot") {
    Random random(3);
    for (const FreeReach reach : kReaches) {
        const FreeShape shape = random_shape(random, reach);
        const FreeCurve curve(shape);
        const double low = reach == FreeReach::both_ways ? -1.2 : 0.01;
        const double h = 1e-4 * shape.span;
        // Second and third derivatives of a cubic that spans 10 over a fifth of the span.
        const double bend = 6.0 * 10.0 * 25.0, jerk = 12.0 * 10.0 * 125.0;
        for (int n = 0; n < 200; ++n) {
            const double at = shape.span * random.between(low, 1.2);
            const double difference = (curve.at(at + h) - curve.at(at - h)) / (2.0 * h);
            // Within an interval the error is f''' h^2/6; a knot in between adds f'' h.
            const double tolerance = (bend * 1e-4 + jerk * 1e-8) / shape.span;
            CHECK(std::abs(curve.slope(at) - difference) < tolerance);
        }
        for (std::size_t i = reach == FreeReach::from_zero ? 1 : 0; i < kKnots; ++i) {
            const double knot = place(reach, i) * shape.span, near = 1e-9 * shape.span;
            CHECK(std::abs(curve.slope(knot + near) - curve.slope(knot - near)) <
                  2.0 * bend * 1e-9 / shape.span);
        }
    }
}

TEST_CASE("free curve: 1 + f is cut off at zero, and exactly one where all knots are zero") {
    const FreeCurve deep({FreeReach::from_zero, 1.0, {0.0, -1.0, -1.0, 2.0, 2.0}});
    CHECK(deep.at(0.4) < -1.0);  // the cubic dips below its knots
    CHECK(deep.factor(0.4) == 0.0);
    CHECK(deep.factor(0.0) == 1.0);
    const FreeCurve none({FreeReach::both_ways, 0.3});
    CHECK(none.absent());
    CHECK_FALSE(deep.absent());
    CHECK(none.factor(0.1) == 1.0);
    CHECK(FreeCurve().factor(7.0) == 1.0);
}
