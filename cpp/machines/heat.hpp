#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "machines/path.hpp"

namespace machines {

/// Heat stores: a body, and with a second one its heater. Inputs: power (W) and the temperature
/// around (K). See Path.
struct HeatTerms {
    double capacity = 1.0;                ///< J/K
    double loss = 0.0, growth = 0.0;      ///< W/K, and its growth, W/K^2
    double heater = 0.0, coupling = 0.0;  ///< J/K, W/K; no heater of its own at 0
};

inline constexpr std::array<Named<HeatTerms>, 5> kHeatTerms = {{
    {"capacity", &HeatTerms::capacity},
    {"loss", &HeatTerms::loss},
    {"loss_growth", &HeatTerms::growth},
    {"heater_capacity", &HeatTerms::heater},
    {"coupling", &HeatTerms::coupling},
}};

template <std::size_t N>
class HeatStores {
public:
    static constexpr std::size_t kStates = N, kInputs = 2, kPhases = 0;
    using State = std::array<double, kStates>;
    using Input = std::array<double, kInputs>;
    using Mode = std::array<int, kPhases>;
    using Point = std::pair<State, Mode>;

    explicit HeatStores(const HeatTerms& terms)
        : linear(terms.growth == 0.0), fastest(terms.loss / terms.capacity), c(terms) {
        if constexpr (N == 2) fastest += c.coupling * (1.0 / c.capacity + 1.0 / c.heater);
    }

    bool linear;
    double fastest;

    double fastest_at(const State& z, const Input& u, const Mode&) const {
        return fastest + 2.0 * std::abs(c.growth * (z[0] - u[1])) / c.capacity;
    }

    State rate(const State& z, const Input& u, const Mode&) const {
        const double over = z[0] - u[1], lost = (c.loss + c.growth * std::abs(over)) * over;
        if constexpr (N == 1) {
            return {(u[0] - lost) / c.capacity};
        } else {
            const double flow = c.coupling * (z[1] - z[0]);
            return {(flow - lost) / c.capacity, (u[0] - flow) / c.heater};
        }
    }
    std::array<double, 1> margins(const State&, const Input&, const Mode&) const {
        return {std::numeric_limits<double>::infinity()};
    }
    std::array<double, 0> falls(const State&, const Input&, const Input&, const Mode&) const {
        return {};
    }
    Point begun(const State& z, const Input&) const { return {z, {}}; }
    Point driven(const State& z, const Input&, const Mode&) const { return {z, {}}; }
    Point after(const State& z, const Input&, const Mode&, std::size_t) const { return {z, {}}; }

private:
    HeatTerms c;
};

/// The temperature of the body.
struct Heat {
    using Terms = HeatTerms;
    static constexpr const auto& kTerms = kHeatTerms;
    static constexpr std::size_t kStates = 1, kInputs = 2, kStarts = 1;

    static void write(const Terms& c, const double* start, std::span<const double> t,
                      const Signals<kInputs>& acting, double* out) {
        const auto body = [&](std::size_t n, const auto& z) { out[n] = z[0]; };
        if (c.heater > 0.0) {
            follow(HeatStores<2>(c), {*start, *start}, t, acting, body);
        } else {
            follow(HeatStores<1>(c), {*start}, t, acting, body);
        }
    }
};

}  // namespace machines
