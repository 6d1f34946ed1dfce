#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "stickslip/body/rectangle.hpp"
#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/free_curve.hpp"
#include "stickslip/numbers/pack.hpp"

/// How friction, adhesion and drag depend on the motion, as data. A law adds amplitude times
/// form(argument / scale) to a quantity, or multiplies the quantity by one plus that (zero where
/// this is negative). One evaluator has all laws, of a run or of a pack of runs, in any frame, in
/// impacts and at rest. A named effect is a row of scenario/named_laws.cpp.
namespace stickslip {

/// In this order laws are applied; those that are asked for together stand together.
enum class Quantity : unsigned char {
    sliding_friction,      ///< the kinetic coefficient
    friction,              ///< both coefficients
    directional_friction,  ///< the same, by laws of the slip's sign, which share the others
    friction_by_load,  ///< the same, by laws of the load, which depends on the coefficient itself
    adhesion,          ///< N
    drag,              ///< N s/m, force of the fluid over the velocity
    rotational_drag,   ///< N m s, its torque over the rate
    fluid,             ///< both, which a law can only multiply
};
inline constexpr std::size_t kQuantities = 8;

enum class Argument : unsigned char {
    slip_sign,   ///< +1 for slip to the robot's front, -1 to its rear
    slip_speed,  ///< m/s
    place,       ///< m, of the contact along the surface
    tilt,        ///< rad, -pi to pi
    sine,        ///< of the tilt
    cosine,
    load,   ///< N, the normal force; infinite in an impact
    time,   ///< s, since the run began
    age,    ///< s, since touch-down, zero before
    speed,  ///< m/s, of the centre of mass
    rate,   ///< rad/s, size of that of the tilt
};
inline constexpr std::size_t kArguments = 11;

/// Finite at zero, since a pack evaluates the laws of each of its runs for all of them.
enum class Form : unsigned char {
    line,         ///< u
    square,       ///< u^2
    gaussian,     ///< exp(-u^2)
    exponential,  ///< exp(-|u|)
    logarithm,    ///< ln(1 + |u|)
    saturation,   ///< u^2/(1 + u^2)
    wave,         ///< sin u
    curve,        ///< a FreeCurve
};

enum class Acts : unsigned char { adds, multiplies };

/// Whether laws of a quantity may depend on an argument.
bool has_argument(Quantity quantity, Argument argument);
/// Whether a form stays finite however large its argument is.
bool is_bounded(Form form);

/// Kind of a law: the part that all runs of a pack share.
struct LawKind {
    Quantity quantity;
    Acts acts;
    Argument argument;
    Form form;
    unsigned char copy = 0;  ///< number among laws of the same kind

    friend auto operator<=>(const LawKind&, const LawKind&) = default;
};

struct Law {
    LawKind kind;
    double amplitude = 1.0;
    double scale = 1.0;    ///< of the argument; a curve has its own
    FreeShape curve = {};  ///< of the form curve
    std::string key = {};  ///< of the amplitude, for messages
    double stated = 0.0;   ///< its value in the scenario

    /// A bound from below on amplitude times form; minus infinity where there is none.
    double lowest() const;
    /// Value where the argument is zero; a bound on its magnitude up to |argument|.
    double at_zero() const;
    double largest(double argument) const;
    /// A bound on the slope (per unit of the argument) up to |argument|; zero where it only falls.
    double steepest(double argument) const;
    /// Reverses the sign of the argument.
    void turn();
};

/// The kinds of the named effects, sorted. Where runs have no others, these are unfolded by the
/// compiler: a law then costs what its formula costs.
inline constexpr std::array<LawKind, 8> kNamedKinds = {{
    {Quantity::sliding_friction, Acts::adds, Argument::slip_speed, Form::line},
    {Quantity::sliding_friction, Acts::adds, Argument::slip_speed, Form::gaussian},
    {Quantity::friction, Acts::multiplies, Argument::place, Form::wave},
    {Quantity::directional_friction, Acts::multiplies, Argument::slip_sign, Form::line},
    {Quantity::adhesion, Acts::multiplies, Argument::sine, Form::square},
    {Quantity::adhesion, Acts::multiplies, Argument::age, Form::logarithm},
    {Quantity::drag, Acts::adds, Argument::cosine, Form::square},
    {Quantity::drag, Acts::adds, Argument::speed, Form::line},
}};

/// Kinds of laws, sorted, and where each has its numbers: amplitude, one over the scale, and what
/// `curve_at` asks for. Nothing of it is a function that kernels call, since what is compiled for
/// one processor must not stand in for what is compiled for another.
struct LawTable {
    static constexpr std::size_t kMost = 24;
    static constexpr short kNone = -1;

    LawKind kinds[kMost] = {};
    unsigned short place[kMost + 1] = {};      // of each law's numbers
    unsigned char from[kQuantities + 1] = {};  // first law of each quantity
    // Place of the numbers of each of kNamedKinds, or kNone.
    short place_of_named[8] = {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
    std::size_t count = 0;
    bool only_named = true;

    std::size_t numbers() const { return place[count]; }
    bool holds(const LawTable& other) const {
        return std::includes(kinds, kinds + count, other.kinds, other.kinds + other.count);
    }
    /// Takes the laws of another too; false, and nothing, where these are more than `kMost` or have
    /// more numbers than `most_numbers`.
    bool merge(const LawTable& other, std::size_t most_numbers = kMost * (2 + kCurveNumbers));
};

/// The laws of one run.
class LawSet {
public:
    LawSet() = default;
    /// Throws std::invalid_argument for an argument that a quantity does not have, and for more
    /// laws than a table holds.
    explicit LawSet(std::vector<Law> laws);

    bool empty() const { return table_.count == 0; }
    const LawTable& table() const { return table_; }
    const double* numbers() const { return numbers_.data(); }
    bool has(Quantity quantity) const {
        const auto q = static_cast<std::size_t>(quantity);
        return table_.from[q] < table_.from[q + 1];
    }
    /// Calls `put(i, number)` for each of the numbers of a table that holds the laws of this one;
    /// the others' are zero.
    void spread(const LawTable& table, auto&& put) const {
        std::size_t mine = 0;
        for (std::size_t i = 0; i < table.count; ++i) {
            const bool is_mine = mine < table_.count && table_.kinds[mine] == table.kinds[i];
            for (std::size_t n = table.place[i]; n < table.place[i + 1]; ++n) {
                put(n, is_mine ? numbers_[table_.place[mine] + n - table.place[i]] : 0.0);
            }
            if (is_mine) ++mine;
        }
    }
    const std::vector<Law>& laws() const { return laws_; }
    /// A bound from below on a value that is `base` without laws, by those of some quantities one
    /// after another; below zero where only laws that add can bring it there.
    double lowest(Quantity first, Quantity last, double base) const;
    /// Shortest time (s) over which they may change anything while nothing moves.
    double least_time() const;

private:
    std::vector<Law> laws_;  // in the order of the table
    LawTable table_;
    std::vector<double> numbers_;
};

/// Inputs of the laws that are constant for one quadrant over one segment of voltage.
template <class Real>
struct LawMoment {
    Real turn = 0.0, turn_sine = 0.0, turn_cosine = 1.0;  ///< rad, of the quadrant
    Real contact_age = 0.0, start = 0.0;                  ///< s, at the start of the segment

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(turn, turn_sine, turn_cosine, contact_age, start);
    }
};

/// Inputs of the laws that change with the motion; a caller sets those that the quantity may need.
template <class Real>
struct LawInput {
    Real tau = 0.0;  ///< s, in the segment
    PoseOf<Real> pose = {};
    Real slip_sign = 0.0, slip_speed = 0.0, place = 0.0, load = 0.0;
    Real speed_squared = 0.0, rate = 0.0;

    [[gnu::always_inline]] Real at(Argument argument, const LawMoment<Real>& now) const {
        constexpr double kTurn = 4.0 * kQuarterTurn;
        switch (argument) {
            case Argument::slip_sign:
                return slip_sign;
            case Argument::slip_speed:
                return slip_speed;
            case Argument::place:
                return place;
            case Argument::tilt: {
                // A body in flight may turn on beyond its quadrant.
                const Real tilt = now.turn + pose.angle;
                const Real turns = fma(tilt, Real(1.0 / kTurn), Real(kRound)) - kRound;
                return fnma(turns, Real(kTurn), tilt);
            }
            case Argument::sine:
                return fma(now.turn_sine, pose.cosine, now.turn_cosine * pose.sine);
            case Argument::cosine:
                return fnma(now.turn_sine, pose.sine, now.turn_cosine * pose.cosine);
            case Argument::load:
                return load;
            case Argument::time:
                return now.start + tau;
            case Argument::age:
                return greater(Real(0.0), now.contact_age + tau);
            case Argument::speed:
                return root(speed_squared);
            case Argument::rate:
                return magnitude(rate);
        }
        return 0.0;
    }
};

template <class Real>
[[gnu::always_inline]] inline Real form_at(Form form, Real u, const Real* curve) {
    switch (form) {
        case Form::line:
            return u;
        case Form::square:
            return u * u;
        case Form::gaussian:
            return exponential(-(u * u));
        case Form::exponential:
            return exponential(-magnitude(u));
        case Form::logarithm:
            return logarithm(1.0 + magnitude(u));
        case Form::saturation: {
            const Real uu = lesser(u * u, Real(1e300));
            return uu / (1.0 + uu);
        }
        case Form::wave:
            return sine(u);
        case Form::curve:
            return curve_at(curve, u);
    }
    return u;
}

/// Does to values what one law does; `n`: its numbers.
template <class Real>
[[gnu::always_inline]] inline void apply_law(const LawKind& kind, const Real* n,
                                             const LawMoment<Real>& now, const LawInput<Real>& at,
                                             Real* values) {
    constexpr auto kFirst = static_cast<int>(Quantity::adhesion);
    const int slot = static_cast<int>(kind.quantity) - kFirst;
    Real& value = values[slot > 0 ? slot : 0];
    const Real form = form_at(kind.form, at.at(kind.argument, now) * n[1], n + 2);
    value = kind.acts == Acts::adds ? fma(n[0], form, value)
                                    : value * greater(Real(0.0), fma(n[0], form, Real(1.0)));
}

/// Does to values what laws of any kind do, from the first to before the last of a table. Apart:
/// within the formulas of a step it would be there a dozen times.
template <class Real>
[[gnu::noinline]] void apply_any(const LawTable& table, const Real* numbers, std::size_t first,
                                 std::size_t last, const LawMoment<Real>& now,
                                 const LawInput<Real>& at, Real* values) {
    for (std::size_t i = first; i < last; ++i) {
        apply_law(table.kinds[i], numbers + table.place[i], now, at, values);
    }
}
/// The same. Cold, so that the compiler moves the call aside and spares it no registers.
template <class Real>
[[gnu::noinline, gnu::cold]] void go_apply_any(const LawTable& table, const Real* numbers,
                                               std::size_t first, std::size_t last,
                                               const LawMoment<Real>& now, const LawInput<Real>& at,
                                               Real* values) {
    apply_any(table, numbers, first, last, now, at, values);
}

/// Laws with their numbers, of a run or a pack of runs.
template <class Real>
class Laws {
public:
    [[gnu::always_inline]] Laws(const LawTable& table, const Real* numbers,
                                const LawMoment<Real>& now)
        : table_(table), numbers_(numbers), now_(now) {}

    template <Quantity kFirst, Quantity kLast = kFirst>
    [[gnu::always_inline]] bool has() const {
        return begin<kFirst>() < end<kLast>();
    }
    /// Does to values what the laws of some quantities do. In place: an array that is copied as a
    /// whole waits for all that was written to it.
    template <Quantity kFirst, Quantity kLast, std::size_t N>
    [[gnu::always_inline]] void apply(const LawInput<Real>& at, std::array<Real, N>& values) const {
        if (table_.only_named) [[likely]] {
            const auto each = [&]<std::size_t K>(std::integral_constant<std::size_t, K>)
                __attribute__((always_inline)) {
                constexpr LawKind kKind = kNamedKinds[K];
                if constexpr (kKind.quantity >= kFirst && kKind.quantity <= kLast) {
                    const int place = table_.place_of_named[K];
                    if (place < 0) return;
                    apply_law(kKind, numbers_ + place, now_, at, values.data());
                }
            };
            [&]<std::size_t... K>(std::index_sequence<K...>) __attribute__((always_inline)) {
                (each(std::integral_constant<std::size_t, K>()), ...);
            }
            (std::make_index_sequence<kNamedKinds.size()>());
            return;
        }
        // Copies, so that those above need not be in memory.
        const LawInput<Real> input = at;
        std::array<Real, N> result;
        for (std::size_t i = 0; i < N; ++i) result[i] = values[i];
        go_apply_any(table_, numbers_, begin<kFirst>(), end<kLast>(), now_, input, result.data());
        for (std::size_t i = 0; i < N; ++i) values[i] = result[i];
    }

    /// Static friction coefficient at x (m), but for laws of sign and load.
    [[gnu::always_inline]] Real static_coefficient(Real coefficient, Real x,
                                                   const PoseOf<Real>& pose, Real tau) const {
        return friction<Quantity::friction>(coefficient, {.tau = tau, .pose = pose, .place = x});
    }
    /// Kinetic friction coefficient at x (m), but for laws of the load. slip_velocity: m/s.
    [[gnu::always_inline]] Real kinetic_coefficient(Real coefficient, Real slip_sign,
                                                    Real slip_velocity, Real x,
                                                    const PoseOf<Real>& pose, Real tau) const {
        const Real alone = friction<Quantity::sliding_friction, Quantity::friction>(
            coefficient,
            {.tau = tau, .pose = pose, .slip_speed = magnitude(slip_velocity), .place = x});
        return directional(alone, slip_sign);
    }
    /// Laws of the sign have one form, so that they need not be apart.
    [[gnu::always_inline]] Real directional(Real coefficient, Real slip_sign) const {
        constexpr Quantity kSigned = Quantity::directional_friction;
        const LawInput<Real> at = {.slip_sign = slip_sign};
        for (std::size_t i = begin<kSigned>(); i < end<kSigned>(); ++i) {
            const LawKind kind = {kSigned, table_.kinds[i].acts, Argument::slip_sign, Form::line};
            apply_law(kind, numbers_ + table_.place[i], now_, at, &coefficient);
        }
        return coefficient;
    }
    [[gnu::always_inline]] Real load_dependent(Real coefficient, Real normal) const {
        return friction<Quantity::friction_by_load>(coefficient, {.load = normal});
    }

    struct Forces {
        Real adhesion;         ///< N
        Real drag;             ///< N s/m
        Real rotational_drag;  ///< N m s
    };
    [[gnu::always_inline]] Forces forces(const Forces& plain, const PoseOf<Real>& pose, Real tau,
                                         Real speed_squared, Real omega) const {
        if (!has<Quantity::adhesion, Quantity::fluid>()) return plain;
        std::array<Real, 4> values = {plain.adhesion, plain.drag, plain.rotational_drag, Real(1.0)};
        apply<Quantity::adhesion, Quantity::fluid>(
            {.tau = tau, .pose = pose, .speed_squared = speed_squared, .rate = omega}, values);
        return {values[0], values[1] * values[3], values[2] * values[3]};
    }

private:
    template <Quantity kQuantity>
    [[gnu::always_inline]] std::size_t begin() const {
        return table_.from[static_cast<std::size_t>(kQuantity)];
    }
    template <Quantity kQuantity>
    [[gnu::always_inline]] std::size_t end() const {
        return table_.from[static_cast<std::size_t>(kQuantity) + 1];
    }
    template <Quantity kFirst, Quantity kLast = kFirst>
    [[gnu::always_inline]] Real friction(Real coefficient, const LawInput<Real>& at) const {
        if (!has<kFirst, kLast>()) return coefficient;
        std::array<Real, 1> value = {coefficient};
        apply<kFirst, kLast>(at, value);
        return value[0];
    }

    const LawTable& table_;
    const Real* numbers_;
    const LawMoment<Real>& now_;
};

}  // namespace stickslip
