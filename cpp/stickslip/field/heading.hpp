#pragma once

#include <cmath>

namespace stickslip {

/// A vector in the surface: along the heading and to its left.
struct Slip {
    double along = 0.0, across = 0.0;

    double size() const { return std::sqrt(along * along + across * across); }
};

/// The way that a robot faces.
struct Heading {
    double cosine = 1.0, sine = 0.0;

    static Heading of_angle(double angle) { return {std::cos(angle), std::sin(angle)}; }
    double angle() const { return std::atan2(sine, cosine); }
    /// Angle to another heading, rad, positive to the left.
    double angle_to(const Heading& other) const {
        const Slip turn = seen(other.cosine, other.sine);
        return std::atan2(turn.across, turn.along);
    }
    /// Components of a world vector along and across the heading; `x` and `y` invert it.
    Slip seen(double x, double y) const { return {cosine * x + sine * y, cosine * y - sine * x}; }
    double x(const Slip& v) const { return cosine * v.along - sine * v.across; }
    double y(const Slip& v) const { return sine * v.along + cosine * v.across; }
};

}  // namespace stickslip
