#pragma once

#include <array>
#include <cstdint>

#include "stickslip/contact/dynamics.hpp"
#include "stickslip/numbers/rows.hpp"

namespace stickslip {

/// Ends a run where a quantity comes to a value. Of a run in one plane neither y nor heading moves.
struct StopCondition {
    enum class Quantity : std::int8_t { time, x, y, z, theta, revolutions, heading };

    Quantity quantity = Quantity::time;
    bool from_below = true;  ///< whether it is met at or above `value`, else at or below
    double value = 0.0;

    /// Distance left to the condition; met at zero or below. sign: of the body's x in the world.
    double distance(double time, double sign, const BodyState& body) const {
        const double reached = at(time, sign, body);
        return from_below ? value - reached : reached - value;
    }

private:
    double at(double time, double sign, const BodyState& body) const {
        switch (quantity) {
            case Quantity::time:
                return time;
            case Quantity::x:
                return sign * body.x;
            case Quantity::y:
                return body.y;
            case Quantity::z:
                return body.z;
            case Quantity::theta:
                return body.theta();
            case Quantity::revolutions:
                return body.theta() / (4.0 * kQuarterTurn);
            case Quantity::heading:
                return body.heading;
        }
        return 0.0;
    }
};

inline constexpr auto kStopQuantities = std::to_array<Word<StopCondition::Quantity>>({
    {StopCondition::Quantity::time, "time", "s"},
    {StopCondition::Quantity::x, "x", "m, centre of mass, world's frame"},
    {StopCondition::Quantity::y, "y", "m, the same"},
    {StopCondition::Quantity::z, "z", "m, the same"},
    {StopCondition::Quantity::theta, "theta", "rad"},
    {StopCondition::Quantity::revolutions, "revolutions", "theta over 2 pi"},
    {StopCondition::Quantity::heading, "heading", "rad, from -pi to pi"},
});
static_assert(in_order(kStopQuantities));

}  // namespace stickslip
