#include "stickslip/numbers/roots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stickslip {

std::optional<double> find_root(const Bracket& bracket, FunctionRef<double(double)> value) {
    constexpr int kUsual = 80, kMost = kUsual + 50;  // 40 halvings reach the resolution
    if (!bracket.holds_root()) return std::nullopt;
    double x1 = bracket.high, f1 = bracket.at_high, x2 = bracket.low, f2 = bracket.at_low;
    if (f1 == 0.0) return x1;
    double part = f1 / (f1 - f2);
    for (int k = 0; k < kMost; ++k) {
        const double x = x1 + part * (x2 - x1);
        const double f = value(x);
        double x3 = x1, f3 = f1;
        if ((f > 0.0) != (f1 > 0.0)) {
            x3 = x2, f3 = f2;
            x2 = x1, f2 = f1;
        }
        x1 = x, f1 = f;
        const double least = kRootResolution / std::abs(x2 - x1);
        if (f1 == 0.0) return x1;
        if (least > 0.5) return f1 > 0.0 ? x2 : x1;
        part = 0.5;
        if (k >= kUsual) continue;
        const double xi = (x1 - x2) / (x3 - x2), phi = (f1 - f2) / (f3 - f2);
        if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
            part = f1 / (f2 - f1) * f3 / (f2 - f3) +
                   (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2);
        }
        part = std::clamp(part, least, 1.0 - least);
    }
    return f1 > 0.0 ? x2 : x1;
}

double find_root(double low, double high, FunctionRef<double(double)> value) {
    const double at_low = value(low), at_high = value(high), sign = at_low > 0.0 ? 1.0 : -1.0;
    return find_root(Bracket{low, high, sign * at_low, sign * at_high},
                     [&](double x) { return sign * value(x); })
        .value_or(low);
}

bool search_around(double first, FunctionRef<bool(double low, double high)> found) {
    constexpr int kArcs = 32;
    constexpr double kArc = 2.0 * std::numbers::pi / kArcs;
    for (int n = 0; n < kArcs; ++n) {
        const int away = (n + 1) / 2;
        const double side = (n % 2 == 0 ? 1.0 : -1.0) * away * kArc;
        if (found(first + side - 0.5 * kArc, first + side + 0.5 * kArc)) return true;
    }
    return false;
}

Extreme least_value(double low, double high, int parts, FunctionRef<double(double)> f,
                    FunctionRef<bool(double)> worth) {
    constexpr int kMost = 40;
    constexpr double kUntold = 0.1;  // of a half, by which a parabola's turn may be wrong; chosen
    const auto least_of = [](const Extreme& a, const Extreme& b) {
        return b.value < a.value ? b : a;
    };
    Extreme best = {low, f(low)};
    Extreme left = best;
    for (int part = 0; part < parts; ++part) {
        const double begin = left.at, end = low + (high - low) * (part + 1) / parts;
        const double half = 0.5 * (begin + end);
        std::array<Extreme, 3> x = {left, {half, f(half)}, {end, f(end)}};
        left = x[2];
        best = least_of(best, least_of(x[1], x[2]));
        for (int k = 0; k < kMost; ++k) {
            // Parabola f = f1 + slope d + curve d^2 through the three points, d from the middle.
            const double d0 = x[0].at - x[1].at, d2 = x[2].at - x[1].at;
            if (!(d0 < 0.0 && d2 > 0.0)) break;
            const double r0 = (x[0].value - x[1].value) / d0, r2 = (x[2].value - x[1].value) / d2;
            const double curve = (r2 - r0) / (d2 - d0), slope = r0 - curve * d0;
            double next = x[1].at - 0.5 * slope / curve;
            if (!(curve > 0.0 && next > x[0].at && next < x[2].at)) {
                // It is at an end, or so near to one that the parabola does not tell. A second
                // parabola that turns far beyond the end, or the other way, tells.
                const Extreme& side = slope < 0.0 ? x[2] : x[0];
                const double d = side.at - x[1].at, apart = kUntold * d;
                const bool tells = std::abs(slope + 2.0 * curve * d) > std::abs(curve * d);
                if ((k > 0 && tells) || !worth(side.value - std::abs(curve) * apart * apart)) break;
                next = 0.5 * (x[1].at + side.at);
            } else if (!worth(x[1].value - 0.25 * slope * slope / curve)) {
                break;
            }
            // Neither the middle again, nor so near to an end that the parabola stays.
            const double margin = 1e-3 * (x[2].at - x[0].at);
            next = std::clamp(next, x[0].at + margin, x[2].at - margin);
            if (std::abs(next - x[1].at) < margin) {
                next = x[1].at + (d2 > -d0 ? margin : -margin);
            }
            const Extreme found = {next, f(next)};
            best = least_of(best, found);
            const bool is_later = found.at > x[1].at;
            if (found.value < x[1].value) {
                x = is_later ? std::array{x[1], found, x[2]} : std::array{x[0], found, x[1]};
            } else {
                (is_later ? x[2] : x[0]) = found;
            }
        }
    }
    return best;
}

}  // namespace stickslip
