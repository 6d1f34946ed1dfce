#include "stickslip/field/turning_points.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

namespace {

// Exponentials whose rates are up to a hundred times apart, over segments from far shorter than
// the fastest to far longer than the slowest.
CurrentSegment random_segment(Random& random) {
    CurrentSegment segment;
    segment.exponentials = random.integer(1, kMaxExponentials);
    const auto exponentials = static_cast<std::size_t>(segment.exponentials);
    double fastest = 0.0;
    for (std::size_t j = 0; j < exponentials; ++j) {
        segment.rate[j] = 1e2 * std::pow(10.0, random.between(0.0, 2.0));
        fastest = std::max(fastest, segment.rate[j]);
    }
    segment.duration = std::pow(10.0, random.between(-1.0, 3.0)) / fastest;
    const double line = random.coin() ? random.between(-2.0, 2.0) / segment.duration : 0.0;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        segment.coil[0][k] = random.between(-2.0, 2.0);
        segment.coil[1][k] = line * random.between(-1.0, 1.0);
        for (std::size_t j = 0; j < exponentials; ++j) {
            segment.coil[2 + j][k] = random.integer(0, 3) ? random.between(-2.0, 2.0) : 0.0;
        }
    }
    return segment;
}

// Times that are as dense at the start, where the exponentials fade, as they have to be.
std::vector<double> dense_times(const CurrentSegment& segment, int count) {
    const double fastest =
        *std::max_element(segment.rate.begin(), segment.rate.begin() + segment.exponentials);
    const double range = std::log1p(segment.duration * fastest);
    std::vector<double> times;
    for (int i = 0; i <= count; ++i) times.push_back(std::expm1(range * i / count) / fastest);
    times.back() = segment.duration;
    return times;
}

}  // namespace

TEST_CASE("the extremes of currents are at the ends of a segment or where they turn") {
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
        const CurrentSegment segment = random_segment(random);
        const auto times = dense_times(segment, 2000);
        PerCoil low = segment.currents(0.0), high = low;
        for (const double tau : times) {
            const PerCoil now = segment.currents(tau);
            for (std::size_t k = 0; k < kCoilCount; ++k) {
                low[k] = std::min(low[k], now[k]);
                high[k] = std::max(high[k], now[k]);
            }
        }
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double start = segment.currents(0.0)[k];
            const double end = segment.currents(segment.duration)[k];
            double least = std::min(start, end), most = std::max(start, end);
            for_each_turn(segment, k, [&](double tau) {
                CHECK(tau > 0.0);
                CHECK(tau < segment.duration);
                least = std::min(least, segment.currents(tau)[k]);
                most = std::max(most, segment.currents(tau)[k]);
            });
            // The sums are of at most 16 A in all and round by their last place; where two turns
            // are so near to each other that a look passes over both, the current between them
            // changes by less than 1e-7 of that.
            CHECK(least <= low[k] + 1.6e-6);
            CHECK(most >= high[k] - 1.6e-6);
            // Between two of the dense times, which are 1/200 of an exponential apart, a current
            // can rise by a curve's (1/200)^2 / 8 of 16 A.
            CHECK(least >= low[k] - 5e-5);
            CHECK(most <= high[k] + 5e-5);
        }
    }
}

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

TEST_CASE("the size of a field at one place has its extremes at its ends or where it turns") {
    Random random(12);
    int turns = 0;
    for (int i = 0; i < 2000; ++i) {
        CurrentSegment segment = random_segment(random);
        segment.field = segment.coil;
        FieldCourse course;
        course.segment = &segment;
        // Three coils are the three components; of some fields the middle one is none, and of some
        // there is the first alone, which crosses zero.
        const auto components = static_cast<std::size_t>(random.integer(1, 3));
        for (std::size_t b = 0; b < kMaxBasis; ++b) {
            for (std::size_t c = 0; c < components; ++c) {
                course.basis[b][c] = 1e-3 * segment.coil[b][c];
            }
        }
        const auto square = [&](double tau) {
            const PerCoil now = segment.currents(tau);
            double sum = 0.0;
            for (std::size_t c = 0; c < components; ++c) sum += 1e-6 * now[c] * now[c];
            return sum;
        };
        double low = std::numeric_limits<double>::infinity(), high = 0.0;
        for (const double tau : dense_times(segment, 2000)) {
            low = std::min(low, square(tau));
            high = std::max(high, square(tau));
        }
        double least = std::min(square(0.0), square(segment.duration));
        double most = std::max(square(0.0), square(segment.duration));
        for_each_field_turn(course, 0.0, [&](const FieldTurn& turn, double size, double size_most) {
            ++turns;
            const auto always = [](double) { return true; };
            const auto negative = [&](double t) { return -square(t); };
            double down, up;
            if (turn.curve != 0.0) {
                CHECK(turn.at > -1e-3 * segment.duration);
                CHECK(turn.at < 1.001 * segment.duration);
                // A step that is short beside the time in which the fastest exponential fades.
                const double fastest = *std::max_element(
                    segment.rate.begin(), segment.rate.begin() + segment.exponentials);
                const double begin = std::max(turn.at - 0.05 / fastest, 0.0);
                const double end = std::min(turn.at + 0.05 / fastest, segment.duration);
                const double curve = std::abs(turn.curve);
                down = up = square(std::clamp(turn.at, begin, end));
                if (turn.curve > 0.0) {
                    down = least_value_near(turn.at, curve, begin, end, square, always).value;
                } else {
                    up = -least_value_near(turn.at, curve, begin, end, negative, always).value;
                }
            } else {
                CHECK(turn.from >= 0.0);
                CHECK(turn.to <= segment.duration);
                down = least_value(turn.from, turn.to, 1, square, always).value;
                up = -least_value(turn.from, turn.to, 1, negative, always).value;
            }
            // The bounds are those of a cubic.
            CHECK(size * size <= down + 1e-3 * high);
            CHECK(size_most * size_most >= up - 1e-3 * high);
            least = std::min(least, down);
            most = std::max(most, up);
        });
        const double largest = std::sqrt(high);
        CHECK(std::sqrt(least) <= std::sqrt(low) + 1e-6 * largest);
        CHECK(std::sqrt(most) >= std::sqrt(high) - 1e-6 * largest);
        CHECK(std::sqrt(most) <= std::sqrt(high) + 1e-4 * largest);
    }
    CHECK(turns > 1000);
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
        CHECK(turn.curve == 0.0);
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
        if (at < 0.0) continue;
        const auto always = [](double) { return true; };
        const double curve = random.between(0.9, 1.1) * wave * wave;
        const double near = at + random.between(-0.1, 0.1);
        const Extreme other = least_value_near(near, curve, 0.0, 1.0, f, always);
        if (at > 1.02) {
            CHECK(other.at > 1.0);
        } else if (at < 1.0 && other.at <= 1.0) {
            CHECK(other.value <= expected + 1e-10);
        }
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
