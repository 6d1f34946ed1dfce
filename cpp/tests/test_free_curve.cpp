#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "stickslip/numbers/free_curve.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::kRounding;
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

double distance(FreeReach reach) {
    return place(reach, 1) - place(reach, 0);
}

FreeShape random_shape(Random& random, FreeReach reach) {
    FreeShape shape{reach, random.between(0.01, 100.0)};
    for (double& knot : shape.knots) knot = random.between(-1.0, 3.0);
    return shape;
}

// The cubic with values f0, f1 and slopes d0, d1 (over the interval) at its ends, by its powers.
double cubic(double s, double f0, double f1, double d0, double d1) {
    return f0 + s * (d0 + s * (3.0 * (f1 - f0) - 2.0 * d0 - d1 + s * (2.0 * (f0 - f1) + d0 + d1)));
}

}  // namespace

TEST_CASE("free curve: between knots it is the cubic of their central differences") {
    Random random(1);
    for (const FreeReach reach : kReaches) {
        for (int n = 0; n < 50; ++n) {
            const FreeShape shape = random_shape(random, reach);
            const FreeCurve curve(shape);
            const auto& k = shape.knots;
            const double first = reach == FreeReach::anchored    ? 0.5 * k[1]
                                 : reach == FreeReach::from_zero ? k[1] - k[0]
                                                                 : 0.0;
            const std::array<double, kKnots> slopes = {
                first, 0.5 * (k[2] - k[0]), 0.5 * (k[3] - k[1]), 0.5 * (k[4] - k[2]), 0.0};
            for (std::size_t i = 0; i + 1 < kKnots; ++i) {
                const double s = random.between(0.0, 1.0);
                const double at = shape.span * (place(reach, i) + s * distance(reach));
                const double expected = cubic(s, k[i], k[i + 1], slopes[i], slopes[i + 1]);
                // A dozen operations with numbers up to 10, and the argument's rounding.
                CHECK(curve.at(at) == doctest::Approx(expected).epsilon(1e-13).scale(1.0));
            }
            if (reach != FreeReach::anchored) continue;
            const double s = random.between(0.0, 1.0);
            const double expected = cubic(s, 0.0, k[0], k[0], 0.5 * k[1]);
            CHECK(curve.at(0.2 * s * shape.span) ==
                  doctest::Approx(expected).epsilon(1e-13).scale(1.0));
        }
    }
}

TEST_CASE("free curve: the knots are met, and held beyond the ends") {
    Random random(2);
    for (const FreeReach reach : kReaches) {
        const FreeShape shape = random_shape(random, reach);
        const FreeCurve curve(shape);
        for (std::size_t i = 0; i < kKnots; ++i) {
            CHECK(curve.at(place(reach, i) * shape.span) ==
                  doctest::Approx(shape.knots[i]).epsilon(8.0 * kRounding).scale(1.0));
        }
        for (const double beyond : {1.0, 1.5, std::numeric_limits<double>::infinity()}) {
            CHECK(curve.at(beyond * shape.span) == shape.knots[4]);
            CHECK(curve.slope(beyond * shape.span) == 0.0);
        }
        if (reach == FreeReach::both_ways) {
            CHECK(curve.at(-3.0 * shape.span) == shape.knots[0]);
            CHECK(curve.slope(-3.0 * shape.span) == 0.0);
        }
    }
    CHECK(FreeCurve({FreeReach::anchored, 2.0, {1.0, 1.0, 1.0, 1.0, 1.0}}).at(0.0) == 0.0);
}

TEST_CASE("free curve: its slope is its derivative and does not jump at a knot") {
    Random random(3);
    for (const FreeReach reach : kReaches) {
        const FreeShape shape = random_shape(random, reach);
        const FreeCurve curve(shape);
        const double low = reach == FreeReach::both_ways ? -1.2 : 0.01;
        const double h = 1e-4 * shape.span;
        // Of a cubic that spans 10 over a fifth of the span: its second and third derivatives.
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

TEST_CASE("free curve: it is linear in its knots") {
    Random random(4);
    for (const FreeReach reach : kReaches) {
        for (int n = 0; n < 50; ++n) {
            const FreeShape a = random_shape(random, reach);
            FreeShape b = random_shape(random, reach), sum = a;
            b.span = a.span;
            for (std::size_t i = 0; i < kKnots; ++i) sum.knots[i] = 2.0 * a.knots[i] - b.knots[i];
            const double at = a.span * random.between(-1.2, 1.2);
            const double expected = 2.0 * FreeCurve(a).at(at) - FreeCurve(b).at(at);
            CHECK(FreeCurve(sum).at(at) == doctest::Approx(expected).epsilon(1e-13).scale(1.0));
        }
    }
}

TEST_CASE("free curve: a straight line is met up to the last knot but one") {
    for (const FreeReach reach : kReaches) {
        FreeShape shape{reach, 3.0};
        for (std::size_t i = 0; i < kKnots; ++i) shape.knots[i] = 0.7 * 3.0 * place(reach, i);
        const FreeCurve curve(shape);
        const double first = reach == FreeReach::both_ways ? place(reach, 1) : 0.0;
        for (int n = 0; n <= 100; ++n) {
            const double at = 3.0 * (first + (place(reach, 3) - first) * n / 100.0);
            CHECK(curve.at(at) == doctest::Approx(0.7 * at).epsilon(1e-14).scale(1.0));
        }
    }
}

TEST_CASE("free curve: 1 + f is cut off at zero, and exactly one where all knots are zero") {
    const FreeCurve deep({FreeReach::from_zero, 1.0, {0.0, -1.0, -1.0, 2.0, 2.0}});
    CHECK(deep.at(0.4) < -1.0);  // the cubic dips below its knots
    CHECK(deep.factor(0.4) == 0.0);
    CHECK(deep.factor_slope(0.4) == 0.0);
    CHECK(deep.factor(0.0) == 1.0);
    CHECK(deep.least_factor() == 0.0);
    const FreeCurve none({FreeReach::both_ways, 0.3});
    CHECK(none.absent());
    CHECK_FALSE(deep.absent());
    CHECK(none.factor(0.1) == 1.0);
    CHECK(none.factor_at_angle(0.6, 0.8) == 1.0);
    CHECK(none.factor_slope(0.1) == 0.0);
    CHECK(none.least_factor() == 1.0);
    CHECK(FreeCurve().factor(7.0) == 1.0);
    const FreeCurve angle({FreeReach::both_ways, 1.0, {0.1, 0.2, 0.3, 0.4, 0.5}});
    CHECK(angle.factor_at_angle(std::sin(-0.7), std::cos(-0.7)) ==
          doctest::Approx(angle.factor(-0.7)).epsilon(1e-14));
    CHECK(angle.factor_at_angle(0.0, -1.0) == angle.factor(std::numbers::pi));
}
