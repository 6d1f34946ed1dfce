#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "machines/path.hpp"

namespace machines {

/// One mass with friction that sticks, or a motor and its load: coefficients per unit of inertia, 0
/// where a term is absent.
///
///     x'' = u - load - rate v - rate_asymmetry |v| - quadratic v|v| - cubic_damping v^3
///           - stiffness x - square x^2 - cubic x^3 - gravity sin(x) - friction
///     friction = sign(v) max(coulomb + sign(v) asymmetry, 0) + sign(v) stribeck exp(-(v / vs)^2)
///
/// u is the input; with `swing` it is that times cos(x). At rest friction holds what is below its
/// limit. With a `gap` to each side or a `spring` there are two masses: the motor's with the
/// friction, and the load's, a `share` of the whole, with all that depends on the place. Across the
/// gap they meet without rebound and pull at nothing; the spring has a moment of `spring` per angle
/// and a `damping`.
struct MotionTerms {
    double rate = 0.0, rate_asymmetry = 0.0, quadratic = 0.0, cubic_damping = 0.0;
    double stiffness = 0.0, square = 0.0, cubic = 0.0, gravity = 0.0, swing = 0.0;
    double coulomb = 0.0, asymmetry = 0.0, stribeck = 0.0, stribeck_speed = 0.0, load = 0.0;
    double gap = 0.0, spring = 0.0, damping = 0.0, share = 0.0;
};

inline constexpr std::array<Named<MotionTerms>, 18> kMotionTerms = {{
    {"rate", &MotionTerms::rate},
    {"rate_asymmetry", &MotionTerms::rate_asymmetry},
    {"quadratic", &MotionTerms::quadratic},
    {"cubic_damping", &MotionTerms::cubic_damping},
    {"stiffness", &MotionTerms::stiffness},
    {"square", &MotionTerms::square},
    {"cubic", &MotionTerms::cubic},
    {"gravity", &MotionTerms::gravity},
    {"swing", &MotionTerms::swing},
    {"coulomb", &MotionTerms::coulomb},
    {"asymmetry", &MotionTerms::asymmetry},
    {"stribeck", &MotionTerms::stribeck},
    {"stribeck_speed", &MotionTerms::stribeck_speed},
    {"load", &MotionTerms::load},
    {"gap", &MotionTerms::gap},
    {"spring", &MotionTerms::spring},
    {"damping", &MotionTerms::damping},
    {"share", &MotionTerms::share},
}};

/// Position and speed, and the sign of the motion, or 0 at rest; see Path.
class OneMass {
public:
    static constexpr std::size_t kStates = 2, kInputs = 1, kPhases = 1;
    using State = std::array<double, kStates>;
    using Input = std::array<double, kInputs>;
    using Mode = std::array<int, kPhases>;
    using Point = std::pair<State, Mode>;

    explicit OneMass(const MotionTerms& terms);

    bool linear = false;
    double fastest = 0.0;

    double fastest_at(const State& z, const Input& u, const Mode&) const {
        return fastest_at(z[0], z[1], u[0]);
    }

    State rate(const State& z, const Input& u, const Mode& mode) const;
    std::array<double, 1> margins(const State& z, const Input& u, const Mode& mode) const;
    std::array<double, 1> falls(const State& z, const Input& u, const Input& slope,
                                const Mode& mode) const;
    Point begun(const State& z, const Input& u) const;
    Point driven(const State& z, const Input& u, const Mode& mode) const;
    Point after(const State& z, const Input& u, const Mode& mode, std::size_t hit) const;

protected:
    double fastest_at(double x, double v, double u) const;
    /// Sum of what acts at the motor, but for friction that depends on the sign of the motion.
    double driving(double x, double v, double u) const;
    /// Resistance of the load at `x`.
    double loading(double x) const;
    /// Friction against a motion of the sign `s`.
    double friction(double v, int s) const;
    /// Reserve of friction at rest: the limit less |force|.
    double held(double force) const;
    /// The sign of the motion that begins at rest; 0 where friction holds.
    int way(double force) const;

    MotionTerms c;
    bool dry = false;
    double weakens = 0.0;  ///< fastest fall of the friction with speed, 1/s
};

/// A motor and its load: x, v, y, w; the sign of the motor's motion, and of the contact or 0.
class TwoMasses : protected OneMass {
public:
    static constexpr std::size_t kStates = 4, kInputs = 1, kPhases = 2;
    using State = std::array<double, kStates>;
    using Mode = std::array<int, kPhases>;
    using Point = std::pair<State, Mode>;
    using OneMass::fastest;
    using OneMass::Input;
    using OneMass::linear;

    explicit TwoMasses(const MotionTerms& terms);

    double fastest_at(const State& z, const Input& u, const Mode&) const;
    State rate(const State& z, const Input& u, const Mode& mode) const;
    std::array<double, 2> margins(const State& z, const Input& u, const Mode& mode) const;
    std::array<double, 1> falls(const State& z, const Input& u, const Input& slope,
                                const Mode& mode) const;
    /// Both move as one; the gap is closed in the direction of the first input, of which a zero has
    /// the sign as well.
    Point begun(const State& z, const Input& u) const;
    Point driven(const State& z, const Input& u, const Mode& mode) const;
    Point after(const State& z, const Input& u, const Mode& mode, std::size_t hit) const;

private:
    struct Pulls {
        double motor;    ///< what drives it
        double between;  ///< the moment between both
        double load;     ///< what it resists
    };
    Pulls pulls(const State& z, const Input& u, const Mode& mode) const;

    bool hard = false;
};

/// Place and speed of the motor, and of its load.
struct Motion {
    using Terms = MotionTerms;
    static constexpr const auto& kTerms = kMotionTerms;
    static constexpr std::size_t kStates = 4, kInputs = 1, kStarts = 2;

    static void write(const Terms& c, const double* start, std::span<const double> t,
                      const Signals<kInputs>& acting, double* out) {
        const auto [x, v] = std::array{start[0], start[1]};
        if (c.gap != 0.0 || c.spring != 0.0) {
            follow(TwoMasses(c), {x, v, x, v}, t, acting, [&](std::size_t n, const auto& z) {
                std::copy(z.begin(), z.end(), out + 4 * n);
            });
        } else {
            follow(OneMass(c), {x, v}, t, acting, [&](std::size_t n, const auto& z) {
                for (std::size_t i = 0; i < 4; ++i) out[4 * n + i] = z[i % 2];
            });
        }
    }
};

}  // namespace machines
