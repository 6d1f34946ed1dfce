#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/number_text.hpp"
#include "stickslip/numbers/pack.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

using Two = Pack<2>;

Two pack(double a, double b) {
    Two result;
    result.v[0] = a;
    result.v[1] = b;
    return result;
}

}  // namespace

TEST_CASE("pack: the exponential is within two units in the last place") {
    Random random(1);
    for (int n = 0; n < 20000; ++n) {
        const double a = -std::pow(10.0, random.between(-12.0, 2.84));
        // The C library's value has half a unit of its own.
        CHECK(std::abs(exponential(a) / std::exp(a) - 1.0) < 2.5 * kRounding);
    }
    CHECK(exponential(0.0) == 1.0);
    CHECK(exponential(-1e9) < 1e-307);  // as good as nothing
    CHECK(exponential(-1e9) >= 0.0);
}

TEST_CASE("pack: logarithm and sine are those of the C library but for rounding") {
    Random random(4);
    for (int n = 0; n < 20000; ++n) {
        const double a = std::pow(10.0, random.between(-300.0, 300.0));
        const double near = 1.0 + std::pow(10.0, random.between(-15.0, 0.0));
        // Two units in the last place, and half a unit of the C library's value.
        for (const double x : {a, near}) {
            const double allowed = std::max(2.5 * std::abs(std::log(x)), 1.0) * kRounding;
            CHECK(std::abs(logarithm(x) - std::log(x)) < allowed);
        }
        const double b = random.between(-1.0, 1.0) * std::pow(10.0, random.between(-3.0, 6.4));
        CHECK(std::abs(sine(b) - std::sin(b)) < 2.0 * kRounding);
    }
    CHECK(logarithm(1.0) == 0.0);
    CHECK(sine(0.0) == 0.0);
}

TEST_CASE("pack: cosine and sine are right to rounding, near zero and far from it") {
    for (int n = -1000; n <= 1000; ++n) {
        const double a = n == 1000 ? 1e6 : 2e-3 * n;
        const CosineAndSine<double> at = cosine_and_sine(a);
        const double allowed = 2.5e-16 + (std::abs(a) > 0.888 ? std::abs(a) * kRounding : 0.0);
        CHECK(std::abs(at.cosine - std::cos(a)) < allowed);
        CHECK(std::abs(at.sine - std::sin(a)) < allowed);
    }
    CHECK(std::isnan(cosine_and_sine(std::nan("")).sine));
}

TEST_CASE("pack: the rough logarithm and power are good enough for the width of a step") {
    Random random(2);
    for (int n = 0; n < 20000; ++n) {
        const double a = std::pow(10.0, random.between(-300.0, 300.0));
        CHECK(std::abs(rough_log2(a) - std::log2(a)) < 0.05);
        const double b = random.between(-900.0, 900.0);
        CHECK(std::abs(rough_exp2(b) / std::exp2(b) - 1.0) < 1e-2);
    }
}

TEST_CASE("pack: each member has the bits of the double") {
    Random random(3);
    const auto same = [](double a, double b) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    };
    for (int n = 0; n < 2000; ++n) {
        const std::array<double, 2> a = {random.between(-2.0, 0.0), random.between(-2.0, 2.0)};
        const std::array<double, 2> b = {random.between(-2.0, 2.0), random.between(-2.0, 2.0)};
        const Two p = pack(a[0], a[1]), q = pack(b[0], b[1]);
        for (int i = 0; i < 2; ++i) {
            const auto u = static_cast<std::size_t>(i);
            CHECK(same((p * q + p / q - 0.3 * p).v[i], a[u] * b[u] + a[u] / b[u] - 0.3 * a[u]));
            CHECK(same(magnitude(p).v[i], std::abs(a[u])));
            CHECK(same(lesser(p, q).v[i], std::min(a[u], b[u])));
            CHECK(same(greater(p, q).v[i], std::max(a[u], b[u])));
            CHECK(same(exponential(-magnitude(p)).v[i], exponential(-std::abs(a[u]))));
            CHECK(same(logarithm(magnitude(p)).v[i], logarithm(std::abs(a[u]))));
            CHECK(same(sine(40.0 * q).v[i], sine(40.0 * b[u])));
            CHECK(same(cosine_and_sine(q).cosine.v[i], cosine_and_sine(b[u]).cosine));
            CHECK(same(cosine_and_sine(q).sine.v[i], cosine_and_sine(b[u]).sine));
            CHECK(same(root(magnitude(q)).v[i], std::sqrt(std::abs(b[u]))));
            CHECK(same(rough_log2(magnitude(p)).v[i], rough_log2(std::abs(a[u]))));
            CHECK(same(rough_exp2(q).v[i], rough_exp2(b[u])));
            CHECK(((members(p < q) >> i & 1u) == 1u) == (a[u] < b[u]));
        }
    }
}

TEST_CASE("pack: a comparison with what is no number holds for none") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(members(pack(nan, 1.0) <= pack(1.0, 1.0)) == 0b10u);
    CHECK(members(!(pack(nan, 1.0) <= pack(1.0, 1.0))) == 0b01u);
    CHECK(!any(pack(nan, nan) < pack(1.0, 1.0)));
}

TEST_CASE("numbers have the same text without a floating std::to_chars") {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> exponent(-30.0, 30.0);
    const auto check = [](double value) {
        CHECK(by_printf::digits(value) == digits(value));
        CHECK(by_printf::rounded(value) == rounded(value));
    };
    for (int i = 0; i < 2000; ++i) {
        const double value = std::pow(10.0, exponent(random));
        check(value);
        check(-value);
        check(std::floor(value));
        check(static_cast<double>(random() % 100000) * 1e-6);
    }
    constexpr double kMost = std::numeric_limits<double>::max();
    for (const double value : {0.0, -0.0, 1e-4, 1e5, 123456789012345678.0, kMost, -kMost, HUGE_VAL,
                               -HUGE_VAL, std::numeric_limits<double>::denorm_min()}) {
        check(value);
    }
}
