#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "stickslip/numbers/number_text.hpp"

using namespace stickslip;

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
