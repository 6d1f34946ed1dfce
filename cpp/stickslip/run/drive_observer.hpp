#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "stickslip/drive/circuit.hpp"
#include "stickslip/drive/voltage_program.hpp"
#include "stickslip/field/expansion.hpp"
#include "stickslip/field/turning_points.hpp"
#include "stickslip/run/summary.hpp"

namespace stickslip {

/// Gathers what the coils do: largest voltage, current and field of a run, and over the measuring
/// window the least field and the power. Voltages and currents are those of whole segments; the
/// field is that at the moving robot, so the caller passes its extremes to `see_field`.
class DriveObserver {
public:
    explicit DriveObserver(const Circuit& circuit) : resistance_(circuit.resistance()) {}

    /// Adds a segment that has ended.
    void end_segment(const VoltageSegment& voltages, const CurrentSegment& segment,
                     bool in_window) {
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            for (const double volts : {voltages.first[k], voltages.last[k]}) {
                if (std::abs(volts) > std::abs(voltage_[k])) voltage_[k] = volts;
            }
        }
        const auto see = [this](double current) {
            current_max_ = std::max(current_max_, std::abs(current));
        };
        for (const double current : segment.currents(0.0)) see(current);
        for (const double current : segment.currents(segment.duration)) see(current);
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            for_each_turn(segment, k, [&](double tau) { see(segment.currents(tau)[k]); });
        }
        if (!in_window) return;
        const PerCoil squares = squared_integrals(segment);
        for (std::size_t k = 0; k < kCoilCount; ++k) energy_ += resistance_[k] * squares[k];
    }

    /// The pull of the in-plane coils in a segment that has ended, as they are where it ends.
    /// factor(tau): what a free shape makes of the field.
    void pull(const PerCoilOf<CoilField>& coils, const CurrentSegment& segment, auto&& factor) {
        std::array<CurrentFunctions::Values, 2> slope = {};  // T/m
        for (std::size_t b = 0; b < segment.count(); ++b) {
            for (std::size_t k = 0; k < kClampCoil; ++k) {
                for (std::size_t i = 0; i < 2; ++i) {
                    slope[i][b] += coils[k].slope[i] * segment.field[b][k];
                }
            }
        }
        const auto see = [&](double tau) {
            const double now = std::hypot(segment.sum(slope[0], tau), segment.sum(slope[1], tau));
            slope_max_ = std::max(slope_max_, now * std::abs(factor(tau)));
        };
        see(0.0);
        see(segment.duration);
        for (const auto& each : slope) for_each_turn(segment, each, see);
    }
    /// T/m, of the component along the heading.
    double slope_max() const { return slope_max_; }

    /// Field (T) of steady currents by the largest voltage of each coil.
    std::array<double, 3> steady_field(const PerCoilOf<CoilField>& coils) const {
        std::array<double, 3> result = {};
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double current = voltage_[k] / resistance_[k];
            for (std::size_t i = 0; i < 3; ++i) result[i] += coils[k].field[i] * current;
        }
        return result;
    }

    /// The squared size of the field at the robot at some time, T^2.
    void see_field(double square, bool in_window) {
        most_ = std::max(most_, square);
        if (in_window) least_ = std::min(least_, square);
    }
    bool has_seen_field(bool in_window) const {
        return most_ >= 0.0 && (!in_window || std::isfinite(least_));
    }
    /// Whether a field of that squared size would be the largest so far, or in the window the
    /// least, by more than 1e-8 of the largest size.
    bool would_be_most(double square) const { return square > (1.0 + 2.0 * kEnough) * most_; }
    bool would_be_least(double square) const {
        const double size = std::sqrt(std::max(square, 0.0)) + kEnough * std::sqrt(most_);
        return size * size < least_;
    }

    /// span: s, of the measuring window.
    void close(double span, Summary& summary) const {
        summary.field_min = std::sqrt(least_);
        summary.power_mean = energy_ / span;
    }
    void write(Summary& summary) const {
        summary.field_max = std::sqrt(std::max(most_, 0.0));
        summary.current_max = current_max_;
        for (const double volts : voltage_) {
            summary.voltage_max = std::max(summary.voltage_max, std::abs(volts));
        }
    }

private:
    static constexpr double kEnough = 1e-8;

    PerCoil resistance_;    // ohm
    PerCoil voltage_ = {};  // V, the largest by size, of each coil
    double current_max_ = 0.0, slope_max_ = 0.0;
    double most_ = -1.0;                                      // T^2, of the run
    double least_ = std::numeric_limits<double>::infinity();  // T^2, of the window
    double energy_ = 0.0;                                     // J
};

}  // namespace stickslip
