#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stickslip/field/expansion.hpp"
#include "support.hpp"

using namespace stickslip;
using namespace stickslip::test;

namespace {

// The full sum of Eqs. (4)-(6), and what it would come to if nothing cancelled.
struct FullSum {
    PlanarField field;
    double field_size = 0.0;     // T, sum of the coils' |B|
    double gradient_size = 0.0;  // T/m
};

FullSum full_sum(const PerCoil& currents, double x, double z) {
    FullSum sum;
    for (const Coil coil : kAllCoils) {
        const double current = currents[static_cast<std::size_t>(coil)];
        const FieldAndGradient unit = paper_coils().unit_field(coil, {x, 0.0, z});
        sum.field.bx += current * unit.field.x();
        sum.field.bz += current * unit.field.z();
        sum.field.dbx_dx += current * unit.gradient(0, 0);
        sum.field.dbx_dz += current * unit.gradient(0, 2);
        sum.field.dbz_dz += current * unit.gradient(2, 2);
        sum.field_size += std::abs(current) * unit.field.norm();
        sum.gradient_size += std::abs(current) * unit.gradient.norm();
    }
    return sum;
}

double field_difference(const PlanarField& a, const PlanarField& b) {
    return std::hypot(a.bx - b.bx, a.bz - b.bz);
}

double gradient_difference(const PlanarField& a, const PlanarField& b) {
    return std::hypot(a.dbx_dx - b.dbx_dx, std::numbers::sqrt2 * (a.dbx_dz - b.dbx_dz),
                      a.dbz_dz - b.dbz_dz);
}

// By the terms about the far centre, of steady currents.
PlanarField far_value(const LocalField& field, double x, double z) {
    const FieldCourse course = field.course({x, z});
    const auto& [xx, xy, xz, yy, yz, zz] = course.gradient[0];
    return {course.basis[0][0], course.basis[0][2], xx, xz, zz};
}

// m, from a point of the plane y = 0 between the coils to the nearest wire.
double distance_to_wires(double x, double z) {
    const double a = 0.5 * CoilGeometry().side, c = CoilGeometry().distance;
    const double wires_along_y = std::hypot(c - std::abs(x), a - std::abs(z));
    const double of_clamp = std::hypot(c + z, a - std::abs(x));
    const double wires_beside = std::min(std::hypot(c - std::abs(x), a), std::hypot(c + z, a));
    const double of_y_coils = std::hypot(c, a - std::max(std::abs(x), std::abs(z)));
    return std::min({wires_along_y, of_clamp, wires_beside, of_y_coils});
}

}  // namespace

TEST_CASE("local field: exact at its centre") {
    Random random(1);
    for (int n = 0; n < 200; ++n) {
        const PerCoil currents = random_currents(random);
        LocalField field(paper_coils(), all_driven());
        field.set_segment(steady(currents));
        const double x = random.between(-0.05, 0.05), z = random.between(-0.05, 0.05);
        field.rebase({x, z});
        const PlanarField found = field.at(0.5)(x, z);
        const FullSum full = full_sum(currents, x, z);
        // Both add the same five products.
        CHECK(field_difference(found, full.field) <= 8.0 * kRounding * full.field_size);
        CHECK(gradient_difference(found, full.field) <= 8.0 * kRounding * full.gradient_size);
    }
}

TEST_CASE("local field: within 1e-9 of the full sum inside its reach") {
    Random random(2);
    double worst_field = 0.0;
    for (int n = 0; n < 3000; ++n) {
        const PerCoil currents = random_currents(random);
        LocalField field(paper_coils(), all_driven());
        field.set_segment(steady(currents));
        const double centre_x = random.between(-0.06, 0.06);
        const double centre_z = random.between(-0.06, 0.06);
        field.rebase({centre_x, centre_z});
        const double angle = random.between(0.0, 2.0 * std::numbers::pi);
        const double offset = LocalField::kReach * std::sqrt(random.between(0.0, 1.0));
        const double x = centre_x + offset * std::cos(angle);
        const double z = centre_z + offset * std::sin(angle);
        const PlanarField found = far_value(field, x, z);
        const FullSum full = full_sum(currents, x, z);
        const double error = field_difference(found, full.field) / full.field_size;
        worst_field = std::max(worst_field, error);

        // A harmonic field's Taylor terms about a point fall as (offset / distance to the wires)^n.
        // The first term left out of the field is the fourth; the gradient's is its derivative. The
        // third derivatives carry the error (spacing/distance)^2 of their differences, of the same
        // order. A factor of four stands for the constants.
        const double rho = distance_to_wires(centre_x, centre_z);
        const double reach = std::max(offset, field.reach() / 1.5) / rho;
        CHECK(error <= 4.0 * std::pow(reach, 4) + 8.0 * kRounding);
        CHECK(gradient_difference(found, full.field) <=
              16.0 * std::pow(reach, 3) * full.field_size / rho);
    }
    CHECK(worst_field < 1e-9);
}

TEST_CASE("local field: in the working volume the gradient is within 1e-8") {
    // Of 2.5 cm, section IV-B. By the bound above (1.5e-4/0.103)^3 = 3e-9 of B/rho, times 4 and the
    // constants; a coil's gradient is 2.3 to 3 B/rho there.
    Random random(3);
    for (int n = 0; n < 1000; ++n) {
        const PerCoil currents = random_currents(random);
        LocalField field(paper_coils(), all_driven());
        field.set_segment(steady(currents));
        const double x = random.between(-0.0125, 0.0125), z = random.between(-0.0125, 0.0125);
        field.rebase({x, z});
        const double step = LocalField::kReach * std::numbers::sqrt2 / 2.0;
        const FullSum full = full_sum(currents, x + step, z - step);
        const PlanarField found = far_value(field, x + step, z - step);
        CHECK(gradient_difference(found, full.field) < 1e-8 * full.gradient_size);
        CHECK(field_difference(found, full.field) < 1e-11 * full.field_size);
    }
}

TEST_CASE("local field: about a near centre two orders are left out") {
    Random random(6);
    for (int n = 0; n < 1000; ++n) {
        const PerCoil currents = random_currents(random);
        LocalField field(paper_coils(), all_driven());
        field.set_segment(steady(currents));
        const double x = random.between(-0.05, 0.05), z = random.between(-0.05, 0.05);
        field.rebase({x, z});
        // Near the far centre or not: the terms about the near one are its own.
        const double part = 0.49 * LocalField::kReach;
        const double near_x = x + random.between(-part, part);
        const double near_z = z + random.between(-part, part);
        field.rebase({near_x, near_z});
        const double angle = random.between(0.0, 2.0 * std::numbers::pi);
        const double offset = random.between(0.0, 0.5 * LocalField::kReach);  // of the longest step
        const double there_x = near_x + offset * std::cos(angle);
        const double there_z = near_z + offset * std::sin(angle);
        const PlanarField found = field.at(0.5)(there_x, there_z);
        const PlanarField far = far_value(field, there_x, there_z);
        const FullSum full = full_sum(currents, there_x, there_z);
        const double rho = distance_to_wires(near_x, near_z), ratio = offset / rho;
        // The first terms left out, as above; a factor of four stands for the constants.
        CHECK(field_difference(found, far) <=
              (4.0 * std::pow(ratio, 3) + 8.0 * kRounding) * full.field_size);
        CHECK(gradient_difference(found, far) <=
              16.0 * (std::pow(ratio, 2) * full.field_size / rho + kRounding * full.gradient_size));
    }
}

TEST_CASE("local field: follows the robot by rebase") {
    Random random(4);
    const PerCoil currents = random_currents(random);
    LocalField field(paper_coils(), all_driven());
    field.set_segment(steady(currents));
    double x = 0.0, z = 5e-5;
    field.rebase({x, z});
    CHECK(field.at(0.0).centre[0] == 0.0);
    for (int n = 0; n < 500; ++n) {
        x += random.between(-1e-4, 1.5e-4);
        z += random.between(-1e-4, 1e-4);
        field.rebase({x, z});
        const Expansion expansion = field.at(0.0);
        CHECK(!is_far<double, 2>({x, z}, field.far().centre, 0.5 * LocalField::kReach));
        CHECK(!is_far<double, 2>({x, z}, expansion.centre, LocalField::kNear * LocalField::kReach));
        const FullSum full = full_sum(currents, x, z);
        CHECK(field_difference(expansion(x, z), full.field) < 1e-9 * full.field_size);
    }
    CHECK(std::abs(x) > 10.0 * LocalField::kReach);  // the walk has gone somewhere
    // Not moved without need.
    const auto far = field.far().centre;
    const double near_x = far[0] + 0.49 * LocalField::kReach;
    field.rebase({near_x, far[1]});
    CHECK(field.far().centre == far);
    field.rebase({near_x - 0.9 * LocalField::kNear * LocalField::kReach, far[1]});
    CHECK(field.centre()[0] == near_x);
}

TEST_CASE("local field: currents that change, whatever the base time of the exponentials") {
    Random random(5);
    CurrentSegment segment;
    segment.duration = 0.1;
    segment.exponentials = 2;
    segment.rate = {1.0 / 0.007, 1.0 / 0.001};
    for (PerCoil& row : segment.field) row = random_currents(random);
    segment.field[1] = {10.0, 20.0, -30.0, 40.0, -50.0};  // A/s

    LocalField field(paper_coils(), all_driven());
    field.set_segment(segment);
    const double x = 1e-3, z = 2e-4;
    field.rebase({x, z});
    for (int n = 0; n < 2000; ++n) {
        const double base = random.between(0.0, 0.1);
        field.rebase({x, z});
        // Spans below and above 1/32 of a time constant, below which a series is used.
        const double span = random.coin() ? 1e-4 : 0.02;
        const double tau = std::clamp(base + random.between(-span, span), 0.0, 0.1);
        const FullSum full = full_sum(segment.field_currents(tau), x, z);
        // exp(-r tau) of r tau <= 100 has the relative rounding of its argument, 100 eps; by the
        // base's value it is had twice. Sizes are those of the parts: up to 5 times the sum.
        const double size = 4.0 * 7.0 * 5.0 * 1.2e-3;
        CHECK(field_difference(field.at(tau)(x, z), full.field) < 4.0 * kRounding * size);
    }
}

TEST_CASE("local field: near the coils' planes is outside") {
    LocalField field(paper_coils(), all_driven());
    field.set_segment(steady({1.0, 0.0, 0.0, 0.0, 0.0}));
    const double limit = 0.9 * CoilGeometry().distance;
    const auto outside = [&](double x, double z) {
        field.rebase({x, z});
        return field.outside();
    };
    CHECK_FALSE(outside(0.0, 0.0));
    for (const double sign : {-1.0, 1.0}) {
        CHECK_FALSE(outside(sign * 0.999 * limit, 0.0));
        CHECK_FALSE(outside(0.0, sign * 0.999 * limit));
        CHECK(outside(sign * 1.001 * limit, 0.0));
        CHECK(outside(0.0, sign * 1.001 * limit));
    }
    CHECK(outside(std::numeric_limits<double>::quiet_NaN(), 0.0));
    CHECK(outside(0.0, std::numeric_limits<double>::infinity()));
    CHECK_FALSE(outside(0.01, 0.01));  // and back
}

// ----- in space -----

namespace {

SpatialField field_of(const PerCoil& currents, const std::array<double, 3>& ambient = {}) {
    SpatialField field(paper_coils(), all_driven(), ambient);
    field.set_segment(steady(currents));
    return field;
}

std::array<double, 8> numbers(const SpatialFieldValue& b) {
    return {b.bx, b.by, b.bz, b.xx, b.xy, b.xz, b.yy, b.yz};
}

}  // namespace

// The next term of the series has the order (reach / distance to the wires)^4, 5e-12 of the sum of
// the coils' fields, and for the gradient one order less.
TEST_CASE("spatial field: within its reach it is the full sum of the coils") {
    Random random(3);
    for (int n = 0; n < 100; ++n) {
        const PerCoil currents = random_currents(random);
        SpatialField field = field_of(currents);
        const Place centre = {random.between(-0.02, 0.02), random.between(-0.02, 0.02),
                              random.between(-0.01, 0.01)};
        field.rebase(centre);
        const double part = 0.5 * field.reach();
        const Eigen::Vector3d place(centre[0] + random.between(-part, part),
                                    centre[1] + random.between(-part, part),
                                    centre[2] + random.between(-part, part));
        field.rebase({place.x(), place.y(), place.z()});
        FieldAndGradient full{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
        double size = 0.0, slope = 0.0;
        for (const Coil coil : kAllCoils) {
            const double current = currents[static_cast<std::size_t>(coil)];
            const FieldAndGradient unit = paper_coils().unit_field(coil, place);
            full.field += current * unit.field;
            full.gradient += current * unit.gradient;
            size += std::abs(current) * unit.field.norm();
            slope += std::abs(current) * unit.gradient.norm();
        }
        const SpatialFieldValue found = field.at(0.5)(place.x(), place.y(), place.z());
        const Eigen::Vector3d b(found.bx, found.by, found.bz);
        Eigen::Matrix3d g;
        g << found.xx, found.xy, found.xz, found.xy, found.yy, found.yz, found.xz, found.yz,
            found.zz();
        CHECK((b - full.field).norm() <= 1e-10 * size);
        CHECK((g - full.gradient).norm() <= 1e-7 * slope);
    }
}

TEST_CASE("spatial field: turned by a quarter turn with its coils it has the same bits") {
    Random random(4);
    for (int n = 0; n < 50; ++n) {
        const PerCoil i = random_currents(random);
        // yp takes the part of xp, and xm that of yp, whose positive current points the other way.
        const PerCoil turned = {-i[3], -i[2], i[0], i[1], i[4]};
        SpatialField field = field_of(i, {1e-5, 2e-5, 3e-5});
        SpatialField quarter = field_of(turned, {-2e-5, 1e-5, 3e-5});
        const double x = random.between(-0.02, 0.02), y = random.between(-0.02, 0.02);
        field.rebase({x, y, 1e-4});
        quarter.rebase({-y, x, 1e-4});
        const auto a = numbers(field.at(0.1)(x + 3e-5, y - 4e-5, 1.2e-4));
        const auto b = numbers(quarter.at(0.1)(-(y - 4e-5), x + 3e-5, 1.2e-4));
        // bx by bz xx xy xz yy yz
        const std::array<double, 8> expected = {-a[1], a[0], a[2], a[6], -a[4], -a[7], a[3], a[5]};
        for (std::size_t k = 0; k < 8; ++k) CHECK(b[k] == expected[k]);
    }
}

TEST_CASE("spatial field: outside of the coils, or nowhere, it ends") {
    SpatialField field = field_of(all_driven());
    field.rebase({0.0, 0.08, 0.0});
    CHECK_FALSE(field.outside());
    field.rebase({0.0, -0.09, 0.0});
    CHECK(field.outside());
    field.rebase({0.0, std::nan(""), 0.0});
    CHECK(field.outside());
}
