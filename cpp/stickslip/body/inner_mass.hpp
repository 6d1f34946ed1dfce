#pragma once

#include "stickslip/drive/inner_drive.hpp"

namespace stickslip {

/// Where the inner mass is, beside its place at rest, and how fast it moves in the body.
struct InnerState {
    double place = 0.0;     ///< m
    double velocity = 0.0;  ///< m/s
    int stop = 0;           ///< +1, -1: it presses on the stop ahead or behind

    friend bool operator==(const InnerState&, const InnerState&) = default;
};

/// A mass that moves in the body along a line through its centre: on a spring, with a damper,
/// driven by a force between both, with a stiffer spring at either end of its way.
struct InnerMass {
    double mass = 0.0;             ///< kg, beside that of the body; zero: there is none
    double stiffness = 0.0;        ///< N/m
    double damping = 0.0;          ///< N s/m
    double direction = 0.0;        ///< rad, from the body's x axis, nose-down positive
    double low = 0.0, high = 0.0;  ///< m, places of the stops
    double stop_stiffness = 0.0;   ///< N/m, zero: no stops
    double stop_damping = 0.0;     ///< N s/m
    InnerDrive drive;

    bool absent() const { return mass == 0.0; }
    bool has_stops() const { return stop_stiffness > 0.0; }

    /// N, on the mass along the line; the body has the opposite. Times as of an InnerDrive.
    double force(const InnerState& at, double time, double inside) const {
        double result = drive.at(time, inside) - stiffness * at.place - damping * at.velocity;
        if (at.stop != 0) result -= at.stop * push(at);
        return result;
    }
    /// N, by which the mass presses on its stop; the damper pulls as it leaves.
    double push(const InnerState& at) const {
        const double depth = at.stop > 0 ? at.place - high : low - at.place;
        return stop_stiffness * depth + at.stop * stop_damping * at.velocity;
    }
    /// m, what is left to the stop ahead or behind, or to leaving it.
    double left(const InnerState& at, int stop) const {
        if (!has_stops() || at.stop == -stop) return 1.0;
        if (at.stop == stop) return push(at) / stop_stiffness;
        return stop > 0 ? high - at.place : at.place - low;
    }
};

}  // namespace stickslip
