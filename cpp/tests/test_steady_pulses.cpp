#include <doctest/doctest.h>

#include <cmath>

#include "stickslip/steady_pulses.hpp"

using namespace stickslip;

namespace {

constexpr double kPeriod = 0.02, kStart = 0.05;

/// Plays pulses of which number k moves the robot by `displacement(k)` until the rest of them is
/// extrapolated. Returns the number that was played and the displacement over the window.
struct Played {
    int pulses = 0;
    double displacement = 0.0;
};
template <class Displacement>
Played play(int count, int first, double error, Displacement displacement) {
    SteadyPulses pulses(kStart, kPeriod, static_cast<std::size_t>(first),
                        static_cast<std::size_t>(count), error);
    double x = 1e-3, window = 0.0;
    pulses.pass(kStart, x);
    for (int k = 1; k <= count; ++k) {
        // A stretch that ends within the pulse says nothing.
        pulses.pass(kStart + (k - 0.5) * kPeriod, x + 1.0);
        x += displacement(k);
        if (k > first) window += displacement(k);
        pulses.pass(kStart + k * kPeriod, x);
        if (const auto found = pulses.displacement()) return {k, *found};
    }
    return {count, window};
}

}  // namespace

TEST_CASE("steady pulses: a displacement that grows by the same each pulse is continued exactly") {
    const auto displacement = [](int k) { return 1e-5 + 1e-9 * k; };
    double whole = 0.0;
    for (int k = 4; k <= 40; ++k) whole += displacement(k);
    // No more pulses are extrapolated than were played; the trend adds 0.2e-6 m to them.
    const Played played = play(40, 3, 1e-6, displacement);
    CHECK(played.pulses == 20);
    CHECK(played.displacement == doctest::Approx(whole).epsilon(1e-12));
}

TEST_CASE("steady pulses: what is extrapolated of a start-up that decays is within the error") {
    for (const double ratio : {0.3, 0.6, 0.9}) {
        for (const double error : {1e-5, 1e-7}) {
            const auto displacement = [&](int k) {
                return 2e-5 * (1.0 - 0.5 * std::pow(ratio, k));
            };
            double whole = 0.0;
            for (int k = 4; k <= 60; ++k) whole += displacement(k);
            const Played played = play(60, 3, error, displacement);
            CHECK(std::abs(played.displacement - whole) <= error * 57 * kPeriod);
        }
    }
}

TEST_CASE("steady pulses: a motion of twice the period is not continued from one pulse") {
    const auto displacement = [](int k) { return k % 2 == 0 ? 1.2e-5 : 0.8e-5; };
    const Played played = play(8, 3, 1e-6, displacement);
    // From the seventh on blocks of two pulses are compared, which are equal; one pulse is left.
    CHECK(played.pulses >= 7);
}

TEST_CASE("steady pulses: without an allowed error all pulses are played") {
    CHECK(play(20, 3, 0.0, [](int) { return 1e-5; }).pulses == 20);
}
