#include "stickslip/drive/circuit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace stickslip {

PerCoil CurrentSegment::at(const Coefficients& coefficients, double tau) const {
    const Values basis = values(tau);
    PerCoil result = {};
    for (std::size_t b = 0; b < count(); ++b) {
        for (std::size_t k = 0; k < kCoilCount; ++k) result[k] += coefficients[b][k] * basis[b];
    }
    return result;
}

PerCoil squared_integrals(const CurrentSegment& segment) {
    const double d = segment.duration;
    const auto n = static_cast<std::size_t>(segment.exponentials);
    std::array<double, kMaxExponentials> decay, gone;  // of each exponential over the segment
    std::array<std::array<double, kMaxExponentials>, kMaxExponentials> gone_both;
    for (std::size_t j = 0; j < n; ++j) {
        decay[j] = segment.fading(j, d);
        gone[j] = -std::expm1(-segment.rate[j] * d);
        for (std::size_t i = 0; i < n; ++i) {
            gone_both[j][i] = -std::expm1(-(segment.rate[j] + segment.rate[i]) * d);
        }
    }
    PerCoil result;
    for (std::size_t coil = 0; coil < kCoilCount; ++coil) {
        const double a = segment.coil[0][coil], b = segment.coil[1][coil];
        double sum = d * (a * a + d * (a * b + d * b * b / 3.0));
        for (std::size_t j = 0; j < n; ++j) {
            const double c = segment.coil[2 + j][coil], rate = segment.rate[j];
            if (c == 0.0) continue;  // of another coil
            sum += 2.0 * a * c * (gone[j] / rate) +
                   2.0 * b * c * (gone[j] - rate * d * decay[j]) / (rate * rate);
            for (std::size_t i = 0; i < n; ++i) {
                const double other = segment.coil[2 + i][coil];
                if (other != 0.0) sum += c * other * (gone_both[j][i] / (rate + segment.rate[i]));
            }
        }
        // The current of a coil with a capacitor has no slope beside.
        segment.each_swing([&](std::size_t at, const Swing& swing) {
            const Swing::Two c = {segment.coil[at][coil], segment.coil[at + 1][coil]};
            if (c[0] == 0.0 && c[1] == 0.0) return;
            const auto [once, squared] = swing.integrals(c, d);
            sum += 2.0 * a * once + squared;
        });
        result[coil] = sum;
    }
    return result;
}

Circuit::Circuit(const CircuitParameters& p)
    : resistance_(p.resistance),
      inductance_(p.inductance),
      capacitance_(p.capacitance),
      is_coupled_(p.coupling != 0.0),
      lag_(p.lag) {
    Vector per_root;  // R^(-1/2)
    for (int k = 0; k < kCoilCount; ++k) {
        per_root(k) = 1.0 / std::sqrt(p.resistance[static_cast<std::size_t>(k)]);
    }
    Matrix modes = Matrix::Identity();
    if (!is_coupled_) {
        time_constant_ =
            Eigen::Map<const Vector>(p.inductance.data()).cwiseProduct(per_root.cwiseAbs2());
    } else {
        const Eigen::Map<const Vector> self(p.inductance.data());
        const Matrix sizes = (self * self.transpose()).cwiseSqrt();
        const Matrix inductance = sizes.cwiseProduct(mutual_inductance(p.coupling));
        const Matrix scaled = per_root.asDiagonal() * inductance * per_root.asDiagonal();
        const Eigen::SelfAdjointEigenSolver<Matrix> solver(scaled);
        modes = solver.eigenvectors();
        time_constant_ = solver.eigenvalues();
    }
    to_modes_ = modes.transpose() * per_root.asDiagonal();
    from_modes_ = per_root.asDiagonal() * modes;

    for (int m = 0; m < kCoilCount; ++m) {
        const auto u = static_cast<std::size_t>(m);
        if (capacitance_[u] > 0.0) {
            const Swing own = {0.5 * resistance_[u] / inductance_[u],
                               1.0 / (inductance_[u] * capacitance_[u])};
            const auto end = swing_.begin() + swings_;
            const auto place = std::find(swing_.begin(), end, own);
            if (place == end) swing_[static_cast<std::size_t>(swings_++)] = own;
            swing_of_[u] = static_cast<std::size_t>(place - swing_.begin());
            time_constant_(m) = own.slowest();
            if (own.square() <= 0.0) {
                part_lag(1.0 / own.fastest());
                part_lag(own.slowest());
            }
            continue;
        }
        part_lag(time_constant_(m));
        group_[u] = static_cast<std::size_t>(groups_);
        for (int earlier = 0; earlier < m; ++earlier) {
            if (capacitance_[static_cast<std::size_t>(earlier)] > 0.0) continue;
            const double difference = time_constant_(m) - time_constant_(earlier);
            if (std::abs(difference) < 1e-12 * time_constant_(m)) {
                group_[u] = group_[static_cast<std::size_t>(earlier)];
                break;
            }
        }
        groups_ = std::max(groups_, static_cast<int>(group_[u]) + 1);
    }
}

// Equal time constants would need a third function, tau exp(-tau/T). A relative shift of 1e-6 of
// the lag is far below what it can be known to, and keeps one form for all.
void Circuit::part_lag(double time_constant) {
    if (std::abs(lag_ - time_constant) < 1e-6 * time_constant) {
        lag_ = time_constant * (1.0 + 1e-6);
    }
}

PerCoil Circuit::currents() const {
    PerCoil result;
    Eigen::Map<Vector>(result.data()) = product(from_modes_, mode_);
    return result;
}

PerCoil Circuit::field_lag() const {
    PerCoil result = {};
    if (lag_ == 0.0) return result;
    const PerCoil coil = currents();
    for (std::size_t k = 0; k < kCoilCount; ++k) result[k] = lagging_[k] - coil[k];
    return result;
}

void Circuit::set_currents(const PerCoil& currents, const PerCoil& field_lag,
                           const PerCoil& capacitors) {
    // In steady state the modes are those of the voltages R I.
    PerCoil voltages;
    for (std::size_t k = 0; k < kCoilCount; ++k) voltages[k] = resistance_[k] * currents[k];
    mode_ = product(to_modes_, Eigen::Map<const Vector>(voltages.data()));
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        lagging_[k] = currents[k] + field_lag[k];
        capacitor_[k] = capacitance_[k] > 0.0 ? capacitors[k] : 0.0;
    }
}

Circuit::Memory Circuit::memory() const {
    Memory result;
    Eigen::Map<Vector>(result.modes.data()) = mode_;
    result.lagging = lagging_;
    result.capacitor = capacitor_;
    return result;
}

void Circuit::restore(const Memory& memory) {
    mode_ = Eigen::Map<const Vector>(memory.modes.data());
    lagging_ = memory.lagging;
    capacitor_ = memory.capacitor;
}

// The matrices of coils that are not coupled are diagonal.
Circuit::Vector Circuit::product(const Matrix& modes, const Vector& vector) const {
    if (is_coupled_) return modes * vector;
    return modes.diagonal().cwiseProduct(vector);
}

CurrentSegment Circuit::advance(const VoltageSegment& segment) {
    CurrentSegment result;
    result.start = segment.start;
    result.duration = segment.end - segment.start;
    result.exponentials = exponentials();
    result.swings = swings_;
    result.swing = swing_;
    const Vector first = product(to_modes_, Eigen::Map<const Vector>(segment.first.data()));
    const Vector last = product(to_modes_, Eigen::Map<const Vector>(segment.last.data()));
    const Vector slope = (last - first) / result.duration;
    const Vector level = first - slope.cwiseProduct(time_constant_);
    const Vector transient = mode_ - level;

    const auto add = [&](int m, int k, std::size_t j) {
        const auto coil = static_cast<std::size_t>(k);
        result.coil[0][coil] += from_modes_(k, m) * level(m);
        result.coil[1][coil] += from_modes_(k, m) * slope(m);
        result.coil[2 + j][coil] += from_modes_(k, m) * transient(m);
    };
    double decay = 0.0;
    int decayed = -1;  // the mode whose it is
    for (int m = 0; m < kCoilCount; ++m) {
        if (capacitance_[static_cast<std::size_t>(m)] > 0.0) {
            add_swing(m, segment, result);
            continue;
        }
        const std::size_t j = group_[static_cast<std::size_t>(m)];
        result.rate[j] = 1.0 / time_constant_(m);
        if (is_coupled_) {
            for (int k = 0; k < kCoilCount; ++k) add(m, k, j);
        } else {
            add(m, m, j);
        }
        // Equal coils share one exponential.
        if (decayed < 0 || time_constant_(m) != time_constant_(decayed)) {
            decay = result.fading(j, result.duration);
            decayed = m;
        }
        mode_(m) = level(m) + slope(m) * result.duration + transient(m) * decay;
    }
    if (!fades()) capacitor_ = capacitors(segment, result, result.duration);
    std::copy_n(result.coil.begin(), result.count(), result.field.begin());
    if (lag_ > 0.0) add_lag(result);
    return result;
}

// Beside what swings, a voltage that rises evenly charges the capacitor evenly.
void Circuit::add_swing(int coil, const VoltageSegment& voltages, CurrentSegment& segment) {
    const auto k = static_cast<std::size_t>(coil);
    const std::size_t at = segment.place(swing_of_[k]);
    const Swing& swing = swing_[swing_of_[k]];
    const double slope = (voltages.last[k] - voltages.first[k]) / segment.duration;
    const double current = from_modes_(coil, coil) * mode_(coil), even = capacitance_[k] * slope;
    const double rise =
        (voltages.first[k] - resistance_[k] * current - capacitor_[k]) / inductance_[k];
    const Swing::Two c = {current - even, rise + swing.rate * (current - even)};
    segment.coil[0][k] = even;
    segment.coil[at][k] = c[0];
    segment.coil[at + 1][k] = c[1];
    const Swing::Two value = swing.at(segment.duration);
    mode_(coil) = (even + c[0] * value[0] + c[1] * value[1]) / from_modes_(coil, coil);
}

PerCoil Circuit::capacitors(const VoltageSegment& voltages, const CurrentSegment& segment,
                            double tau) const {
    const PerCoil volts = voltage_at(voltages, voltages.start + tau);
    const CurrentFunctions::Values value = segment.values(tau), change = segment.changes(value);
    PerCoil result = {};
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        if (!(capacitance_[k] > 0.0)) continue;
        double current = 0.0, rise = 0.0;
        for (std::size_t b = 0; b < segment.count(); ++b) {
            current += segment.coil[b][k] * value[b];
            rise += segment.coil[b][k] * change[b];
        }
        result[k] = volts[k] - resistance_[k] * current - inductance_[k] * rise;
    }
    return result;
}

// The lag's own exponential comes last; each function of time passes through the lag as it must.
void Circuit::add_lag(CurrentSegment& segment) {
    const auto own = static_cast<std::size_t>(groups_);
    segment.rate[own] = 1.0 / lag_;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        segment.field[0][k] -= lag_ * segment.field[1][k];
        double start = segment.field[0][k];
        for (std::size_t j = 0; j < own; ++j) {
            segment.field[2 + j][k] /= 1.0 - lag_ * segment.rate[j];
            start += segment.field[2 + j][k];
        }
        segment.each_swing([&](std::size_t at, const Swing& swing) {
            Swing::Two c = {segment.field[at][k], segment.field[at + 1][k]};
            c = swing.lagged(c, lag_);
            segment.field[at][k] = c[0];
            segment.field[at + 1][k] = c[1];
            start += c[0];
        });
        segment.field[2 + own][k] = lagging_[k] - start;
    }
    lagging_ = segment.field_currents(segment.duration);
}

Eigen::Matrix<double, kCoilCount, kCoilCount> mutual_inductance(double coupling) {
    constexpr std::array<int, kCoilCount> axis = {0, 0, 1, 1, 2};
    constexpr std::array<double, kCoilCount> side = {1.0, -1.0, 1.0, -1.0, -1.0};
    Eigen::Matrix<double, kCoilCount, kCoilCount> result;
    for (int i = 0; i < kCoilCount; ++i) {
        for (int j = 0; j < kCoilCount; ++j) {
            const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
            const double sign = axis[a] == axis[b] ? 1.0 : -side[a] * side[b];
            result(i, j) = i == j ? 1.0 : sign * coupling;
        }
    }
    return result;
}

PerCoil mean_square_currents(const VoltageProgram& program, const CircuitParameters& parameters) {
    CircuitParameters without_lag = parameters;
    without_lag.lag = 0.0;
    Circuit circuit(without_lag);
    const double settling = 40.0 * circuit.slowest();  // exp(-40) is below rounding
    PerCoil sum = {};
    for (const VoltageBlock& block : program.blocks()) {
        const double needed = std::ceil(settling / block.duration()) + 1.0;
        const std::int64_t played = static_cast<double>(block.repeats) < needed
                                        ? block.repeats
                                        : static_cast<std::int64_t>(needed);
        for (std::int64_t repeat = 0; repeat < played; ++repeat) {
            const double weight =
                repeat + 1 == played ? static_cast<double>(block.repeats - repeat) : 1.0;
            for (std::size_t i = 0; i + 1 < block.points.size(); ++i) {
                const VoltagePoint& from = block.points[i];
                const VoltagePoint& to = block.points[i + 1];
                if (to.time == from.time) continue;
                const CurrentSegment segment =
                    circuit.advance({from.time, to.time, from.voltage, to.voltage});
                const PerCoil squares = squared_integrals(segment);
                for (std::size_t k = 0; k < kCoilCount; ++k) sum[k] += weight * squares[k];
            }
        }
    }
    for (double& value : sum) value /= program.duration();
    return sum;
}

// R = R0 (1 + k R <I^2>) as a fixed point in the logarithm of R. Currents fall no faster than 1/R,
// so that with p = -d ln <I^2> / d ln R between 0 (an inductance alone) and 2 (a resistance alone)
// a coil's slope there, (1 - R0/R)(1 - p), is below one in size. Two steps give that slope, and
// with it the end of their geometric series (Aitken), which leaves the coupling of the coils alone
// to further steps.
PerCoil warm_resistances(const VoltageProgram& program, const CircuitParameters& cold,
                         double coefficient) {
    constexpr int kMostSteps = 100;
    constexpr double kRounding = 1e-13;
    using Logarithms = Eigen::Array<double, kCoilCount, 1>;
    CircuitParameters warm = cold;
    const auto set = [&](const Logarithms& log) {
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            warm.resistance[k] = cold.resistance[k] * std::exp(log(static_cast<Eigen::Index>(k)));
        }
    };
    const auto heated = [&](const Logarithms& log) {
        set(log);
        const PerCoil squares = mean_square_currents(program, warm);
        Logarithms result;
        for (std::size_t k = 0; k < kCoilCount; ++k) {
            const double power = warm.resistance[k] * squares[k];
            result(static_cast<Eigen::Index>(k)) = std::log1p(coefficient * power);
        }
        return result;
    };
    Logarithms log = Logarithms::Zero();
    for (int n = 0; n < kMostSteps; ++n) {
        const Logarithms once = heated(log);
        if (((once - log).abs() <= kRounding).all()) break;
        const Logarithms twice = heated(once);
        const Logarithms slope = (twice - once) / (once - log);  // not a number without current
        log = (slope.abs() < 1.0).select(twice + (twice - once) * slope / (1.0 - slope), twice);
    }
    set(log);
    return warm.resistance;
}

}  // namespace stickslip
