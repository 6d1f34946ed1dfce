#include <doctest/doctest.h>

#include <cmath>

#include "stickslip/field/spatial_field.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::all_driven;
using stickslip::test::paper_coils;
using stickslip::test::Random;
using stickslip::test::random_currents;
using stickslip::test::steady;

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
        const Eigen::Vector3d place(centre.x + random.between(-part, part),
                                    centre.y + random.between(-part, part),
                                    centre.z + random.between(-part, part));
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
        // What xp did yp does, and xm what yp did, whose positive current points the other way.
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
