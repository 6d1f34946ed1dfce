#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stickslip/drive/circuit.hpp"
#include "stickslip/numbers/elementary.hpp"
#include "stickslip/numbers/roots.hpp"

/// Turning points of currents and field over a segment of voltage: sums of a line and exponentials.
namespace stickslip {

/// Widths of the parts of a segment between two looks at its exponentials, which fade from its
/// start: of the fastest one's time constant, and of the time since the start. A cubic through the
/// values and slopes at the ends of such a part misses 1e-5 of what the exponentials change. What
/// swings is looked at as often until it has faded.
inline constexpr double kTurningLook = 0.3;

/// Calls `use(tau)` where each part of a segment ends, s from its start.
void for_each_part(const CurrentSegment& segment, auto&& use) {
    // An exponential that fades within the rounding of the segment's times, as at a rate that
    // overflowed, is not seen.
    const double least = std::max(1.0 / segment.fastest(), 1e-16 * segment.duration);
    // A swing far too fast for the segment, as with almost no capacitance, is sampled coarsely.
    constexpr double kFinest = 1e-5;  // of the segment; chosen: milliseconds of work
    const double swing = std::max(least, kFinest * segment.duration);
    double swings_until = 0.0;  // s
    segment.each_swing([&](std::size_t, const Swing& each) {
        constexpr double kFaded = 37.0;  // exp(-37) is below rounding
        if (each.square() > 0.0) swings_until = std::max(swings_until, kFaded / each.rate);
    });
    double tau = 0.0;
    while (tau < segment.duration) {
        tau += kTurningLook * (tau < swings_until ? swing : std::max(least, tau));
        // Not a last part that is far shorter than the others.
        if (tau > 0.95 * segment.duration) tau = segment.duration;
        use(tau);
    }
}

/// Calls `use(tau)` where a sum of the functions of a segment turns, s from the start. c: its
/// coefficients, as of the currents.
void for_each_turn(const CurrentSegment& segment, const CurrentFunctions::Values& c, auto&& use) {
    int count = 0;
    std::size_t only = 0;
    for (std::size_t b = 2; b < segment.count(); ++b) {
        if (c[b] != 0.0) ++count, only = b;
    }
    if (count == 0) return;
    if (count == 1 && only < segment.place(0)) {
        const double rate = segment.rate[only - 2], ratio = c[only] * rate / c[1];
        if (!(ratio > 1.0) || !std::isfinite(ratio)) return;
        const double turn = std::log(ratio) / rate;
        if (turn < segment.duration) use(turn);
        return;
    }
    // The slope and its own slope, A/s and A/s^2.
    const CurrentFunctions::Values slopes = segment.slope_of(c), bends = segment.slope_of(slopes);
    const auto slope = [&](double tau) { return segment.sum(slopes, tau); };
    const auto bend = [&](double tau) { return segment.sum(bends, tau); };
    double from = 0.0, before = slope(0.0), bend_before = bend(0.0);
    for_each_part(segment, [&](double to) {
        const double after = slope(to), bend_after = bend(to);
        if ((before > 0.0) != (after > 0.0)) {
            use(find_root(from, to, slope));
        } else if (before * bend_before < 0.0 && after * bend_after > 0.0) {
            // It comes nearer to zero and goes away again: it may have been beyond.
            const double nearest = find_root(from, to, bend);
            if ((slope(nearest) > 0.0) != (before > 0.0)) {
                use(find_root(from, nearest, slope));
                use(find_root(nearest, to, slope));
            }
        }
        from = to, before = after, bend_before = bend_after;
    });
}

/// The same of the current of a coil.
void for_each_turn(const CurrentSegment& segment, std::size_t coil, auto&& use) {
    CurrentFunctions::Values c;
    for (std::size_t b = 0; b < segment.count(); ++b) c[b] = segment.coil[b][coil];
    for_each_turn(segment, c, use);
}

/// The field at one place in the course of a segment, of coils that nothing else multiplies.
struct FieldCourse {
    using Vector = std::array<double, 3>;

    const CurrentSegment* segment = nullptr;
    std::array<Vector, kMaxBasis> basis = {};  ///< T, by the functions of the currents
    /// T/m in the same way: dB_x/dx, dB_x/dy, dB_x/dz, dB_y/dy, dB_y/dz, dB_z/dz; the curl is zero.
    std::array<std::array<double, 6>, kMaxBasis> gradient = {};
};

/// A span of a segment in which |B| may have an extreme at a robot that moves, s from its start.
struct FieldTurn {
    double from = 0.0, to = 0.0;
};

/// Spans in which |B| may turn at a robot that moves from that place at no more than `speed` (m/s):
/// those in which the currents change it no faster than the motion may. Calls `use(turn, least,
/// most)` with bounds of |B| there, T. Between two such spans |B| only rises or only falls.
void for_each_field_turn(const FieldCourse& course, double speed, auto&& use) {
    struct Look {
        double square, slope;  // of |B|^2: T^2, T^2/s
    };
    const CurrentSegment& segment = *course.segment;
    const std::size_t count = segment.count();
    const auto look = [&](double tau) {
        const CurrentFunctions::Values value = segment.values(tau), change = segment.changes(value);
        FieldCourse::Vector b = course.basis[0], slope = course.basis[1];
        for (std::size_t i = 0; i < b.size(); ++i) b[i] += tau * course.basis[1][i];
        for (std::size_t j = 2; j < count; ++j) {
            for (std::size_t i = 0; i < b.size(); ++i) {
                b[i] += value[j] * course.basis[j][i];
                slope[i] += change[j] * course.basis[j][i];
            }
        }
        return Look{b[0] * b[0] + b[1] * b[1] + b[2] * b[2],
                    2.0 * (b[0] * slope[0] + b[1] * slope[1] + b[2] * slope[2])};
    };
    const auto squared_gradient = [&](double tau) {
        const CurrentFunctions::Values value = segment.values(tau);
        std::array<double, 6> sum = {};
        for (std::size_t j = 0; j < count; ++j) {
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += value[j] * course.gradient[j][i];
        }
        const auto [xx, xy, xz, yy, yz, zz] = sum;
        return xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz);
    };
    // The gradient between the ends of the segment, or away from the place, may be larger.
    constexpr double kMore = 1.5;
    const double squares = std::max(squared_gradient(0.0), squared_gradient(segment.duration));
    const double drift = kMore * std::sqrt(squares) * speed;  // T/s

    // The first s from 0 to 1 at which a + b s + c s^2 is within `bound` of zero, or 2.
    const auto first_within = [](double a, double b, double c, double bound) {
        if (std::abs(a) <= bound) return 0.0;
        const double sign = a > 0.0 ? 1.0 : -1.0;
        const double over = sign * a - bound, rise = sign * b, bend = sign * c;
        const double root = rise * rise - 4.0 * over * bend;
        const double denominator = root < 0.0 ? 0.0 : std::sqrt(root) - rise;
        const double s = denominator > 0.0 ? 2.0 * over / denominator : 2.0;
        return s <= 1.0 ? s : 2.0;
    };
    double from = 0.0;
    Look before = look(0.0);
    for_each_part(segment, [&](double to) {
        const Look after = look(to);
        const double width = to - from;
        // The slope by the part's fraction s as a parabola with the same ends and the same mean.
        const double rise = after.square - before.square;
        const double a = before.slope * width, z = after.slope * width;
        const double b = 6.0 * rise - 4.0 * a - 2.0 * z, c = 3.0 * (a + z) - 6.0 * rise;
        const double larger = std::max(before.square, after.square);
        const double bound = 2.0 * std::sqrt(larger) * drift * width;
        const double first = first_within(a, b, c, bound);
        if (first <= 1.0) {
            const double last =
                1.0 - std::min(first_within(z, -b - 2.0 * c, c, bound), 1.0 - first);
            const auto square = [&](double s) {
                return before.square + s * (a + s * (b / 2.0 + s * c / 3.0));
            };
            const double middle = 0.5 * (first + last);
            const double steepest = std::max(bound, std::abs(a + middle * (b + middle * c)));
            // Margins for the cubic's error: on the square of the field, and on the span.
            constexpr double kMissed = 1e-4, kPad = 0.05;
            const double more = steepest * (last - first) + kMissed * larger;
            const double low = std::min(square(first), square(last)) - more;
            const double high = std::max(square(first), square(last)) + more;
            const double moved = drift * to;
            use(FieldTurn{from + std::max(first - kPad, 0.0) * width,
                          from + std::min(last + kPad, 1.0) * width},
                std::max(std::sqrt(std::max(low, 0.0)) - moved, 0.0), std::sqrt(high) + moved);
        }
        from = to, before = after;
    });
}

}  // namespace stickslip
