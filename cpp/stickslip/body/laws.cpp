#include "stickslip/body/laws.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

namespace stickslip {
namespace {

static_assert(std::is_sorted(kNamedKinds.begin(), kNamedKinds.end()));
static_assert(std::size(LawTable().place_of_named) == kNamedKinds.size());

constexpr double kEndless = std::numeric_limits<double>::infinity();

std::size_t numbers_of(Form form) {
    return form == Form::curve ? 2 + kCurveNumbers : 2;
}

double largest_of(Argument argument) {
    switch (argument) {
        case Argument::slip_sign:
        case Argument::sine:
        case Argument::cosine:
            return 1.0;
        case Argument::tilt:
            return 2.0 * kQuarterTurn;
        default:
            return kEndless;
    }
}

// Bounds of a form.
struct Range {
    double low, high;
};
// Knots bound a curve but for how far it swings beyond them, which matters only to a sum: a factor
// is cut off at zero. A cubic lies among the four points of its Bernstein form.
Range range_of(const FreeShape& shape, Acts acts) {
    Range range = {0.0, 0.0};
    const auto reach = [&](double value) {
        range = {std::min(range.low, value), std::max(range.high, value)};
    };
    const FreeCurve curve(shape);
    const double* value = curve.numbers().data() + 2;
    const double* slope = value + kCurveValues;
    for (std::size_t i = 0; i < kCurveValues; ++i) {
        reach(value[i]);
        if (acts == Acts::multiplies) continue;
        if (i > 0) reach(value[i] - slope[i] / 3.0);
        if (i + 1 < kCurveValues) reach(value[i] + slope[i] / 3.0);
    }
    return range;
}

Range range_of(const Law& law) {
    const double most = largest_of(law.kind.argument) / std::abs(law.scale);
    const bool has_sign = law.kind.argument <= Argument::cosine &&  //
                          law.kind.argument != Argument::slip_speed;
    switch (law.kind.form) {
        case Form::line:
            return {has_sign ? -most : 0.0, most};
        case Form::square:
            return {0.0, most * most};
        case Form::logarithm:
            return {0.0, std::log1p(most)};
        case Form::wave:
            return {-1.0, 1.0};
        case Form::curve:
            return range_of(law.curve, law.kind.acts);
        case Form::gaussian:
        case Form::exponential:
        case Form::saturation:
            break;
    }
    return {0.0, 1.0};
}

bool exists(const LawKind& kind) {
    if (!has_argument(kind.quantity, kind.argument)) return false;
    // Force and torque have two units.
    if (kind.quantity == Quantity::fluid && kind.acts == Acts::adds) return false;
    // Impacts and slip along a vector interpolate between the two ways.
    if (kind.argument == Argument::slip_sign && kind.form != Form::line) return false;
    // In an impact it is infinite.
    return kind.argument != Argument::load || is_bounded(kind.form);
}

}  // namespace

bool has_argument(Quantity quantity, Argument argument) {
    switch (argument) {
        case Argument::slip_sign:
            return quantity == Quantity::directional_friction;
        case Argument::load:
            return quantity == Quantity::friction_by_load;
        // Friction that sticks has none; over all else static friction changes too.
        case Argument::slip_speed:
            return quantity == Quantity::sliding_friction;
        case Argument::place:
            return quantity == Quantity::friction;
        case Argument::age:
        case Argument::speed:
        case Argument::rate:
            return quantity >= Quantity::adhesion;
        case Argument::tilt:
        case Argument::sine:
        case Argument::cosine:
        case Argument::time:
            break;
    }
    return quantity == Quantity::friction || quantity >= Quantity::adhesion;
}

bool is_bounded(Form form) {
    return form == Form::gaussian || form == Form::exponential || form == Form::saturation ||
           form == Form::curve;
}

bool LawTable::merge(const LawTable& other, std::size_t most_numbers) {
    std::vector<LawKind> all;
    std::set_union(kinds, kinds + count, other.kinds, other.kinds + other.count,
                   std::back_inserter(all));
    if (all.size() > kMost) return false;
    LawTable merged;
    for (const LawKind& kind : all) {
        const std::size_t begin = merged.numbers();
        const auto named = std::find(kNamedKinds.begin(), kNamedKinds.end(), kind);
        if (named == kNamedKinds.end()) {
            merged.only_named = false;
        } else {
            merged.place_of_named[named - kNamedKinds.begin()] = static_cast<short>(begin);
        }
        merged.kinds[merged.count++] = kind;
        merged.place[merged.count] = static_cast<unsigned short>(begin + numbers_of(kind.form));
        for (std::size_t q = static_cast<std::size_t>(kind.quantity); q < kQuantities; ++q) {
            ++merged.from[q + 1];
        }
    }
    if (merged.numbers() > most_numbers) return false;
    *this = merged;
    return true;
}

LawSet::LawSet(std::vector<Law> laws) : laws_(std::move(laws)) {
    if (laws_.size() > LawTable::kMost) {
        throw std::invalid_argument(std::to_string(laws_.size()) +
                                    " laws, those of effects too: allowed "
                                    "are at most " +
                                    std::to_string(LawTable::kMost));
    }
    // An insertion sort: few laws, and alike ones keep their order.
    const auto before = [](const Law& a, const Law& b) { return a.kind < b.kind; };
    for (auto law = laws_.begin(); law != laws_.end(); ++law) {
        std::rotate(std::upper_bound(laws_.begin(), law, *law, before), law, std::next(law));
    }
    for (std::size_t i = 0; i < laws_.size(); ++i) {
        Law& law = laws_[i];
        if (!exists(law.kind)) throw std::invalid_argument("there is no such law");
        if (i > 0) {
            LawKind next = laws_[i - 1].kind;
            next.copy = law.kind.copy;
            if (next == law.kind) law.kind.copy = laws_[i - 1].kind.copy + 1;
        }
        LawTable one;
        one.kinds[one.count++] = law.kind;
        table_.merge(one);
        numbers_.push_back(law.amplitude);
        if (law.kind.form == Form::curve) {
            const FreeCurve curve(law.curve);
            numbers_.push_back(curve.per_spacing());
            numbers_.insert(numbers_.end(), curve.numbers().begin(), curve.numbers().end());
        } else {
            numbers_.push_back(1.0 / law.scale);
        }
    }
}

double Law::lowest() const {
    if (amplitude == 0.0) return 0.0;
    const Range range = range_of(*this);
    return amplitude * (amplitude < 0.0 ? range.high : range.low);
}

double Law::at_zero() const {
    const bool is_one = kind.form == Form::gaussian || kind.form == Form::exponential;
    const double own = kind.form == Form::curve ? FreeCurve(curve).at(0.0) : 0.0;
    return amplitude * (is_one ? 1.0 : own);
}

double Law::largest(double argument) const {
    const Range range = range_of(*this);
    const double u = argument / std::abs(scale);
    double most = std::max(-range.low, range.high);
    if (kind.form == Form::line) most = std::min(most, u);
    if (kind.form == Form::square) most = std::min(most, u * u);
    if (kind.form == Form::logarithm) most = std::min(most, std::log1p(u));
    return std::abs(amplitude) * most;
}

double Law::steepest(double argument) const {
    const bool falls = kind.form == Form::gaussian || kind.form == Form::exponential;
    if (falls && amplitude > 0.0) return 0.0;
    if (kind.form == Form::curve) {
        double last = curve.reach == FreeReach::anchored ? 0.0 : curve.knots[0], rise = 0.0;
        for (const double knot : curve.knots) {
            rise = std::max(rise, std::abs(knot - last));
            last = knot;
        }
        return std::abs(amplitude) * rise / FreeCurve(curve).spacing();
    }
    // Over the argument in scales, that of the bounded forms is at most about one.
    const double slope = kind.form == Form::square ? 2.0 * argument / std::abs(scale) : 1.0;
    return std::abs(amplitude) * slope / std::abs(scale);
}

void Law::turn() {
    scale = -scale;
    std::reverse(curve.knots.begin(), curve.knots.end());
}

double LawSet::lowest(Quantity first, Quantity last, double base) const {
    double result = base;
    for (const Law& law : laws_) {
        if (law.kind.quantity < first || law.kind.quantity > last) continue;
        if (result == -kEndless) break;
        const double lowered = std::min(law.lowest(), 0.0);
        if (law.kind.acts == Acts::adds) {
            result += lowered;
        } else {
            result *= std::max(1.0 + lowered, 0.0);
        }
    }
    return result;
}

double LawSet::least_time() const {
    double result = kEndless;
    for (const Law& law : laws_) {
        const bool moves =
            law.kind.argument == Argument::time || law.kind.argument == Argument::age;
        // A logarithm that ages never turns back.
        if (!moves || law.kind.form == Form::logarithm) continue;
        const bool is_curve = law.kind.form == Form::curve;
        result = std::min(result, is_curve ? FreeCurve(law.curve).spacing() : law.scale);
    }
    return result;
}

}  // namespace stickslip
