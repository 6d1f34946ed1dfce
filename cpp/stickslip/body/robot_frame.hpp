#pragma once

#include "stickslip/drive/coil.hpp"

namespace stickslip {

/// How a robot moves and faces: decided once for a scenario, by `frame_of`.
struct RobotFrame {
    /// Whether it moves in the whole plane of the surface, and not along x alone: something turns
    /// it, or pushes it across.
    bool whole_plane = false;
    /// World x = sign times the robot's x: -1 for a robot that is turned to face -x and stays in
    /// the plane y = 0.
    double sign = 1.0;

    /// Voltages, currents or a program of the world as the robot sees them.
    template <class T>
    T to_robot(const T& of_world) const {
        return sign > 0.0 ? of_world : turned(of_world);
    }
    /// The inverse, from the robot to the world: half a turn is undone by another.
    template <class T>
    T to_world(const T& of_robot) const {
        return to_robot(of_robot);
    }
};

}  // namespace stickslip
