#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "stickslip/drive/sawtooth.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::kRounding;

namespace {

constexpr double kVoltsPerTesla = 1e4;  // near R over the field of one ampere
constexpr PerCoil kEachVoltsPerTesla = {kVoltsPerTesla, kVoltsPerTesla, kVoltsPerTesla,
                                        kVoltsPerTesla, kVoltsPerTesla};

struct Expected {
    double time, in_plane, clamp;  // s, T, T
};

void check_block(const VoltageBlock& block, const std::vector<Expected>& expected) {
    REQUIRE(block.points.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CAPTURE(i);
        const PerCoil& volts = block.points[i].voltage;
        // A product or two, and a difference of times.
        CHECK(std::abs(block.points[i].time - expected[i].time) <= kRounding * expected[i].time);
        CHECK(volts[0] == doctest::Approx(kVoltsPerTesla * expected[i].in_plane).epsilon(1e-15));
        CHECK(volts[4] == doctest::Approx(kVoltsPerTesla * expected[i].clamp).epsilon(1e-15));
        CHECK(volts[1] == 0.0);
        CHECK(volts[2] == 0.0);
        CHECK(volts[3] == 0.0);
    }
}

Drive example() {
    Drive drive;
    drive.frequency = 40.0;
    drive.peak = 2.5e-3;
    drive.base = 0.5e-3;
    drive.hold = 1e-3;
    drive.ramp = 0.05;
    drive.pulses = 7;
    drive.edge_time = 2e-3;
    drive.ramp_down = 0.1;
    return drive;
}

}  // namespace

TEST_CASE("drive: every breakpoint of in-plane pulsing") {
    Drive drive = example();
    // The in-plane coil plays the sawtooth; the clamp coil holds, downwards.
    for (const Edge edge : {Edge::rise, Edge::fall}) {
        drive.edge = edge;
        const double peak_time = edge == Edge::rise ? 2e-3 : 23e-3;
        const VoltageProgram program = sawtooth_program(drive, {}, kEachVoltsPerTesla);
        REQUIRE(program.blocks().size() == 3);
        CHECK(program.blocks()[0].repeats == 1);
        CHECK(program.blocks()[1].repeats == 7);
        CHECK(program.blocks()[2].repeats == 1);
        check_block(program.blocks()[0], {{0.0, 0.0, 0.0}, {0.05, 0.5e-3, -1e-3}});
        check_block(program.blocks()[1],
                    {{0.0, 0.5e-3, -1e-3}, {peak_time, 2.5e-3, -1e-3}, {25e-3, 0.5e-3, -1e-3}});
        check_block(program.blocks()[2], {{0.0, 0.5e-3, -1e-3}, {0.1, 0.0, -1e-3}});
        CHECK(program.duration() == doctest::Approx(0.05 + 7.0 / 40.0 + 0.1).epsilon(1e-15));
    }
}

TEST_CASE("drive: every breakpoint of out-of-plane pulsing") {
    Drive drive = example();
    drive.mode = DriveMode::opp;
    drive.clamp = Clamp::up;
    for (const Edge edge : {Edge::rise, Edge::fall}) {
        drive.edge = edge;
        const double peak_time = edge == Edge::rise ? 2e-3 : 23e-3;
        const VoltageProgram program = sawtooth_program(drive, {}, kEachVoltsPerTesla);
        REQUIRE(program.blocks().size() == 3);
        check_block(program.blocks()[0], {{0.0, 0.0, 0.0}, {0.05, 1e-3, 0.5e-3}});
        check_block(program.blocks()[1],
                    {{0.0, 1e-3, 0.5e-3}, {peak_time, 1e-3, 2.5e-3}, {25e-3, 1e-3, 0.5e-3}});
        check_block(program.blocks()[2], {{0.0, 1e-3, 0.5e-3}, {0.1, 0.0, 0.5e-3}});
    }
}

TEST_CASE("drive: without edge time the edge is a jump") {
    Drive drive = example();
    drive.edge_time = 0.0;
    for (const Edge edge : {Edge::rise, Edge::fall}) {
        drive.edge = edge;
        const VoltageBlock pulse = sawtooth_program(drive, {}, kEachVoltsPerTesla).blocks()[1];
        const std::size_t jump = edge == Edge::rise ? 0 : 1;
        CHECK(pulse.points[jump].time == pulse.points[jump + 1].time);
        CHECK(std::abs(pulse.points[jump].voltage[0] - pulse.points[jump + 1].voltage[0]) ==
              doctest::Approx(kVoltsPerTesla * 2e-3).epsilon(1e-14));
    }
}

TEST_CASE("drive: no ramps, no blocks for them, and any number of pulses is one block") {
    Drive drive = example();
    drive.ramp = 0.0;
    drive.ramp_down = 0.0;
    drive.pulses = 1'000'000'000'000;
    const VoltageProgram program = sawtooth_program(drive, {}, kEachVoltsPerTesla);
    REQUIRE(program.blocks().size() == 1);
    CHECK(program.blocks()[0].points.size() == 3);
    CHECK(program.blocks()[0].repeats == 1'000'000'000'000);
}

TEST_CASE("drive: a free program has no sawtooth") {
    Drive drive = example();
    drive.mode = DriveMode::program;
    CHECK_THROWS_AS(sawtooth_program(drive, {}, kEachVoltsPerTesla), std::invalid_argument);
}

TEST_CASE("the coil that drives a robot along the surface has its voltage in the world's frame") {
    for (const Direction direction : {Direction::plus_x, Direction::minus_x}) {
        const VoltageProgram own = sawtooth_program(example(), {}, kEachVoltsPerTesla);
        const VoltageProgram world = direction == Direction::plus_x ? own : turned(own);
        for (const Coil coil : {Coil::xp, Coil::xm, Coil::yp, Coil::ym}) {
            const double volts = world.largest_voltage()[static_cast<std::size_t>(coil)];
            const SurfaceDirection towards{direction == Direction::plus_x ? 1.0 : -1.0, 0.0};
            CHECK((volts > 0.0) == (coil == in_plane_coil(towards)));
        }
    }
}
