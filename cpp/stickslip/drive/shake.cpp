#include "stickslip/drive/shake.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "stickslip/drive/played_rows.hpp"
#include "stickslip/numbers/elementary.hpp"

namespace stickslip {
namespace {

using Point = Accelerations::Point;

// `t` s after the begin of the piece from a point to the next.
Point after(const Point& from, const Point& to, double t) {
    const double span = to.time - from.time;
    const double jx = (to.x - from.x) / span, jz = (to.z - from.z) / span;
    Point result;
    result.time = from.time + t;
    result.x = from.x + jx * t;
    result.z = from.z + jz * t;
    result.vx = from.vx + t * (from.x + 0.5 * jx * t);
    result.vz = from.vz + t * (from.z + 0.5 * jz * t);
    result.sx = from.sx + t * (from.vx + t * (0.5 * from.x + jx * t / 6.0));
    result.sz = from.sz + t * (from.vz + t * (0.5 * from.z + jz * t / 6.0));
    return result;
}

}  // namespace

Accelerations::Accelerations(std::vector<Point> points) : points_(std::move(points)) {
    check_rows("accelerations", points_, [](const Point& p) { return p.x + p.z; });
    const auto integrate = [this] {
        for (std::size_t i = 1; i < points_.size(); ++i) {
            const Point& from = points_[i - 1];
            Point& to = points_[i];
            const Point end = after(from, to, to.time - from.time);
            to.vx = end.vx, to.vz = end.vz, to.sx = end.sx, to.sz = end.sz;
        }
    };
    integrate();
    mean_ = {points_.back().vx / period(), points_.back().vz / period()};
    for (Point& point : points_) {
        point.x -= mean_[0];
        point.z -= mean_[1];
    }
    integrate();
    points_[0].vx = -points_.back().sx / period();
    points_[0].vz = -points_.back().sz / period();
    integrate();
}

Shake::Shake(const ShakeParameters& p, double sign)
    : accelerations_(p.accelerations), sign_(sign), frequency_(p.rate()), liquid_(p.liquid) {
    if (accelerations_) {
        bound();
        return;
    }
    const auto add = [&](double harmonic, double phase, double x, double z) {
        const double size = std::abs(x) + std::abs(z);
        if (size == 0.0) return;
        terms_.push_back({harmonic, phase, x, z});
        const double rate = 2.0 * std::numbers::pi * frequency_ * harmonic;
        highest_ = std::max(highest_, harmonic);
        most_speed_ += rate * size;
        most_acceleration_ += rate * rate * size;
    };
    add(1.0, 0.0, sign * p.amplitude_x, 0.0);
    add(1.0, p.phase, 0.0, p.amplitude_z);
    for (std::size_t k = 0; k < p.harmonics_x.size(); ++k) {
        const auto harmonic = static_cast<double>(k + 2);
        const auto &x = p.harmonics_x[k], &z = p.harmonics_z[k];
        add(harmonic, x.phase, sign * p.amplitude_x * x.part, 0.0);
        add(harmonic, z.phase, 0.0, p.amplitude_z * z.part);
    }
    start_ = at(0.0);
}

void Shake::bound() {
    const std::vector<Point>& points = accelerations_->points();
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Point &from = points[i - 1], &to = points[i];
        for (const Point& p : {from, to}) {
            most_acceleration_ = std::max(most_acceleration_, std::abs(p.x) + std::abs(p.z));
        }
        const double bend =
            0.125 * (to.time - from.time) * (std::abs(to.x - from.x) + std::abs(to.z - from.z));
        const double speed =
            std::max(std::abs(from.vx) + std::abs(from.vz), std::abs(to.vx) + std::abs(to.vz));
        most_speed_ = std::max(most_speed_, speed + bend);
    }
}

double Shake::next_kink(double time) const {
    if (!accelerations_) return std::numeric_limits<double>::infinity();
    return next_row(accelerations_->points(), time);
}

SurfaceMotion Shake::at(double time, double inside) const {
    if (accelerations_) {
        const std::vector<Point>& points = accelerations_->points();
        const double played = period_before(points, inside);
        const Point& from = row_before(points, inside - played);
        const Point p = after(from, *(&from + 1), time - (played + from.time));
        return {sign_ * p.sx, p.sz, sign_ * p.vx, p.vz, sign_ * p.x, p.z};
    }
    SurfaceMotion result;
    const double turns = frequency_ * time;
    const double turn = 2.0 * std::numbers::pi * (turns - std::floor(turns));
    for (const Term& term : terms_) {
        const CosineAndSine<double> now = cosine_and_sine(term.harmonic * turn + term.phase);
        const double rate = 2.0 * std::numbers::pi * frequency_ * term.harmonic;
        result.x += term.x * now.sine;
        result.z += term.z * now.sine;
        result.vx += term.x * rate * now.cosine;
        result.vz += term.z * rate * now.cosine;
        result.ax -= term.x * rate * rate * now.sine;
        result.az -= term.z * rate * rate * now.sine;
    }
    result.x -= start_.x;
    result.z -= start_.z;
    return result;
}

}  // namespace stickslip
