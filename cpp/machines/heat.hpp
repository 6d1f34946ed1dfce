#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "machines/path.hpp"

namespace machines {

/// Heat stores: a body, and beside it perhaps its heater and a wall. Inputs: power (W) and the
/// temperature around (K). See Path.
struct HeatTerms {
    double capacity = 1.0;                ///< J/K
    double loss = 0.0, growth = 0.0;      ///< W/K, and its growth, W/K^2
    double heater = 0.0, coupling = 0.0;  ///< J/K, W/K; no heater of its own at 0
    double wall = 0.0, to_wall = 0.0;     ///< J/K, W/K; no wall at 0
};

inline constexpr std::array<Named<HeatTerms>, 7> kHeatTerms = {{
    {"capacity", &HeatTerms::capacity},
    {"loss", &HeatTerms::loss},
    {"loss_growth", &HeatTerms::growth},
    {"heater_capacity", &HeatTerms::heater},
    {"coupling", &HeatTerms::coupling},
    {"wall_capacity", &HeatTerms::wall},
    {"wall_coupling", &HeatTerms::to_wall},
}};

template <bool kHeater, bool kWall>
class HeatStores {
public:
    static constexpr std::size_t kStates = 1 + kHeater + kWall, kInputs = 2, kPhases = 0;
    using State = std::array<double, kStates>;
    using Input = std::array<double, kInputs>;
    using Mode = std::array<int, kPhases>;
    using Point = std::pair<State, Mode>;

    explicit HeatStores(const HeatTerms& terms)
        : linear(terms.growth == 0.0), fastest(terms.loss / terms.capacity), c(terms) {
        if constexpr (kHeater) fastest += c.coupling * (1.0 / c.capacity + 1.0 / c.heater);
        if constexpr (kWall) fastest += c.to_wall * (1.0 / c.capacity + 1.0 / c.wall);
    }

    bool linear;
    double fastest;

    double fastest_at(const State& z, const Input& u, const Mode&) const {
        return fastest + 2.0 * std::abs(c.growth * (z[0] - u[1])) / c.capacity;
    }

    State rate(const State& z, const Input& u, const Mode&) const {
        const double over = z[0] - u[1], lost = (c.loss + c.growth * std::abs(over)) * over;
        State rates{};
        double flow = u[0];
        if constexpr (kHeater) {
            flow = c.coupling * (z[1] - z[0]);
            rates[1] = (u[0] - flow) / c.heater;
        }
        if constexpr (kWall) {
            const double back = c.to_wall * (z[kStates - 1] - z[0]);
            rates[kStates - 1] = -back / c.wall;
            flow += back;
        }
        rates[0] = (flow - lost) / c.capacity;
        return rates;
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
        const double begin = *start;
        if (c.heater > 0.0 && c.wall > 0.0) {
            follow(HeatStores<true, true>(c), {begin, begin, begin}, t, acting, body);
        } else if (c.heater > 0.0) {
            follow(HeatStores<true, false>(c), {begin, begin}, t, acting, body);
        } else if (c.wall > 0.0) {
            follow(HeatStores<false, true>(c), {begin, begin}, t, acting, body);
        } else {
            follow(HeatStores<false, false>(c), {begin}, t, acting, body);
        }
    }
};

}  // namespace machines
