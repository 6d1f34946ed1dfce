#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "machines/heat.hpp"
#include "machines/motion.hpp"
#include "machines/path.hpp"

using namespace machines;

namespace {

/// First states at the times.
template <class System>
std::vector<double> followed(const System& system, const typename System::State& start,
                             const std::vector<double>& times,
                             const Signals<System::kInputs>& signals) {
    std::vector<double> result(times.size());
    follow(system, start, times, signals,
           [&](std::size_t n, const auto& z) { result.at(n) = z.back(); });
    return result;
}

}  // namespace

TEST_CASE("machines: a mass rests within a step of a line, and where the line is late") {
    MotionTerms terms;
    terms.coulomb = 3.0;
    const std::array<double, 2> knots = {0.0, 1.0};
    const std::array<double, 3> values = {2.0, 2.0, 4.0};
    const std::vector<double> times = {0.0, 1.0, 2.0};
    // 0.2 - t + t^2 is zero at 0.276 s; the line reaches the friction at half a second.
    const auto now =
        followed(OneMass(terms), {0.0, 0.2}, times, {knots, values.data(), {0.0}, true});
    CHECK(std::abs(now[1] - 0.25) < 1e-12);
    CHECK(std::abs(now[2] - 1.25) < 1e-12);
    const auto late =
        followed(OneMass(terms), {0.0, 0.2}, times, {knots, values.data(), {0.25}, true});
    CHECK(std::abs(late[1] - 0.0625) < 1e-12);
    CHECK(std::abs(late[2] - 1.0) < 1e-12);
}

TEST_CASE("machines: two inputs of a heater act late, each by its own time") {
    const HeatTerms terms = {2.0, 0.5, 0.0, 0.0, 0.0};
    const std::array<double, 2> knots = {0.0, 1.0};
    const std::array<double, 6> values = {0.0, 0.0, 3.0, 0.0, 3.0, 4.0};
    const std::vector<double> times = {0.0, 1.0, 2.0, 3.0};
    const double start = 0.0;
    std::array<double, 4> held = {};
    Heat::write(terms, &start, times, {knots, values.data(), {0.5, 1.25}, false}, held.data());
    const auto rise = [](double time) { return 1.0 - std::exp(-0.25 * std::fmax(time, 0.0)); };
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double expected = 6.0 * rise(times[k] - 0.5) + 4.0 * rise(times[k] - 2.25);
        CHECK(std::abs(held[k] - expected) < 1e-12);
    }
}

TEST_CASE("machines: a body whose loss grows is exact, with a heater that holds next to nothing") {
    HeatTerms terms = {100.0, 1.2, 0.02};
    const double power = 60.0, start = 293.0, root = std::sqrt(1.2 * 1.2 + 4.0 * 0.02 * power);
    const std::array<double, 1> knots = {0.0};
    const std::array<double, 4> values = {power, start, power, start};
    const std::vector<double> times = {0.0, 0.1, 10.0, 40.0, 1000.0};
    for (const double heater : {0.0, 1e-9}) {
        terms.heater = heater;
        terms.coupling = 1e3;
        std::array<double, 5> body = {};
        Heat::write(terms, &start, times, {knots, values.data(), {}, false}, body.data());
        for (std::size_t k = 1; k < times.size(); ++k) {
            // C y' = P - L y - G y^2 from y = 0.
            const double rise = std::tanh(root * times[k] / (2.0 * terms.capacity));
            const double over = 2.0 * power * rise / (root + 1.2 * rise);
            CHECK(std::abs(body.at(k) - start - over) < 1e-8);
        }
    }
}
