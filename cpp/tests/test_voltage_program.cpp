#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "stickslip/drive/sawtooth.hpp"
#include "stickslip/drive/voltage_program.hpp"
#include "support.hpp"

using namespace stickslip;
using stickslip::test::kRounding;

namespace {

VoltagePoint point(double time, double volts) {
    return {time, {volts, 0.0, 0.0, 0.0, -2.0 * volts}};
}

}  // namespace

TEST_CASE("voltage program: duration and largest voltages over blocks and repeats") {
    const VoltageProgram program(
        {{{point(0.0, 1.0), point(0.5, 3.0)}, 1}, {{point(0.0, -4.0), point(0.25, 2.0)}, 4}});
    CHECK(program.duration() == 1.5);
    CHECK(program.largest_voltage() == PerCoil{4.0, 0.0, 0.0, 0.0, 8.0});
}

TEST_CASE("segment cursor: segments in order, jumps passed over, blocks repeated") {
    const VoltageProgram program(
        {{{point(0.0, 1.0), point(0.5, 3.0)}, 1},
         {{point(0.0, 5.0), point(0.0, 6.0), point(0.25, 7.0), point(0.25, 8.0)}, 2}});
    SegmentCursor cursor(program);
    std::vector<VoltageSegment> found;
    for (VoltageSegment segment; cursor.next(segment);) found.push_back(segment);
    REQUIRE(found.size() == 3);
    const double starts[] = {0.0, 0.5, 0.75}, ends[] = {0.5, 0.75, 1.0};
    const double firsts[] = {1.0, 6.0, 6.0}, lasts[] = {3.0, 7.0, 7.0};
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(found[i].start == starts[i]);
        CHECK(found[i].end == ends[i]);
        CHECK(found[i].first == point(0.0, firsts[i]).voltage);
        CHECK(found[i].last == point(0.0, lasts[i]).voltage);
    }
    VoltageSegment after_the_end;
    CHECK_FALSE(cursor.next(after_the_end));
    CHECK_FALSE(cursor.next(after_the_end));
}

TEST_CASE("segment cursor: the last of a hundred thousand repeats starts as exactly as the first") {
    const double period = 1.0 / 30.0;
    constexpr std::int64_t repeats = 100000;
    const VoltageProgram program({{{point(0.0, 0.0), point(0.05, 1.0)}, 1},
                                  {{point(0.0, 1.0), point(period, 0.0)}, repeats}});
    SegmentCursor cursor(program);
    VoltageSegment segment;
    REQUIRE(cursor.next(segment));
    std::int64_t count = 0;
    double worst = 0.0;
    while (cursor.next(segment)) {
        const double exact = 0.05 + period * static_cast<double>(count);
        worst = std::max(worst, std::abs(segment.start - exact) / exact);
        ++count;
    }
    CHECK(count == repeats);
    CHECK(worst <= 2.0 * kRounding);  // one product, one sum; a running sum would be off by 1e-12
    CHECK(std::abs(segment.end - program.duration()) <= 4.0 * kRounding * program.duration());
}

TEST_CASE("voltage program: what cannot be played is refused, with its point") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    const VoltageBlock good{{point(0.0, 0.0), point(1.0, 1.0)}, 1};
    const auto build = [&](const VoltageBlock& block) { return VoltageProgram({good, block}); };

    CHECK_THROWS_WITH_AS(VoltageProgram(std::vector<VoltageBlock>{}),
                         "the voltage program is empty", std::invalid_argument);
    CHECK_THROWS_WITH_AS(build({{point(0.0, 0.0)}, 1}),
                         "block 2: voltages: 1 points; allowed are two or more",
                         std::invalid_argument);
    CHECK_THROWS_WITH_AS(build({good.points, 0}), "block 2: repeats = 0: allowed is 1 or more",
                         std::invalid_argument);
    CHECK_THROWS_AS(build({{point(0.1, 0.0), point(1.0, 0.0)}, 1}), std::invalid_argument);
    CHECK_THROWS_AS(build({{point(0.0, 0.0), point(1.0, 0.0), point(0.9, 0.0)}, 1}),
                    std::invalid_argument);
    CHECK_THROWS_AS(build({{point(0.0, 0.0), point(infinite, 0.0)}, 1}), std::invalid_argument);
    CHECK_THROWS_AS(build({{point(0.0, 0.0), point(1.0, nan)}, 1}), std::invalid_argument);
    CHECK_THROWS_WITH_AS(build({{point(0.0, 0.0), point(0.0, 1.0)}, 1}),
                         "block 2: point 2: t = 0: no duration; allowed is above 0 s",
                         std::invalid_argument);
    CHECK_NOTHROW(build(good));
}

TEST_CASE("drive: a free program has no sawtooth") {
    Drive drive;
    drive.mode = DriveMode::program;
    CHECK_THROWS_AS(sawtooth_program(drive, {}, {}), std::invalid_argument);
}
