#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "stickslip/solver/motion_trace.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

struct Rocking {
    static constexpr bool kSlips = false;
    double angle(const std::array<double, 2>& y) const { return y[0]; }
    double omega(const std::array<double, 2>& y) const { return y[1]; }
};

}  // namespace

TEST_CASE("motion trace: the interpolant is exact for a cubic, and so is its turning point") {
    // Falling then rising, rising then falling, either with a curvature that changes its sign too.
    for (const double bend : {-1.0, 0.0, 1.0, 3.0}) {
        for (const double sign : {1.0, -1.0}) {
            const auto value = [&](double s) { return sign * (1 + s * (-2 + s * (3 + s * bend))); };
            const auto slope = [&](double s) { return sign * (-2 + s * (6 + s * 3 * bend)); };
            const CubicHermite<double> p(value(0), slope(0), value(1), slope(1));
            for (int i = 0; i <= 10; ++i) CHECK(p.at(0.1 * i) == doctest::Approx(value(0.1 * i)));
            REQUIRE(slope(0) * slope(1) < 0.0);
            const double at = p.turning_point();
            CHECK(at > 0.0);
            CHECK(at < 1.0);
            CHECK(std::abs(slope(at)) < 1e-14);
        }
    }
}

TEST_CASE("motion trace: the extreme of a swing is found to the fourth order of the step") {
    // angle = cos t, about its lowest point at t = pi; the interpolant's error is h^4/384.
    for (const double width : {0.4, 0.2}) {
        const double t0 = 3.14159 - 0.37 * width, t1 = t0 + width;
        const std::array<double, 2> first = {std::cos(t0), -std::sin(t0)},
                                    last = {std::cos(t1), -std::sin(t1)};
        MotionTrace<double> trace = {first[0], first[0], 0.0};
        trace.step(Rocking(), width, first, last);
        CHECK(std::abs(trace.lowest + 1.0) < std::pow(width, 4) / 384.0);
        CHECK(trace.highest == std::max(first[0], last[0]));
    }
}
