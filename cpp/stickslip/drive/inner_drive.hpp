#pragma once

#include <array>

#include "stickslip/drive/shake.hpp"

namespace stickslip {

/// The force that drives a mass within the body: a sum of sines, or pulses.
struct InnerDrive {
    double amplitude = 0.0;    ///< N
    double frequency = 100.0;  ///< Hz
    double phase = 0.0;        ///< rad
    ShakeParameters::Harmonics harmonics = {};
    double duty = 0.0;  ///< part of a period in which the whole amplitude acts; 0: sines

    /// N, by the piece of the pulses that has another time, `inside`, in it. Times: s, since the
    /// run began.
    double at(double time, double inside) const;
    /// The first time (s) after another at which it jumps.
    double next_jump(double after) const;
    /// Of its fastest sine, s; infinite of none.
    double shortest_period() const;

private:
    double turns(double time) const;  // of the first sine
};

}  // namespace stickslip
