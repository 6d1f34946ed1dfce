#include "stickslip/run/run_snapshot.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "stickslip/numbers/hash.hpp"

namespace stickslip {
namespace {

constexpr char kMagic[] = "stkslip";  // with its zero, eight bytes
constexpr std::uint64_t kVersion = 5;
constexpr std::size_t kWord = 8;

// Calls `visit` with each number of a snapshot, in the order of its bytes.
template <class Snapshot>
void for_each_number(Snapshot& s, auto&& visit) {
    const auto visit_all = [&](auto& values) {
        for (auto& value : values) visit(value);
    };
    visit(s.scenario);
    auto& body = s.state.body;
    for (auto* value : {&body.x, &body.y, &body.z, &body.angle, &body.heading, &body.vx, &body.vy,
                        &body.vz, &body.omega}) {
        visit(*value);
    }
    visit(body.quadrant);
    visit(s.state.mode.touch);
    visit(s.state.mode.slip);
    for (auto* value : {&s.state.contact_x, &s.state.contact_y, &s.state.slip_velocity,
                        &s.state.slip_y, &s.contact_age}) {
        visit(*value);
    }
    visit(s.state.inner.place);
    visit(s.state.inner.velocity);
    visit(s.state.inner.stop);
    visit_all(s.circuit.modes);
    visit_all(s.circuit.lagging);
    visit_all(s.circuit.capacitor);
    visit(s.steps.origin);
    visit(s.steps.duration);
    visit(s.steps.steps);
    visit(s.steps.hold.held);
    visit_all(s.steps.last);
    visit_all(s.steps.hold.voltage);
    visit(s.heading.heading.cosine);
    visit(s.heading.heading.sine);
    visit(s.heading.is_weak);
    visit(s.heading.was_settled);
    visit(s.heading.turned);
    visit(s.heading.since);
    visit(s.heading.turned_then);
    visit(s.heading.next_look);
    visit_all(s.gain);
    visit(s.begun);
    visit(s.touches_down);
    visit(s.in_whole_plane);
    visit(s.status);
    visit(s.end);
}

void for_each_number_of(auto& segment, auto&& visit) {
    visit(segment.start);
    visit(segment.end);
    for (auto& value : segment.first) visit(value);
    for (auto& value : segment.last) visit(value);
}

std::uint64_t word_of(double value) {
    return std::bit_cast<std::uint64_t>(value);
}
std::uint64_t word_of(auto value) {
    return static_cast<std::uint64_t>(value);
}

void set(double& value, std::uint64_t word) {
    value = std::bit_cast<double>(word);
}
template <class T>
void set(T& value, std::uint64_t word) {
    if constexpr (std::is_same_v<T, bool>) {
        value = word != 0;
    } else {
        value = static_cast<T>(word);
    }
}

void append(std::string& bytes, std::uint64_t word) {
    char part[kWord];
    std::memcpy(part, &word, kWord);
    bytes.append(part, kWord);
}

std::uint64_t word_at(const std::string& bytes, std::size_t place) {
    std::uint64_t result;
    std::memcpy(&result, bytes.data() + place, kWord);
    return result;
}

std::uint64_t checksum(const std::string& bytes, std::size_t size) {
    Hash hash;
    hash.add(bytes.data(), size);
    return hash.value();
}

}  // namespace

std::string RunSnapshot::to_bytes() const {
    std::string result(kMagic, kWord);
    append(result, kVersion);
    const auto write = [&](const auto& value) { append(result, word_of(value)); };
    for_each_number(*this, write);
    write(steps.late.size());
    for (const VoltageSegment& each : steps.late) for_each_number_of(each, write);
    result += message;
    append(result, checksum(result, result.size()));
    return result;
}

RunSnapshot RunSnapshot::from_bytes(const std::string& bytes) {
    RunSnapshot result;
    std::size_t least = 4 * kWord;  // with the magic, the version, a count and the checksum
    for_each_number(result, [&](auto&) { least += kWord; });
    if (bytes.size() < 3 * kWord || bytes.compare(0, kWord, kMagic, kWord) != 0) {
        throw std::invalid_argument("these bytes are no snapshot of a simulator");
    }
    const std::size_t size = bytes.size() - kWord;
    if (word_at(bytes, size) != checksum(bytes, size)) {
        throw std::invalid_argument("the snapshot is damaged: its checksum does not fit");
    }
    const std::uint64_t version = word_at(bytes, kWord);
    if (version != kVersion || bytes.size() < least) {
        throw std::invalid_argument("the snapshot is of version " + std::to_string(version) +
                                    ": allowed is version " + std::to_string(kVersion));
    }
    std::size_t place = 2 * kWord;
    const auto read = [&](auto& value) {
        set(value, word_at(bytes, place));
        place += kWord;
    };
    for_each_number(result, read);
    std::size_t late = 0;
    read(late);
    if (late > (size - place) / ((2 + 2 * kCoilCount) * kWord)) {
        throw std::invalid_argument("the snapshot is damaged: it ends too early");
    }
    result.steps.late.resize(late);
    for (VoltageSegment& each : result.steps.late) for_each_number_of(each, read);
    result.message = bytes.substr(place, size - place);
    return result;
}

}  // namespace stickslip
