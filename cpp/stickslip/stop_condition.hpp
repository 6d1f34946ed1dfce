#pragma once

#include <cstdint>

#include "stickslip/rectangle.hpp"

namespace stickslip {

/// Ends a run where a quantity comes to a value: time (s), x or z (m, centre of mass, world's
/// frame), theta (rad) or turns (theta over 2 pi).
struct StopCondition {
    enum class Quantity : std::int8_t { time, x, z, theta, turns };

    Quantity quantity = Quantity::time;
    bool from_below = true;  ///< whether it is met at or above `value`, else at or below
    double value = 0.0;

    /// What is left to go; met at zero or below.
    double distance(double time, double x, double z, double theta) const {
        const double reached = at(time, x, z, theta);
        return from_below ? value - reached : reached - value;
    }

private:
    double at(double time, double x, double z, double theta) const {
        switch (quantity) {
            case Quantity::time:
                return time;
            case Quantity::x:
                return x;
            case Quantity::z:
                return z;
            case Quantity::theta:
                return theta;
            case Quantity::turns:
                return theta / (4.0 * kQuarterTurn);
        }
        return 0.0;
    }
};

}  // namespace stickslip
