#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "stickslip/run/recording.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/scenario/scenario.hpp"

using namespace stickslip;

namespace {

// A sample whose x is `x`, m.
void add(Recorder& recorder, double t, double x) {
    Sample sample;
    sample.body.x = x;
    recorder.add(t, sample, ContactMode{}, {}, PerCoil{});
}

// The chunks that a recorder of `samples` events hands over, each x a number of its own.
std::vector<Recording> chunks_of(std::int64_t samples) {
    std::vector<Recording> chunks;
    RecordSettings settings;
    settings.kind = RecordKind::events;
    settings.sink = [&](Recording&& chunk) { chunks.push_back(std::move(chunk)); };
    Recorder recorder(settings, 1.0, false, false);
    for (std::int64_t k = 0; k < samples; ++k) {
        add(recorder, static_cast<double>(k), static_cast<double>(k));
        recorder.add_event(static_cast<EventKind>(k % 7));
    }
    CHECK(recorder.take().t.empty());
    return chunks;
}

}  // namespace

TEST_CASE(
    "recording: a sink gets each sample once, in full chunks and a rest, events with theirs") {
    const auto chunk = static_cast<std::int64_t>(Recorder::kChunk);
    for (const std::int64_t samples :
         {std::int64_t{0}, std::int64_t{1}, chunk, chunk + 1, 2 * chunk + 3}) {
        const std::vector<Recording> chunks = chunks_of(samples);
        std::int64_t next = 0;
        for (const Recording& each : chunks) {
            REQUIRE(!each.t.empty());
            if (&each != &chunks.back()) CHECK(each.t.size() == Recorder::kChunk);
            REQUIRE(each.x.size() == each.t.size());
            REQUIRE(each.event.size() == each.t.size());
            for (std::size_t i = 0; i < each.x.size(); ++i, ++next) {
                REQUIRE(each.x[i] == static_cast<double>(next));
                REQUIRE(each.event[i] == next % 7);
            }
        }
        CHECK(next == samples);
    }
}

TEST_CASE("recording: the grid begins with its first sample that is not before `from`") {
    // 0.1 and 0.3 have no finite binary form: their products with the rate are rounded either way.
    for (const double rate : {3.0, 10.0, 7e3, 5e4, 1e5 / 3.0}) {
        for (const double from : {0.0, 0.1, 0.3, 0.7, 1.0 / 3.0, 2.0, 123.4567}) {
            RecordSettings settings;
            settings.kind = RecordKind::uniform;
            settings.rate = rate;
            settings.from = from;
            const double first = Recorder(settings, 1.0, false, false).next_time();
            const double number = std::round(first * rate);
            CHECK(first == number / rate);
            CHECK(first >= from);
            if (number > 0.0) CHECK((number - 1.0) / rate < from);
        }
    }
}

TEST_CASE("recording: the samples' values are in the order of the table") {
    Scenario turned, inner;
    turned.drive.heading = 0.3;  // all columns but those of an inner mass, which stays in one plane
    inner.inner.mass = 1e-9;
    inner.inner.stiffness = 1.0;
    for (Scenario* each : {&turned, &inner}) {
        Scenario& scenario = *each;
        scenario.drive.base = 0.5e-3;
        scenario.drive.pulses = 1;
        scenario.record.kind = RecordKind::events;
        for (std::size_t dropped = 0; dropped < kColumns; ++dropped) {
            scenario.record.dropped.reset();
            scenario.record.dropped.set(dropped);
            Recording recording = simulate(scenario).recording;
            recording.for_each_column([&](const RecordColumn& column, const auto& values) {
                CAPTURE(column.name);
                const bool is_there = each == &inner ? !column.of_plane : !column.of_inner;
                CHECK(values.empty() == (!is_there || column.name == kRecordColumns[dropped].name));
            });
        }
    }
}
