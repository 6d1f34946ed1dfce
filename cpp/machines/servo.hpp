#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "machines/motion.hpp"
#include "machines/path.hpp"

namespace machines {

/// A motor behind a loop that holds the place y of its load, per unit of inertia:
///
///     duty = asked + gain (goal - y) - damping_gain w     at most `limit`
///     torque = strength supply duty - braking v           while it is switched on
///
/// Dry friction grows with what the gear passes on, by `gear` |torque + weight|.
struct ServoTerms : MotionTerms {
    double gain = 0.0, damping_gain = 0.0, limit = 0.0, strength = 0.0, braking = 0.0, gear = 0.0;
};

inline constexpr std::array<Named<ServoTerms>, 13> kServoTerms = {{
    {"rate", &ServoTerms::rate},
    {"gravity", &ServoTerms::gravity},
    {"coulomb", &ServoTerms::coulomb},
    {"stribeck", &ServoTerms::stribeck},
    {"stribeck_speed", &ServoTerms::stribeck_speed},
    {"gap", &ServoTerms::gap},
    {"share", &ServoTerms::share},
    {"gain", &ServoTerms::gain},
    {"damping_gain", &ServoTerms::damping_gain},
    {"limit", &ServoTerms::limit},
    {"strength", &ServoTerms::strength},
    {"braking", &ServoTerms::braking},
    {"gear", &ServoTerms::gear},
}};

/// One mass or two that a servo drives, with two more phases: the sign of the duty at its limit, or
/// 0, and of what the gear passes on. Inputs: goal, asked duty, supply, and 1 or 0 as it is on or
/// off. See Path.
template <class Masses>
class Servo : Masses {
public:
    static constexpr std::size_t kStates = Masses::kStates, kInputs = 4;
    static constexpr std::size_t kOwn = Masses::kPhases, kPhases = kOwn + 2;
    using State = typename Masses::State;
    using Input = std::array<double, kInputs>;
    using Mode = std::array<int, kPhases>;
    using Point = std::pair<State, Mode>;

    /// supply: the usual one.
    Servo(const ServoTerms& terms, double supply)
        : Masses(terms), c(terms), fastest(turns(supply, 1.0)) {
        if (c.gear != 0.0) Masses::dry = true;
    }

    static constexpr bool linear = false;

    double fastest_at(const State& z, const Input& u, const Mode& mode) const {
        // Friction changes by the acceleration there, and only its errors tell how fast.
        if (c.stribeck != 0.0 && std::abs(z[1]) < kSlow * c.stribeck_speed) return kEndless;
        return turns(u[2], kStates == 2 || mode[1] != 0 ? 1.0 : 1.0 - c.share);
    }

    State rate(const State& z, const Input& u, const Mode& mode) const {
        return Masses::rate(z, {pull(z, u, mode)}, own(mode));
    }

    std::array<double, kPhases> margins(const State& z, const Input& u, const Mode& mode) const {
        std::array<double, kPhases> result;
        result.fill(kEndless);
        const auto moves = Masses::margins(z, {pull(z, u, mode)}, own(mode));
        std::copy(moves.begin(), moves.end(), result.begin());
        const int side = mode[kOwn];
        if (u[3] != 0.0) {
            result[kOwn] = side == 0 ? c.limit - std::abs(duty(z, u)) : side * duty(z, u) - c.limit;
        }
        if (c.gear != 0.0 && mode[0] != 0) result[kOwn + 1] = mode[kOwn + 1] * passed(z, u, mode);
        return result;
    }

    std::array<double, kPhases> falls(const State& z, const Input& u, const Input& slope,
                                      const Mode& mode) const {
        std::array<double, kPhases> result = {};
        const State now = rate(z, u, mode);
        const double w = z[kStates - 1];
        if (Masses::dry) result[0] = -mode[0] * now[1];
        if constexpr (kStates == 4) {
            if (mode[1] == 0) result[1] = std::copysign(1.0, z[0] - z[2]) * (z[1] - w);
        }
        double rise = slope[1] + c.gain * (slope[0] - w) - c.damping_gain * now[kStates - 1];
        if (u[3] != 0.0 && std::isfinite(c.limit)) {
            result[kOwn] = (mode[kOwn] == 0 ? std::copysign(1.0, duty(z, u)) : -mode[kOwn]) * rise;
        }
        if (c.gear != 0.0 && mode[0] != 0) {
            if (mode[kOwn] != 0) rise = 0.0;
            rise = c.strength * (u[2] * rise + slope[2] * applied(z, u, mode)) - c.braking * now[1];
            rise = u[3] * rise + c.gravity * std::cos(z[kStates - 2]) * w;
            result[kOwn + 1] = -mode[kOwn + 1] * rise;
        }
        return result;
    }

    /// The place is that of the load, which lies where its weight pulls it.
    Point begun(const State& z, const Input& u) const {
        const double pulls = Masses::loading(z[0]), y = z[kStates - 2];
        const bool hangs = pulls != 0.0;
        auto [first, mode] = Masses::begun(z, {hangs ? pulls : torque(z, u, sided(z, u, {}))});
        const double apart = y - first[kStates - 2];
        for (std::size_t i = 0; i < kStates; i += 2) first[i] += apart;
        return driven(first, u, joined(mode, {}));
    }

    Point driven(const State& z, const Input& u, const Mode& mode) const {
        const Mode now = sided(z, u, mode);
        const auto [moved, masses] = Masses::driven(z, {pull(z, u, now)}, own(now));
        return {moved, sided(moved, u, joined(masses, now))};
    }

    Point after(const State& z, const Input& u, const Mode& mode, std::size_t hit) const {
        Mode now = mode;
        if (hit == kOwn) {
            now[kOwn] = mode[kOwn] != 0 ? 0 : sign_of(duty(z, u));
        } else if (hit > kOwn) {
            now[hit] = -mode[hit];
        } else {
            State there = z;
            if (hit == 0) {
                // A motor that stops asks what would hold it.
                there[1] = mode[0] != 0 ? 0.0 : z[1];
                now[0] = 0;
            }
            const double pulls = pull(there, u, now);
            const auto [moved, masses] = Masses::after(z, {pulls}, own(mode), hit);
            return driven(moved, u, joined(masses, mode));
        }
        return {z, now};
    }

private:
    using Phases = typename Masses::Mode;

    static constexpr double kEndless = std::numeric_limits<double>::infinity();

    static int sign_of(double value) { return value < 0.0 ? -1 : 1; }

    static Phases own(const Mode& mode) {
        Phases result;
        std::copy_n(mode.begin(), kOwn, result.begin());
        return result;
    }
    static Mode joined(const Phases& masses, Mode mode) {
        std::copy(masses.begin(), masses.end(), mode.begin());
        return mode;
    }

    // Speed over that of the Stribeck effect beyond which none of it is left. Chosen: exp(-16).
    static constexpr double kSlow = 4.0;

    /// Upper bound on the magnitude of the eigenvalues, 1/s, with this share of the inertia.
    double turns(double supply, double motor) const {
        const double pulls = c.strength * std::abs(supply) * (1.0 + c.gear);
        const double stiff = std::abs(c.gravity) + pulls * c.gain;
        return std::max(std::sqrt(stiff / motor),
                        (c.rate + c.braking + pulls * c.damping_gain) / motor);
    }

    double duty(const State& z, const Input& u) const {
        return u[1] + c.gain * (u[0] - z[kStates - 2]) - c.damping_gain * z[kStates - 1];
    }
    double applied(const State& z, const Input& u, const Mode& mode) const {
        return mode[kOwn] != 0 ? mode[kOwn] * c.limit : duty(z, u);
    }
    double torque(const State& z, const Input& u, const Mode& mode) const {
        return u[3] * (c.strength * u[2] * applied(z, u, mode) - c.braking * z[1]);
    }
    /// The motor's torque and the weight, both of which the gear has to pass on.
    double passed(const State& z, const Input& u, const Mode& mode) const {
        return torque(z, u, mode) + Masses::loading(z[kStates - 2]);
    }
    /// The motor's torque less what the gear takes; at rest at most what would move the load.
    double pull(const State& z, const Input& u, const Mode& mode) const {
        const double whole = torque(z, u, mode);
        if (c.gear == 0.0) return whole;
        const double weight = Masses::loading(z[kStates - 2]), through = whole + weight;
        if (mode[0] != 0) return whole - mode[0] * c.gear * mode[kOwn + 1] * through;
        const double load = kStates == 2 || mode[1] != 0 ? weight : 0.0;
        const double over = std::abs(whole - load) - c.gear * std::abs(through);
        return load + sign_of(whole - load) * std::max(over, 0.0);
    }
    /// The phases of duty and gear as they are now.
    Mode sided(const State& z, const Input& u, Mode mode) const {
        const double asked = duty(z, u);
        mode[kOwn] = std::abs(asked) > c.limit ? sign_of(asked) : 0;
        mode[kOwn + 1] = sign_of(passed(z, u, mode));
        return mode;
    }

    ServoTerms c;

public:
    double fastest;
};

/// Place and speed of the load.
struct ServoStates {
    using Terms = ServoTerms;
    static constexpr const auto& kTerms = kServoTerms;
    static constexpr std::size_t kStates = 2, kInputs = 4, kStarts = 2;

    static void write(const Terms& c, const double* start, std::span<const double> t,
                      const Signals<kInputs>& acting, double* out) {
        const auto [x, v] = std::array{start[0], start[1]};
        const double supply = acting.values[2];
        const auto load = [&](std::size_t n, const auto& z) {
            std::copy(z.end() - 2, z.end(), out + 2 * n);
        };
        if (c.gap != 0.0) {
            follow(Servo<TwoMasses>(c, supply), {x, v, x, v}, t, acting, load);
        } else {
            follow(Servo<OneMass>(c, supply), {x, v}, t, acting, load);
        }
    }
};

}  // namespace machines
