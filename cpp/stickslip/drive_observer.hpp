#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/circuit.hpp"
#include "stickslip/summary.hpp"
#include "stickslip/voltage_program.hpp"

namespace stickslip {

/// Gathers what the coils do, stretch by stretch: largest voltage, current and field of a run, and
/// over the measuring window the least field and the power.
///
/// Within a stretch the currents are smooth, so that their extremes are at its end or where a
/// current turns. The field is looked at there too, at the robot's place at the end of the stretch:
/// what it moves within a stretch changes the field by 0.1 mT a mm.
class DriveObserver {
public:
    explicit DriveObserver(const Circuit& circuit) : resistance_(circuit.resistance()) {}

    /// A stretch that has ended. field_at(tau): the field's size where the robot is now, T.
    void stretch(const VoltageSegment& voltages, const CurrentSegment& segment, auto&& field_at,
                 bool in_window) {
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            voltage_max_ =
                std::max({voltage_max_, std::abs(voltages.first[k]), std::abs(voltages.last[k])});
        }
        look(segment.duration, segment, field_at, in_window);
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double turn = turning_point(segment, k);
            if (turn > 0.0 && turn < segment.duration) {
                look(turn, segment, field_at, in_window);
            }
        }
        if (!in_window) return;
        const PerCoil squares = squared_integrals(segment);
        for (std::size_t k = 0; k < kCoilCount; ++k) energy_ += resistance_[k] * squares[k];
    }

    /// span: s, of the measuring window.
    void close(double span, Summary& summary) const {
        summary.field_min = field_min_;
        summary.power_mean = energy_ / span;
    }
    void write(Summary& summary) const {
        summary.field_max = field_max_;
        summary.current_max = current_max_;
        summary.voltage_max = voltage_max_;
    }

private:
    // Where the current of a coil with one exponential turns, s from the start of the stretch.
    static double turning_point(const CurrentSegment& segment, std::size_t coil) {
        const double slope = segment.coil[1][coil], rate = segment.rate[0];
        const double ratio = segment.coil[2][coil] * rate / slope;
        return ratio > 0.0 && std::isfinite(ratio) ? std::log(ratio) / rate : 0.0;
    }

    void look(double tau, const CurrentSegment& segment, auto&& field_at, bool in_window) {
        for (const double current : segment.currents(tau)) {
            current_max_ = std::max(current_max_, std::abs(current));
        }
        const double size = field_at(tau);
        field_max_ = std::max(field_max_, size);
        if (in_window) field_min_ = std::min(field_min_, size);
    }

    PerCoil resistance_;  // ohm
    double voltage_max_ = 0.0, current_max_ = 0.0, field_max_ = 0.0;
    double field_min_ = std::numeric_limits<double>::infinity();
    double energy_ = 0.0;  // J
};

}  // namespace stickslip
