#include "stickslip/solver/event_location.hpp"

#include <algorithm>

#include "stickslip/numbers/roots.hpp"

namespace stickslip {
namespace {

using Samples = EventSamples<1>;
using Value = FunctionRef<double(double)>;

// Not positive at the end: where may a root before `s` be? Where the stages do not simply fall,
// looks on the way, so that of several roots the first is found.
void narrow(const Samples& g, Value value, double s, Bracket& bracket) {
    if (s < 1.0) {
        bracket.high = s;
        bracket.at_high = value(s);
    }
    const bool falls = g.start[0] > g.early[0] && g.early[0] > g.late[0] && g.late[0] > g.end[0] &&
                       g.start_slope(0) < 0.0;
    if (falls) return;
    for (const double at : {1.0 / 3.0, 2.0 / 3.0}) {
        if (at >= bracket.high) break;
        const double there = value(at);
        (there > 0.0 ? bracket.low : bracket.high) = at;
        (there > 0.0 ? bracket.at_low : bracket.at_high) = there;
    }
}

bool rises_briefly(Value value, Bracket& bracket) {
    constexpr int kHalvings = 24;
    double s = bracket.high;
    for (int k = 0; k < kHalvings; ++k) {
        s *= 0.5;
        const double there = value(s);
        (there > 0.0 ? bracket.low : bracket.high) = s;
        (there > 0.0 ? bracket.at_low : bracket.at_high) = there;
        if (there > 0.0) return true;
    }
    return false;
}

// Born at zero or below: false if it falls from there. Where it rises and falls
// again, the bracket holds its root; where it does not, the bracket holds none.
bool risen(const Samples& g, Value value, Bracket& bracket) {
    bracket.at_low = 0.0;
    for (const double at : {1.0 / 3.0, 2.0 / 3.0, 1.0}) {
        const double there = at == 1.0 ? g.end[0] : value(at);
        const bool has_risen = bracket.low > 0.0;
        if (there > 0.0) {
            bracket.low = at;
            bracket.at_low = there;
        } else if (!has_risen && (there == 0.0 || there > g.start[0])) {
            continue;  // below by more than rounding, it may be on its way up
        } else {
            bracket.high = at;
            bracket.at_high = there;
            return has_risen || rises_briefly(value, bracket);
        }
    }
    return true;
}

// A look or two settles most alarms. Where only a stage was negative (stages are not near the
// solution), the dense output well above the lower end at both looks; where the slopes gave the
// alarm, a parabola through a look at the tangents' meeting that stays well above zero.
bool clearly_above(const Samples& g, Value value) {
    const double falling = g.start_slope(0), rising = g.end_slope(0);
    if (!(falling < 0.0 && rising > 0.0)) {
        const double floor = 0.5 * std::min(g.start[0], g.end[0]);
        return g.early[0] > floor && g.late[0] > 0.0 && value(0.6) > floor && value(0.95) > floor;
    }
    const double s = std::clamp(g.tangents_meet(0, falling, rising), 0.02, 0.98);
    const double middle = value(s);
    // g = start + b s + c s^2 through the three.
    const double c = ((g.end[0] - g.start[0]) - (middle - g.start[0]) / s) / (1.0 - s);
    const double b = (middle - g.start[0]) / s - c * s;
    if (!(c > 0.0)) return middle > 0.0;
    return g.start[0] - b * b / (4.0 * c) > 0.5 * middle;
}

// Golden section, until a value is not positive or the curvature leaves no room for one.
bool close_in(Value value, Bracket around, Bracket& bracket) {
    constexpr double kGolden = 0.3819660112501051;
    constexpr int kMost = 40;
    double a = around.low, b = around.high, at_a = around.at_low, at_b = around.at_high;
    double c = a + kGolden * (b - a), d = b - kGolden * (b - a);
    double at_c = value(c), at_d = value(d);
    for (int iteration = 0; iteration < kMost; ++iteration) {
        if (at_c <= 0.0 || at_d <= 0.0) {
            const bool first = at_c <= 0.0;
            bracket = {around.low, first ? c : d, around.at_low, first ? at_c : at_d};
            return true;
        }
        const double left = ((at_d - at_c) / (d - c) - (at_c - at_a) / (c - a)) / (d - a);
        const double right = ((at_b - at_d) / (b - d) - (at_d - at_c) / (d - c)) / (b - c);
        const double sag = 0.5 * std::max(left, right) * (b - a) * (b - a);
        if (std::min(at_c, at_d) > sag) return false;
        if (at_c < at_d) {
            b = d, at_b = at_d, d = c, at_d = at_c;
            c = a + kGolden * (b - a), at_c = value(c);
        } else {
            a = c, at_a = at_c, c = d, at_c = at_d;
            d = b - kGolden * (b - a), at_d = value(d);
        }
    }
    return false;
}

// Looks for a value that is not positive on the dense output, by samples and then by closing in
// on the least.
bool find_dip(const Samples& g, Value value, Bracket& bracket) {
    if (clearly_above(g, value)) return false;
    constexpr std::size_t kSamples = 8;
    const auto at = [](std::size_t j) { return static_cast<double>(j) / kSamples; };
    std::array<double, kSamples + 1> sample;
    sample[0] = g.start[0];
    sample[kSamples] = g.end[0];
    std::size_t least = g.start[0] < g.end[0] ? 0 : kSamples;
    for (std::size_t j = 1; j < kSamples; ++j) {
        sample[j] = value(at(j));
        if (sample[j] <= 0.0) {
            bracket = {at(j - 1), at(j), sample[j - 1], sample[j]};
            return true;
        }
        if (sample[j] < sample[least]) least = j;
    }
    const std::size_t before = least == 0 ? 0 : least - 1;
    const std::size_t after = least == kSamples ? kSamples : least + 1;
    return close_in(value, {at(before), at(after), sample[before], sample[after]}, bracket);
}

}  // namespace

std::optional<double> first_fall(const EventSamples<1>& g, bool armed, bool stalled, double until,
                                 FunctionRef<double(double)> value) {
    Bracket bracket{0.0, 1.0, g.start[0], g.end[0]};
    if (!armed) {
        if (g.rises(0)) return std::nullopt;
        if (!risen(g, value, bracket)) return stalled ? 1.0 : 0.0;
    } else if (g.start[0] <= 0.0) {
        return 0.0;
    } else if (g.end[0] <= 0.0) {
        narrow(g, value, until, bracket);
    } else if (!g.may_dip(0) || !find_dip(g, value, bracket)) {
        return std::nullopt;
    }
    if (bracket.low >= until) return std::nullopt;
    return find_root(bracket, value);
}

EventHit find_fall(FunctionRef<double(double)> value) {
    Samples samples;
    samples.start = {value(0.0)};
    samples.early = {value(Samples::kEarly)};
    samples.late = {value(Samples::kLate)};
    samples.end = {value(1.0)};
    samples.lowest = {std::min({samples.start[0], samples.early[0], samples.late[0]})};
    const std::optional<double> s = first_fall(samples, true, false, 1.0, value);
    return s ? EventHit{0, *s} : EventHit{};
}

}  // namespace stickslip
