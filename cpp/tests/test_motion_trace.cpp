#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "stickslip/solver/motion_trace.hpp"
#include "support.hpp"

using namespace stickslip;

namespace {

struct Swing {
    static constexpr bool kSlips = false;
    double angle(const std::array<double, 2>& y) const { return y[0]; }
    double omega(const std::array<double, 2>& y) const { return y[1]; }
};

}  // namespace

TEST_CASE(
    "motion trace: the interpolant of fifth degree is exact for a polynomial of that degree") {
    const auto value = [](double s) {
        return 1 + s * (2 + s * (-3 + s * (1 + s * (-2 + s * 0.5))));
    };
    const auto slope = [](double s) { return 2 + s * (-6 + s * (3 + s * (-8 + s * 2.5))); };
    const auto curvature = [](double s) { return -6 + s * (6 + s * (-24 + s * 10)); };
    const QuinticHermite<double> p(value(0), slope(0), curvature(0), value(1), slope(1),
                                   curvature(1));
    for (int i = 0; i <= 10; ++i) CHECK(p.at(0.1 * i) == doctest::Approx(value(0.1 * i)));
    REQUIRE(slope(0) * slope(1) < 0.0);
    CHECK(std::abs(slope(p.turning_point(slope(0), slope(1)))) < 1e-6);
}

TEST_CASE("motion trace: the extreme of a swing is found to the sixth order of the step") {
    // angle = cos t, about its lowest point at t = pi; the interpolant's error is h^6/46080.
    for (const double width : {0.4, 0.2}) {
        const double t0 = 3.14159 - 0.37 * width, t1 = t0 + width;
        const std::array<double, 2> first = {std::cos(t0), -std::sin(t0)},
                                    first_rates = {-std::sin(t0), -std::cos(t0)},
                                    last = {std::cos(t1), -std::sin(t1)},
                                    last_rates = {-std::sin(t1), -std::cos(t1)};
        MotionTrace<double> trace = {first[0], first[0], 0.0};
        trace.step(Swing(), width, first, first_rates, last, last_rates);
        CHECK(std::abs(trace.lowest + 1.0) < std::pow(width, 6) / 46080.0);
        CHECK(trace.highest == std::max(first[0], last[0]));
    }
}
