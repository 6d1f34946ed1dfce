#pragma once

#include <cstdint>

#include "stickslip/contact/dynamics.hpp"

namespace stickslip {

/// Ends a run where a quantity comes to a value: time (s), x, y or z (m, centre of mass, world's
/// frame), theta (rad), turns (theta over 2 pi) or heading (rad, from -pi to pi). A run in one
/// plane has y and heading zero throughout.
struct StopCondition {
    enum class Quantity : std::int8_t { time, x, y, z, theta, turns, heading };

    Quantity quantity = Quantity::time;
    bool from_below = true;  ///< whether it is met at or above `value`, else at or below
    double value = 0.0;

    /// What is left to go; met at zero or below. sign: of the body's x in the world.
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
            case Quantity::turns:
                return body.theta() / (4.0 * kQuarterTurn);
            case Quantity::heading:
                return body.heading;
        }
        return 0.0;
    }
};

}  // namespace stickslip
