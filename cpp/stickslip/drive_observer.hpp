#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/circuit.hpp"
#include "stickslip/dynamics.hpp"
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
    explicit DriveObserver(const CoilSet& coils, const Circuit& circuit)
        : coils_(&coils), resistance_(circuit.resistance()) {}

    /// A stretch that has ended with the robot at `body`, in its own frame.
    void stretch(const VoltageSegment& voltages, const CurrentSegment& segment,
                 const Dynamics& dynamics, const BodyState& body, bool in_window) {
        leaves_plane_ = false;
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            voltage_max_ =
                std::max({voltage_max_, std::abs(voltages.first[k]), std::abs(voltages.last[k])});
        }
        look(segment.duration, segment, dynamics, body, in_window);
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double turn = turning_point(segment, k);
            if (turn > 0.0 && turn < segment.duration) {
                look(turn, segment, dynamics, body, in_window);
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

    /// Whether a field across the plane is driven at all. gain: as of a LocalField.
    bool drives_across(const PerCoil& gain) const {
        return std::any_of(kAllCoils.begin(), kAllCoils.end(), [&](Coil coil) {
            return gain[static_cast<std::size_t>(coil)] != 0.0 && has_field_across(*coils_, coil);
        });
    }
    /// Whether the field of the last stretch would have turned the robot out of the plane.
    bool leaves_plane() const { return leaves_plane_; }

private:
    // A robot's heading follows the horizontal field: within 5 % is within 3 degrees.
    static constexpr double kMostAcross = 0.05;
    // T; spin friction of an edge, 3e-12 N m, over the moment of Table II: less turns nothing.
    static constexpr double kLeastAcross = 2e-6;

    // Where the current of a coil with one exponential turns, s from the start of the stretch.
    static double turning_point(const CurrentSegment& segment, std::size_t coil) {
        const double slope = segment.coil[1][coil], rate = segment.rate[0];
        const double ratio = segment.coil[2][coil] * rate / slope;
        return ratio > 0.0 && std::isfinite(ratio) ? std::log(ratio) / rate : 0.0;
    }

    void look(double tau, const CurrentSegment& segment, const Dynamics& dynamics,
              const BodyState& body, bool in_window) {
        const PerCoil currents = segment.currents(tau);
        for (const double current : currents) {
            current_max_ = std::max(current_max_, std::abs(current));
        }
        const PlanarField planar = dynamics.field_at(tau)(body.x, body.z);
        const LocalField& field = dynamics.field();
        const double across =
            field.factor(tau) *
            field_across(*coils_, field.gain(), segment.field_currents(tau), body.x, body.z);
        const double size =
            std::sqrt(planar.bx * planar.bx + planar.bz * planar.bz + across * across);
        field_max_ = std::max(field_max_, size);
        if (in_window) field_min_ = std::min(field_min_, size);
        leaves_plane_ =
            leaves_plane_ || (std::abs(across) > kLeastAcross &&
                              std::abs(across) > kMostAcross * std::hypot(planar.bx, across));
    }

    const CoilSet* coils_;
    PerCoil resistance_;  // ohm
    double voltage_max_ = 0.0, current_max_ = 0.0, field_max_ = 0.0;
    double field_min_ = std::numeric_limits<double>::infinity();
    double energy_ = 0.0;  // J
    bool leaves_plane_ = false;
};

}  // namespace stickslip
