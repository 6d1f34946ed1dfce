#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "stickslip/field/turning_points.hpp"
#include "stickslip/solver/motion_trace.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

TEST_CASE("a current of one exponential turns where its slope is zero") {
    CurrentSegment segment;
    segment.duration = 0.02;
    segment.rate[0] = 143.0;
    segment.coil[1][2] = 100.0;
    segment.coil[2][2] = 2.0;  // 100 = 2 x 143 exp(-143 tau)
    int count = 0;
    for_each_turn(segment, 2, [&](double tau) {
        ++count;
        CHECK(tau == doctest::Approx(std::log(2.86) / 143.0).epsilon(1e-14));
    });
    CHECK(count == 1);
    // Neither one without a current, nor one that turns later.
    for_each_turn(segment, 0, [&](double) { ++count; });
    segment.duration = 0.005;
    for_each_turn(segment, 2, [&](double) { ++count; });
    CHECK(count == 1);
}

TEST_CASE("a field that the currents change more slowly than the motion may may turn") {
    CurrentSegment segment;
    segment.duration = 0.01;
    segment.rate[0] = 143.0;
    FieldCourse course;
    course.segment = &segment;
    course.basis[0] = {1e-3, 0.0, 0.0};
    course.basis[1] = {1e-3, 0.0, 0.0};  // T/s
    course.gradient[0] = {0.01, 0.0, 0.0, 0.0, 0.0, 0.0};
    int count = 0;
    double played = 0.0;
    const auto add = [&](const FieldTurn& turn, double least, double most) {
        ++count;
        played += turn.to - turn.from;
        CHECK(least < 1e-3);
        CHECK(most > 1e-3);
    };
    for_each_field_turn(course, 0.01, add);  // 0.01 T/m at 0.01 m/s is 1e-4 T/s
    CHECK(count == 0);
    for_each_field_turn(course, 0.2, add);
    CHECK(played >= segment.duration * (1.0 - 1e-12));
}

TEST_CASE("the least value of a function is that of its parabolas") {
    Random random(13);
    for (int i = 0; i < 500; ++i) {
        const double at = random.between(-0.5, 1.5), wave = random.between(0.05, 0.3);
        const auto f = [&](double s) { return 1.0 - std::cos(wave * (s - at)); };
        const Extreme found =
            least_value(0.0, 1.0, random.integer(1, 2), f, [](double) { return true; });
        const double expected = f(std::clamp(at, 0.0, 1.0));
        CHECK(found.value >= expected);
        CHECK(found.value <= expected + 1e-10);
        CHECK(f(found.at) == found.value);
    }
}

TEST_CASE("turning points: a rate that overflowed has an end") {
    CurrentSegment segment;
    segment.exponentials = 1;
    segment.rate[0] = std::numeric_limits<double>::infinity();
    segment.duration = 0.1;
    std::vector<double> ends;
    for_each_part(segment, [&](double tau) { ends.push_back(tau); });
    REQUIRE(!ends.empty());
    CHECK(ends.size() < 200);
    CHECK(ends.back() == segment.duration);
}

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
