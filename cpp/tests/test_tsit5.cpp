#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "stickslip/solver/tsit5.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

constexpr std::size_t kStages = 7;
using Row = std::array<double, kStages>;

// The tableau in full: a[i][j], weights b and b of the error estimate; the seventh stage is the
// end.
struct Tableau {
    std::array<Row, kStages> a = {};
    Row b = {}, c = {}, error = {};

    Tableau() {
        for (std::size_t i = 0; i < 6; ++i) {
            for (std::size_t j = 0; j <= i; ++j) a[i + 1][j] = Tsit5Table::a[i][j];
        }
        b = a[6];
        for (std::size_t i = 0; i < 6; ++i) c[i] = Tsit5Table::c[i];
        c[6] = 1.0;
        error = Tsit5Table::error;
    }

    Row times_a(const Row& v) const {
        Row result = {};
        for (std::size_t i = 0; i < kStages; ++i) {
            for (std::size_t j = 0; j < kStages; ++j) result[i] += a[i][j] * v[j];
        }
        return result;
    }
};

Row times(const Row& u, const Row& v) {
    Row result;
    for (std::size_t i = 0; i < kStages; ++i) result[i] = u[i] * v[i];
    return result;
}

double dot(const Row& u, const Row& v) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kStages; ++i) sum += u[i] * v[i];
    return sum;
}

// A rooted tree's elementary weight by stage, its order, and its density gamma: Butcher's condition
// for weights w is w . phi = 1/gamma (s^order / gamma at the fraction s of a step).
struct Tree {
    Row phi;
    int order;
    double density;
};

std::vector<Tree> trees_up_to_order_five(const Tableau& t) {
    Row one;
    one.fill(1.0);
    const Row c = t.c, c2 = times(c, c), c3 = times(c2, c);
    const Row ac = t.times_a(c), ac2 = t.times_a(c2), aac = t.times_a(ac);
    return {{one, 1, 1.0},
            {c, 2, 2.0},
            {c2, 3, 3.0},
            {ac, 3, 6.0},
            {c3, 4, 4.0},
            {times(c, ac), 4, 8.0},
            {ac2, 4, 12.0},
            {aac, 4, 24.0},
            {times(c2, c2), 5, 5.0},
            {times(c2, ac), 5, 10.0},
            {times(ac, ac), 5, 20.0},
            {times(c, ac2), 5, 15.0},
            {t.times_a(c3), 5, 20.0},
            {times(c, aac), 5, 30.0},
            {t.times_a(times(c, ac)), 5, 40.0},
            {t.times_a(ac2), 5, 60.0},
            {t.times_a(aac), 5, 120.0}};
}

// A phase of seven coordinates, so that a step with unit slopes shows the interpolant's weights.
struct SevenCoordinates {
    using Real = double;
    static constexpr int kDim = 7;
    using State = std::array<double, 7>;
};

Row dense_weights(double s) {
    Tsit5Step<SevenCoordinates> step = {};
    step.width = 1.0;
    for (std::size_t j = 0; j < kStages; ++j) step.slope[j][j] = 1.0;
    return step.dense(s);
}

}  // namespace

TEST_CASE("tsit5: rows add up to the stages' times") {
    const Tableau t;
    for (std::size_t i = 0; i < kStages; ++i) {
        double sum = 0.0;
        for (const double a : t.a[i]) sum += a;
        CHECK(std::abs(sum - t.c[i]) < 1e-14);  // coefficients of up to 13, given to 1e-15
    }
}

TEST_CASE("tsit5: all 17 order conditions up to the fifth order") {
    const Tableau t;
    // The largest coefficients are 13, given to 16 digits; up to three stand in a product.
    for (const Tree& tree : trees_up_to_order_five(t)) {
        CHECK(std::abs(dot(t.b, tree.phi) - 1.0 / tree.density) < 1e-13);
    }
}

TEST_CASE("tsit5: the error estimate vanishes up to the fourth order, and not in the fifth") {
    const Tableau t;
    double largest_fifth = 0.0;
    for (const Tree& tree : trees_up_to_order_five(t)) {
        const double weight = std::abs(dot(t.error, tree.phi));
        if (tree.order <= 4) {
            CHECK(weight < 1e-13);
        } else {
            largest_fifth = std::max(largest_fifth, weight);
        }
    }
    CHECK(largest_fifth > 1e-4);
}

TEST_CASE("tsit5: the interpolant meets the order conditions up to the fourth, everywhere") {
    const Tableau t;
    for (int i = 0; i <= 20; ++i) {
        const double s = i / 20.0;
        const Row weights = dense_weights(s);
        for (const Tree& tree : trees_up_to_order_five(t)) {
            if (tree.order > 4) continue;
            CHECK(std::abs(dot(weights, tree.phi) - std::pow(s, tree.order) / tree.density) <
                  1e-13);
        }
    }
    CHECK(std::abs(dot(dense_weights(0.5), t.times_a(t.times_a(t.times_a(t.c)))) -
                   std::pow(0.5, 5) / 120.0) > 1e-6);  // not of the fifth
}

TEST_CASE("tsit5: the interpolant meets the step at both ends, with its slopes") {
    const Tableau t;
    const Row at_start = dense_weights(0.0), at_end = dense_weights(1.0);
    const double h = 1e-6;
    const Row after_start = dense_weights(h), before_end = dense_weights(1.0 - h);
    for (std::size_t j = 0; j < kStages; ++j) {
        CHECK(at_start[j] == 0.0);
        CHECK(std::abs(at_end[j] - t.b[j]) < 1e-13);
        // One-sided differences: second derivatives are below 300.
        CHECK(std::abs(after_start[j] / h - (j == 0 ? 1.0 : 0.0)) < 3e-4);
        CHECK(std::abs((at_end[j] - before_end[j]) / h - (j == 6 ? 1.0 : 0.0)) < 3e-4);
    }
}
