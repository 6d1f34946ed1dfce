#include "stickslip/field/field_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace stickslip {
namespace {

// Harmonics are counted from degree 0 here: C_l0 is number l^2, C_lm follows with S_lm behind it.
constexpr std::size_t cosine(std::size_t l, std::size_t m) {
    return l * l + (m == 0 ? 0 : 2 * m - 1);
}
constexpr std::size_t sine(std::size_t l, std::size_t m) {
    return l * l + 2 * m;
}

constexpr std::size_t kMostHarmonics = (FieldMap::kMostDegree + 1) * (FieldMap::kMostDegree + 1);
using Harmonics = std::array<double, kMostHarmonics>;

// All up to a degree at u, by the recurrences R_ll = (x + iy) R_l-1,l-1 / (2 l) and
// (l^2 - m^2) R_lm = (2 l - 1) z R_l-1,m - r^2 R_l-2,m.
void evaluate(std::size_t degree, const Eigen::Vector3d& u, Harmonics& of) {
    const double x = u[0], y = u[1], z = u[2];
    const double r2 = u.squaredNorm();
    of[0] = 1.0;
    for (std::size_t l = 1; l <= degree; ++l) {
        const auto real_l = static_cast<double>(l);
        // C or S of an order m < l, from the two degrees below.
        const auto climb = [&](auto place, std::size_t m) {
            const auto real_m = static_cast<double>(m);
            double sum = (2.0 * real_l - 1.0) * z * of[place(l - 1, m)];
            if (l > m + 1) sum -= r2 * of[place(l - 2, m)];
            of[place(l, m)] = sum / (real_l * real_l - real_m * real_m);
        };
        for (std::size_t m = 0; m < l; ++m) {
            climb(cosine, m);
            if (m > 0) climb(sine, m);
        }
        const double half = 0.5 / real_l;
        const double c = of[cosine(l - 1, l - 1)], s = l > 1 ? of[sine(l - 1, l - 1)] : 0.0;
        of[cosine(l, l)] = half * (x * c - y * s);
        of[sine(l, l)] = half * (x * s + y * c);
    }
}

// Coefficients of the derivative along an axis, up to the degree below, of a sum with these up to
// `degree`. From (d/dx - i d/dy) R_lm = R_l-1,m-1, (d/dx + i d/dy) R_lm = -R_l-1,m+1 and dR_lm/dz =
// R_l-1,m, with R_l,-1 = -conj(R_l1).
std::vector<double> derivative(std::size_t axis, std::size_t degree, const std::vector<double>& a) {
    std::vector<double> result(degree * degree, 0.0);
    for (std::size_t l = 1; l <= degree; ++l) {
        for (std::size_t m = 0; m <= l; ++m) {
            const std::size_t below = l - 1;
            const double c = a[cosine(l, m)], s = m > 0 ? a[sine(l, m)] : 0.0;
            // C and S of an order of the degree below, where there is one; S_l0 = 0.
            const auto add = [&](std::size_t order, double of_cosine, double of_sine) {
                if (order > below) return;
                result[cosine(below, order)] += of_cosine;
                if (order > 0) result[sine(below, order)] += of_sine;
            };
            if (axis == 2) {
                add(m, c, s);
            } else if (m == 0) {
                if (axis == 0) add(1, -c, 0.0);
                if (axis == 1) add(1, 0.0, -c);
            } else if (axis == 0) {
                add(m - 1, 0.5 * c, 0.5 * s);
                add(m + 1, -0.5 * c, -0.5 * s);
            } else {
                add(m - 1, 0.5 * s, -0.5 * c);
                add(m + 1, 0.5 * s, -0.5 * c);
            }
        }
    }
    return result;
}

std::size_t degree_of(std::size_t count) {
    for (std::size_t degree = 1; degree <= FieldMap::kMostDegree; ++degree) {
        if (FieldMap::count(degree) == count) return degree;
    }
    throw std::invalid_argument(
        "a map has l (l + 2) coefficients a coil for a degree l from 1 to " +
        std::to_string(FieldMap::kMostDegree) + ", not " + std::to_string(count));
}

Eigen::Vector3d centre_of(const Box& box) {
    return 0.5 * (box.low + box.high);
}
double radius_of(const Box& box) {
    return 0.5 * (box.high - box.low).norm();
}

}  // namespace

FieldMap::FieldMap(const Box& box, const PerCoilOf<std::vector<double>>& coefficients)
    : box_(box), centre_(centre_of(box)), radius_(radius_of(box)), coefficients_(coefficients) {
    if (!(std::isfinite(radius_) && radius_ > 0.0 && box.holds(Eigen::Vector3d::Zero()))) {
        throw std::invalid_argument("the box of a map has to be finite and to hold the origin");
    }
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        const std::size_t degree = degree_of(coefficients[k].size());
        if (!std::all_of(coefficients[k].begin(), coefficients[k].end(),
                         [](double each) { return std::isfinite(each); })) {
            throw std::invalid_argument("the coefficients of a map have to be finite");
        }
        std::vector<double> potential = coefficients[k];
        potential.insert(potential.begin(), 0.0);
        std::vector<Parts> parts(degree * degree, Parts{});
        const auto put = [&](std::size_t part, const std::vector<double>& values, double scale) {
            for (std::size_t i = 0; i < values.size(); ++i) parts[i][part] = scale * values[i];
        };
        const std::vector<double> x = derivative(0, degree, potential);
        const std::vector<double> y = derivative(1, degree, potential);
        const std::vector<double> z = derivative(2, degree, potential);
        put(0, x, 1.0);
        put(1, y, 1.0);
        put(2, z, 1.0);
        put(3, derivative(1, degree - 1, x), 1.0 / radius_);
        put(4, derivative(2, degree - 1, x), 1.0 / radius_);
        put(5, derivative(1, degree - 1, y), 1.0 / radius_);
        put(6, derivative(2, degree - 1, y), 1.0 / radius_);
        put(7, derivative(2, degree - 1, z), 1.0 / radius_);
        parts_[k] = std::move(parts);
    }
}

FieldAndGradient FieldMap::unit_field(Coil coil, const Eigen::Vector3d& point) const {
    const std::vector<Parts>& parts = parts_[static_cast<std::size_t>(coil)];
    const auto degrees = static_cast<std::size_t>(std::lround(std::sqrt(parts.size())));
    Harmonics harmonics;
    evaluate(degrees - 1, (point - centre_) / radius_, harmonics);
    Parts sum = {};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (std::size_t part = 0; part < sum.size(); ++part) {
            sum[part] += harmonics[i] * parts[i][part];
        }
    }
    const auto& [bx, by, bz, xy, xz, yy, yz, zz] = sum;
    FieldAndGradient result;
    result.field << bx, by, bz;
    result.gradient << -(yy + zz), xy, xz,  //
        xy, yy, yz,                         //
        xz, yz, zz;
    return result;
}

FieldMap FieldMap::turned() const {
    constexpr PerCoilOf<std::size_t> kFrom = {1, 0, 3, 2, 4};
    const Eigen::Vector3d turn(-1.0, -1.0, 1.0);
    Box box = {turn.cwiseProduct(box_.low), turn.cwiseProduct(box_.high)};
    std::swap(box.low[0], box.high[0]);
    std::swap(box.low[1], box.high[1]);
    PerCoilOf<std::vector<double>> coefficients;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        // Half a turn about z multiplies the harmonics of order m with (-1)^m.
        std::vector<double> own = coefficients_[kFrom[k]];
        const double polarity = static_cast<Coil>(k) == Coil::clamp ? 1.0 : -1.0;
        const std::size_t degree = degree_of(own.size());
        for (std::size_t l = 1; l <= degree; ++l) {
            for (std::size_t m = 0; m <= l; ++m) {
                const double factor = m % 2 == 0 ? polarity : -polarity;
                own[cosine(l, m) - 1] *= factor;
                if (m > 0) own[sine(l, m) - 1] *= factor;
            }
        }
        coefficients[k] = std::move(own);
    }
    return {box, coefficients};
}

std::vector<double> harmonic_fields(const Box& box, std::size_t degree,
                                    const std::vector<Eigen::Vector3d>& points) {
    if (degree < 1 || degree > FieldMap::kMostDegree) {
        throw std::invalid_argument("the degree of a map is 1 to " +
                                    std::to_string(FieldMap::kMostDegree));
    }
    struct Term {
        std::size_t to, from;  // place in the fields of a point, and harmonic
        double factor;
    };
    std::vector<Term> terms;
    const std::size_t count = FieldMap::count(degree);
    std::vector<double> one(count + 1, 0.0);
    for (std::size_t k = 1; k <= count; ++k) {
        one[k] = 1.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::vector<double> parts = derivative(axis, degree, one);
            for (std::size_t i = 0; i < parts.size(); ++i) {
                if (parts[i] != 0.0) terms.push_back({axis * count + k - 1, i, parts[i]});
            }
        }
        one[k] = 0.0;
    }
    std::vector<double> result(points.size() * 3 * count, 0.0);
    Harmonics harmonics;
    for (std::size_t p = 0; p < points.size(); ++p) {
        evaluate(degree - 1, (points[p] - centre_of(box)) / radius_of(box), harmonics);
        double* fields = &result[p * 3 * count];
        for (const Term& term : terms) fields[term.to] += term.factor * harmonics[term.from];
    }
    return result;
}

}  // namespace stickslip
