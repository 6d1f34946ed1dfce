#pragma once

#include <Eigen/Core>
#include <array>

#include "stickslip/drive/current_functions.hpp"
#include "stickslip/drive/voltage_program.hpp"

namespace stickslip {

/// Exponentials that packs of runs have room for.
inline constexpr int kMostPackedExponentials = 3;

/// Currents over one segment, as sums of its functions of tau = t - start.
struct CurrentSegment : CurrentFunctions {
    using Coefficients = std::array<PerCoil, kMaxBasis>;  // A, A/s, A, A ...

    double start = 0.0;       ///< s
    double duration = 0.0;    ///< s
    Coefficients coil = {};   ///< of the currents in the coils
    Coefficients field = {};  ///< of the currents that would make the field, which lags

    /// Currents in the coils at `tau` seconds from the start, A.
    PerCoil currents(double tau) const { return at(coil, tau); }
    /// Currents that would make the field without a lag, A.
    PerCoil field_currents(double tau) const { return at(field, tau); }

private:
    PerCoil at(const Coefficients& coefficients, double tau) const;
};

/// Integral of the square of each coil's current over a segment, A^2 s.
PerCoil squared_integrals(const CurrentSegment& segment);

struct CircuitParameters {
    PerCoil resistance = {};  ///< ohm
    PerCoil inductance = {};  ///< H
    /// F, in series with a coil; zero: none. Not beside a coupling.
    PerCoil capacitance = {};
    double coupling = 0.0;  ///< mutual over self inductance, by size; see `mutual_inductance`
    double lag = 0.0;       ///< s, with which the field follows the currents
};

/// The resistive-inductive circuits of the coils, Eq. (1), solved in closed form segment by
/// segment. Coupled or unequal coils are solved in the modes of R^(-1/2) L R^(-1/2), one with a
/// capacitor as what swings by rate R/(2L) and stiffness 1/(LC). Behind them stands the first-order
/// lag of the field (effect `eddy_lag`).
class Circuit {
public:
    explicit Circuit(const CircuitParameters& parameters);

    /// The currents over `segment`, going on from where the previous segment ended.
    CurrentSegment advance(const VoltageSegment& segment);

    const PerCoil& resistance() const { return resistance_; }

    /// Currents at the end of the last segment, A.
    PerCoil currents() const;
    /// Currents that the field follows less those of the coils, A.
    PerCoil field_lag() const;
    /// Voltages of the capacitors at the end of the last segment, V; zero without a capacitor.
    const PerCoil& capacitors() const { return capacitor_; }
    /// The same `tau` seconds into a segment, whose currents these are.
    PerCoil capacitors(const VoltageSegment& voltages, const CurrentSegment& segment,
                       double tau) const;
    void set_currents(const PerCoil& currents, const PerCoil& field_lag, const PerCoil& capacitors);

    /// State carried from segment to segment.
    struct Memory {
        std::array<double, kCoilCount> modes = {};
        PerCoil lagging = {};    ///< A
        PerCoil capacitor = {};  ///< V
    };
    Memory memory() const;
    void restore(const Memory& memory);

    /// Number of exponentials that the currents and the field are made of.
    int exponentials() const { return groups_ + (lag_ > 0.0 ? 1 : 0); }
    /// Whether the currents are made of exponentials alone, without a swing.
    bool fades() const { return swings_ == 0; }

    /// Largest time constant of the modes, s.
    double slowest() const { return time_constant_.maxCoeff(); }

private:
    using Vector = Eigen::Matrix<double, kCoilCount, 1>;
    using Matrix = Eigen::Matrix<double, kCoilCount, kCoilCount>;

    void add_swing(int coil, const VoltageSegment& voltages, CurrentSegment& segment);
    void add_lag(CurrentSegment& segment);
    void part_lag(double time_constant);
    Vector product(const Matrix& modes, const Vector& vector) const;

    PerCoil resistance_, inductance_, capacitance_;   // ohm, H, F
    Matrix to_modes_;                                 // of voltages
    Matrix from_modes_;                               // to currents
    Vector time_constant_;                            // s, of each mode
    std::array<std::size_t, kCoilCount> group_ = {};  // modes of one time constant share a function
    int groups_ = 0, swings_ = 0;
    std::array<Swing, kCoilCount> swing_ = {};  // of coils with a capacitor
    std::array<std::size_t, kCoilCount> swing_of_ = {};
    bool is_coupled_;
    double lag_;
    Vector mode_ = Vector::Zero();  // modal currents at the end of the last segment
    // At the end of the last segment: the currents of the field, A; of the capacitors, V.
    PerCoil lagging_ = {}, capacitor_ = {};
};

/// Inductance matrix over the self inductance. Every pair has a mutual inductance of the size
/// `coupling`, with the sign that the directions of positive current give it: opposite coils help
/// each other; two coils on different axes do where one is on the positive and one on the negative
/// side.
Eigen::Matrix<double, kCoilCount, kCoilCount> mutual_inductance(double coupling);

/// Mean of the squared currents over a program, A^2. Of a block that repeats, the first repeats
/// stand for the others.
PerCoil mean_square_currents(const VoltageProgram& program, const CircuitParameters& parameters);

/// Resistances (ohm) of coils that their mean power P heats, R = R0 (1 + coefficient P), with the
/// currents of the warm coils. `coefficient` in 1/W; the resistances of `cold` are R0.
PerCoil warm_resistances(const VoltageProgram& program, const CircuitParameters& cold,
                         double coefficient);

}  // namespace stickslip
