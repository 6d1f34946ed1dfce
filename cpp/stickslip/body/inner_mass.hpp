#pragma once

#include "stickslip/drive/inner_drive.hpp"

namespace stickslip {

/// Place of the inner mass in the body, from where its spring is slack, and its velocity.
struct InnerState {
    double place = 0.0;     ///< m
    double velocity = 0.0;  ///< m/s
    int stop = 0;           ///< +1, -1: it rests on the stop ahead or behind

    friend bool operator==(const InnerState&, const InnerState&) = default;
};

/// A mass that moves in the body along a line through its centre: on a spring, with a damper,
/// driven by a force between both, with a stop at either end of its way.
struct InnerMass {
    double mass = 0.0;              ///< kg, beside that of the body; zero: there is none
    double stiffness = 0.0;         ///< N/m
    double damping = 0.0;           ///< N s/m
    double direction = 0.0;         ///< rad, from the body's x axis, nose-down positive
    double low = -1.0, high = 1.0;  ///< m, places of the stops
    double restitution = 0.0;       ///< Newton's, of an impact on them
    InnerDrive drive;

    bool absent() const { return mass == 0.0; }
    /// Mass ratio to the sum of both masses.
    double share(double body) const { return mass / (mass + body); }

    /// Force on the mass along the line, N, without the stops; the opposite acts on the body.
    /// Times as of an InnerDrive.
    double force(const InnerState& at, double time, double inside) const {
        return drive.at(time, inside) - stiffness * at.place - damping * at.velocity;
    }
    double place(int stop) const { return stop > 0 ? high : low; }  ///< m, of a stop
    /// Distance from the mass to the stop ahead or behind, m.
    double left(const InnerState& at, int stop) const { return stop * (place(stop) - at.place); }
};

}  // namespace stickslip
