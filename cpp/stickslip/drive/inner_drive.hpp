#pragma once

#include <memory>
#include <vector>

#include "stickslip/drive/shake.hpp"

namespace stickslip {

/// The force that drives a mass within the body: a sum of sines, pulses, or rows over one period,
/// linear in between, that are played again and again.
struct InnerDrive {
    struct Row {
        double time = 0.0;   ///< s
        double force = 0.0;  ///< N
    };

    double amplitude = 0.0;    ///< N
    double frequency = 100.0;  ///< Hz
    double phase = 0.0;        ///< rad
    ShakeParameters::Harmonics harmonics = {};
    double duty = 0.0;  ///< part of a period in which the whole amplitude acts; 0: sines
    std::shared_ptr<const std::vector<Row>> rows;  ///< in place of those

    /// Throws std::invalid_argument for rows that cannot be played, see `check_rows`.
    void set_rows(std::vector<Row> given);
    bool absent() const { return amplitude == 0.0 && !rows; }
    double rate() const { return rows ? 1.0 / rows->back().time : frequency; }  ///< Hz
    /// Force at `time`, N, from the piece of the pulses that contains `inside`. Times: s, since the
    /// run began.
    double at(double time, double inside) const;
    /// The first time (s) after another at which it jumps or has a kink.
    double next_jump(double after) const;
    /// Period of the fastest sine, s; infinite without one.
    double shortest_period() const;

private:
    double turns(double time) const;  // of the first sine
};

}  // namespace stickslip
