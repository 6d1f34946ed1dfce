#pragma once

#include <vector>

#include "stickslip/scenario.hpp"

/// What the forces of a scenario leave unexplained of a motion that was read off a body on one
/// corner: the equations of motion turned round, with every effect of the model in them.
namespace stickslip {

/// A simulated run at one time, as its recording has it: where the forces are taken.
struct BalancePoint {
    double t = 0.0;            ///< s
    double x = 0.0, z = 0.0;   ///< m, centre of mass, world
    double theta = 0.0;        ///< rad; its lowest corner is the one that touches
    double contact_age = 0.0;  ///< s, since touch-down
    int slip = 1;  ///< the way in which the corner slips, +1 or -1 in the robot's own frame
};

/// A motion as it is read, in the robot's own frame; SI units.
struct CornerMotion {
    double theta, omega, alpha;  ///< tilt and its derivatives
    double vx, ax;               ///< of the centre of mass along the surface
};

struct CornerBalance {
    double torque;  ///< N m, (J + m r^2) alpha less the moment about the corner, if it sticks
    double force;   ///< N, m ax less what acts along the surface, kinetic friction too, if it slips
    double friction_ratio;    ///< friction over normal force, if it sticks
    double contact_velocity;  ///< m/s, of the corner along the surface
};

struct CornerBalances {
    std::vector<CornerBalance> rows;  ///< as the motions
    double torque_scale = 0.0;        ///< N m, largest torque of the field on the simulated body
    double weight = 0.0;              ///< N, with adhesion
};

/// Balances of `motions`, a row of one motion a point, one row after another. The instruments'
/// effects are taken off the readings first. Throws std::invalid_argument for a size that does not
/// fit.
CornerBalances corner_balances(const Scenario& scenario, const std::vector<BalancePoint>& points,
                               const std::vector<CornerMotion>& motions);

}  // namespace stickslip
