#include "stickslip/field/turning_points.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

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
