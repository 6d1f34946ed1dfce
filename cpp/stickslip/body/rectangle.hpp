#pragma once

#include <cmath>
#include <numbers>

namespace stickslip {

inline constexpr double kQuarterTurn = std::numbers::pi / 2;

/// Pose of the body: its pivot corner lies at (+lever_arm, -height) from the centre of mass.
template <class Real>
struct PoseOf {
    Real cosine = 1.0;  ///< cos of the local angle
    Real sine = 0.0;
    Real lever_arm = 0.0;  ///< m, horizontal distance from the centre of mass to the pivot, signed
    Real height = 0.0;     ///< m, height of the centre of mass above the pivot
    // Zero where the pivot is the rectangle's corner; see ContactPlace.
    Real rolled_distance = 0.0;   ///< m, of the pivot from the point that stays while it sticks
    Real curvature_radius = 0.0;  ///< m, radius of curvature of what touches
    Real angle = 0.0;             ///< rad, within the quadrant

    /// Distance from the centre of mass along the surface to the point that stays where it is while
    /// the pivot sticks, m, ahead positive.
    [[gnu::always_inline]] Real place() const { return lever_arm - rolled_distance; }
};
using Pose = PoseOf<double>;

/// The robot's side view as a rectangle on the plane z = 0.
///
/// A full turn has four quadrants. In quadrant q the angle is theta = q pi/2 + local, with local in
/// [0, pi/2], and the lowest corner is q (mod 4): 0 front bottom, 1 front top, 2 rear top, 3 rear
/// bottom. Quadrants make tumbling the same problem four times, with length and height exchanged in
/// the odd ones, and put every face that can land at local = 0 or pi/2, exactly. In quadrant 0 the
/// pivot is the paper's (P_x, P_z), Eqs. (13)-(14), with lever_arm = r cos(theta + phi) and height
/// = r sin(theta + phi).
class Rectangle {
public:
    /// length along the moment and height, in m.
    Rectangle(double length, double height)
        : half_length_(0.5 * length),
          half_height_(0.5 * height),
          radius_(0.5 * std::hypot(length, height)) {}

    double half_base(int quadrant) const { return (quadrant & 1) ? half_height_ : half_length_; }
    double half_rise(int quadrant) const { return (quadrant & 1) ? half_length_ : half_height_; }
    double radius() const { return radius_; }

    Pose pose(int quadrant, double cosine, double sine) const {
        const double base = half_base(quadrant);
        const double rise = half_rise(quadrant);
        return {cosine, sine, base * cosine - rise * sine, base * sine + rise * cosine};
    }

private:
    double half_length_, half_height_, radius_;
};

/// A quadrant's turn as exact cosine and sine.
struct QuarterTurns {
    double cosine, sine;
    explicit QuarterTurns(int quadrant) {
        constexpr double table[4] = {1.0, 0.0, -1.0, 0.0};
        cosine = table[quadrant & 3];
        sine = table[(quadrant + 3) & 3];
    }
};

}  // namespace stickslip
