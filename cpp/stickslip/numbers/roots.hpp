#pragma once

#include <optional>

#include "stickslip/numbers/function_ref.hpp"

/// Roots and least values of functions of one number.
namespace stickslip {

/// Resolution of a root in a range of size one: a step, whose dense output is far less accurate.
inline constexpr double kRootResolution = 1e-12;

/// Two places with the values there, in which a function falls through zero.
struct Bracket {
    double low, high, at_low, at_high;

    /// A zero is a root.
    bool holds_root() const { return at_low > 0.0 && at_high <= 0.0; }
};

/// Root of `value(x)` in the bracket, to kRootResolution: its far side; none where the bracket's
/// ends do not have a root between them. The method is that of Chandrupatla, Advances in
/// Engineering Software 28 (1997) 145-149. After more iterations than it ever needs it bisects,
/// which ends whatever the function.
std::optional<double> find_root(const Bracket& bracket, FunctionRef<double(double)> value);

/// Root of a function whose signs at `low` and `high` differ or are zero, to 1e-12.
double find_root(double low, double high, FunctionRef<double(double)> value);

/// Asks `found(low, high)` of arcs between two angles, rad, from the one about `first` on to both
/// sides until all directions were asked for or it answers true; whether it did.
bool search_around(double first, FunctionRef<bool(double low, double high)> found);

/// A value of a function, and its argument.
struct Extreme {
    double at, value;
};

/// The least value of `f` from `low` to `high`, where it turns once in each of `parts` equal parts
/// or less. Towards an inner one the parabolas through three values are followed, as long as the
/// value that one promises is `worth` it.
Extreme least_value(double low, double high, int parts, FunctionRef<double(double)> f,
                    FunctionRef<bool(double)> worth);

}  // namespace stickslip
