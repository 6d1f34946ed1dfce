#include "stickslip/readings/probe.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "stickslip/scenario/parameters.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::Random;

namespace {

const std::vector<std::string> kKeys = {"effects.field_gain.in_plane", "effects.field_gain.clamp",
                                        "effects.ambient_field.Bx",    "effects.ambient_field.By",
                                        "effects.ambient_field.Bz",    "coil.side"};

}  // namespace

TEST_CASE("readings of a probe are the superposed field of coils with other gains") {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const std::vector<double> values = {
            random.between(-0.5, 0.5),   random.between(-0.5, 0.5),   random.between(-1e-4, 1e-4),
            random.between(-1e-4, 1e-4), random.between(-1e-4, 1e-4), random.between(0.1, 0.2)};
        std::vector<double> place, current;
        Currents driven;
        for (int k = 0; k < 3; ++k) place.push_back(random.between(-0.02, 0.02));
        for (int k = 0; k < kCoilCount; ++k) {
            current.push_back(random.coin() ? random.between(-3.0, 3.0) : 0.0);
            driven[k] = current.back() * (1.0 + values[k == 4 ? 1 : 0]);
        }
        CoilGeometry geometry;
        geometry.side = values[5];
        const Eigen::Vector3d expected =
            CoilSet(geometry).field({place[0], place[1], place[2]}, driven).field +
            Eigen::Vector3d(values[2], values[3], values[4]);
        const auto found = probe_readings(Scenario{}, kKeys, values, place, current);
        REQUIRE(found.size() == 3);
        // Ten products and sums of fields of some mT.
        const Eigen::Map<const Eigen::Vector3d> read(found.data());
        CHECK(((read - expected).array().abs() < 1e-17).all());
    }
}

TEST_CASE("a probe on the wire of a coil reads nothing, if the coil has current") {
    const CoilGeometry paper;
    const std::vector<double> places = {paper.distance, paper.side / 2, 0.0, 0.0, 0.0, 0.0};
    const std::vector<double> on = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    const std::vector<double> off = {0, 0, 0, 0, 1, 1, 0, 0, 0, 0};
    const auto touching = coil_shares(CoilSet(), places, on);
    CHECK(std::isnan(touching[0]));
    CHECK(std::isfinite(touching[15]));
    CHECK(touching[18] == 0.0);  // a coil without current
    CHECK(std::isfinite(coil_shares(CoilSet(), places, off)[0]));
    CHECK(std::isnan(probe_readings(Scenario{}, {}, {}, places, on)[0]));
    CHECK_THROWS_AS(coil_shares(CoilSet(), places, {1.0}), std::invalid_argument);
}

TEST_CASE("rows of a probe whose values make no scenario are not numbers") {
    const std::vector<double> place = {0.0, 0.0, 0.0}, current = {1, 0, 0, 0, 0};
    const auto found =
        probe_readings(Scenario{}, {"coil.turns"}, {510.0, -1.0, 1020.0}, place, current);
    CHECK(std::isnan(found[3]));
    CHECK(found[6] == doctest::Approx(2.0 * found[0]).epsilon(1e-14));
    CHECK_THROWS_AS(probe_readings(Scenario{}, {"coil.turn"}, {1.0}, place, current),
                    std::invalid_argument);
}
