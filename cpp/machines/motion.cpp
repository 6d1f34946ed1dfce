#include "machines/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace machines {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
// Relative tolerance of gap and place: within it a mass that has just left has not come again.
constexpr double kRounding = 1e-12;

int sign(double value) {
    return (value > 0.0) - (value < 0.0);
}

}  // namespace

OneMass::OneMass(const MotionTerms& terms) : c(terms) {
    dry = c.rate_asymmetry != 0.0 || c.quadratic != 0.0 || c.coulomb != 0.0 || c.asymmetry != 0.0 ||
          c.stribeck != 0.0;
    linear = c.quadratic == 0.0 && c.cubic_damping == 0.0 && c.square == 0.0 && c.cubic == 0.0 &&
             c.gravity == 0.0 && c.swing == 0.0 && c.stribeck == 0.0;
    weakens = c.stribeck != 0.0 ? c.stribeck / c.stribeck_speed : 0.0;
    const double turns = std::sqrt(std::abs(c.stiffness) + std::abs(c.gravity));
    fastest = turns + c.rate + std::abs(c.rate_asymmetry);
}

double OneMass::fastest_at(double x, double v, double u) const {
    const double turns = std::abs(c.swing * u) + std::abs((2.0 * c.square + 3.0 * c.cubic * x) * x);
    return fastest + weakens + std::sqrt(turns) + 2.0 * std::abs(c.quadratic * v) +
           3.0 * std::abs(c.cubic_damping) * v * v;
}

double OneMass::driving(double x, double v, double u) const {
    if (c.swing != 0.0) u *= std::cos(x);
    return u - c.cubic_damping * v * v * v - c.rate * v;
}

double OneMass::loading(double x) const {
    const double hangs = c.gravity != 0.0 ? c.gravity * std::sin(x) : 0.0;
    return c.load + c.stiffness * x + (c.square + c.cubic * x) * x * x + hangs;
}

double OneMass::friction(double v, int s) const {
    double result = s * std::max(c.coulomb + s * c.asymmetry, 0.0);
    if (c.stribeck != 0.0) {
        const double part = v / c.stribeck_speed;
        result += s * c.stribeck * std::exp(-part * part);
    }
    return result + s * (c.rate_asymmetry + c.quadratic * v) * v;
}

double OneMass::held(double force) const {
    const int s = sign(force);
    return s * friction(0.0, s) - std::abs(force);
}

int OneMass::way(double force) const {
    return held(force) < 0.0 ? sign(force) : 0;
}

OneMass::State OneMass::rate(const State& z, const Input& u, const Mode& mode) const {
    const int s = mode[0];
    if (s == 0) return {0.0, 0.0};
    return {z[1], driving(z[0], z[1], u[0]) - loading(z[0]) - friction(z[1], s)};
}

std::array<double, 1> OneMass::margins(const State& z, const Input& u, const Mode& mode) const {
    if (!dry) return {kEndless};
    return {mode[0] != 0 ? mode[0] * z[1] : held(driving(z[0], 0.0, u[0]) - loading(z[0]))};
}

std::array<double, 1> OneMass::falls(const State& z, const Input& u, const Input&,
                                     const Mode& mode) const {
    return {dry && mode[0] != 0 ? -mode[0] * rate(z, u, mode)[1] : 0.0};
}

OneMass::Point OneMass::begun(const State& z, const Input& u) const {
    const int s = sign(z[1]);
    return driven(z, u, {s != 0 ? s : static_cast<int>(!dry)});
}

OneMass::Point OneMass::driven(const State& z, const Input& u, const Mode& mode) const {
    if (mode[0] != 0) return {z, mode};
    return {z, {way(driving(z[0], 0.0, u[0]) - loading(z[0]))}};
}

OneMass::Point OneMass::after(const State& z, const Input& u, const Mode& mode, std::size_t) const {
    if (mode[0] == 0) return {z, {sign(driving(z[0], 0.0, u[0]) - loading(z[0]))}};
    return driven({z[0], 0.0}, u, {0});
}

TwoMasses::TwoMasses(const MotionTerms& terms) : OneMass(terms), hard(terms.spring == 0.0) {
    const double small = c.share * (1.0 - c.share);
    fastest /= std::sqrt(small);
    fastest += std::sqrt(c.spring / small) + c.damping / small;
}

double TwoMasses::fastest_at(const State& z, const Input& u, const Mode&) const {
    const double least = std::min(c.share, 1.0 - c.share);
    return OneMass::fastest_at(std::max(std::abs(z[0]), std::abs(z[2])), z[1], u[0]) / least;
}

TwoMasses::Pulls TwoMasses::pulls(const State& z, const Input& u, const Mode& mode) const {
    const auto [x, v, y, w] = z;
    const auto [s, contact] = mode;
    const double pulled = driving(x, v, u[0]) - friction(v, s);
    const double load = loading(y);
    if (contact == 0) return {pulled, 0.0, load};
    if (hard) return {pulled, (s != 0 ? c.share * (pulled - load) : 0.0) + load, load};
    return {pulled, c.spring * (x - y - contact * c.gap) + c.damping * (v - w), load};
}

TwoMasses::State TwoMasses::rate(const State& z, const Input& u, const Mode& mode) const {
    const Pulls p = pulls(z, u, mode);
    const double of_load = (p.between - p.load) / c.share;
    if (mode[0] == 0) return {0.0, 0.0, z[3], of_load};
    return {z[1], (p.motor - p.between) / (1.0 - c.share), z[3], of_load};
}

std::array<double, 2> TwoMasses::margins(const State& z, const Input& u, const Mode& mode) const {
    const auto [x, v, y, w] = z;
    const auto [s, contact] = mode;
    double rests = kEndless, meets = kEndless;
    const bool pulls_it = contact != 0 && (hard || s == 0);
    const double between = pulls_it ? pulls(z, u, mode).between : 0.0;
    if (s == 0) {
        rests = held(driving(x, 0.0, u[0]) - between);
    } else if (dry) {
        rests = s * v;
    }
    if (contact == 0) {
        meets = c.gap - std::abs(x - y) + kRounding * (c.gap + std::abs(x));
    } else if (c.gap != 0.0) {
        meets = hard ? contact * between : contact * (x - y) - c.gap;
    }
    return {rests, meets};
}

std::array<double, 1> TwoMasses::falls(const State& z, const Input& u, const Input&,
                                       const Mode& mode) const {
    return {dry && mode[0] != 0 ? -mode[0] * rate(z, u, mode)[1] : 0.0};
}

TwoMasses::Point TwoMasses::begun(const State& z, const Input& u) const {
    const int side = std::signbit(u[0]) ? -1 : 1, s = sign(z[1]);
    return driven({z[0], z[1], z[0] - side * c.gap, z[1]}, u,
                  {s != 0 ? s : static_cast<int>(!dry), side});
}

TwoMasses::Point TwoMasses::driven(const State& z, const Input& u, const Mode& mode) const {
    const auto [rests, meets] = margins(z, u, mode);
    if (std::min(rests, meets) >= 0.0) return {z, mode};
    auto [s, contact] = mode;
    const double motor = driving(z[0], 0.0, u[0]);
    if (s == 0) s = way(motor - pulls(z, u, mode).between);
    if (hard && contact * pulls(z, u, {s, contact}).between < 0.0) {
        // A motor that its load leaves may stay behind.
        contact = 0;
        if (z[1] == 0.0) s = way(motor);
    }
    return {z, {s, contact}};
}

TwoMasses::Point TwoMasses::after(const State& z, const Input& u, const Mode& mode,
                                  std::size_t hit) const {
    auto [x, v, y, w] = z;
    auto [s, contact] = mode;
    if (hit == 0 && s != 0) {
        v = 0.0;
        s = 0;
        if (contact != 0 && hard) w = 0.0;
    } else if (hit == 0) {
        s = sign(driving(x, 0.0, u[0]) - pulls(z, u, mode).between);
    } else {
        const int side = contact != 0 ? contact : sign(x - y);
        y = x - side * c.gap;
        contact = contact != 0 ? 0 : side;
        if (contact != 0 && hard) {
            v = w = (1.0 - c.share) * v + c.share * w;
            s = sign(v);
        }
    }
    return driven({x, v, y, w}, u, {s, contact});
}

}  // namespace machines
