#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/scenario/record_columns.hpp"

namespace stickslip {

/// Code of a contact mode in a recording: its place in `kContactWords` after `from_motion`.
std::int8_t contact_code(const ContactMode& mode, double frame_sign);
/// The mode of a robot in the whole plane as it is shown: a slip is forward or backward by its part
/// `along` the heading, m/s.
ContactMode seen_along(ContactMode mode, double along);

/// Writes samples on a uniform grid or at events.
class Recorder {
public:
    /// Samples that a sink gets at a time: 11 MB, and enough for a chunk to compress well.
    static constexpr std::size_t kChunk = 65536;

    /// whole_plane: whether the run is one in the whole plane. has_inner: with an inner mass.
    Recorder(const RecordSettings& settings, double frame_sign, bool whole_plane, bool has_inner);

    /// Whether an event at `t`, s, is recorded.
    bool at_event(double t) const {
        return settings_.kind == RecordKind::events && t >= settings_.from;
    }
    bool on_grid() const { return settings_.kind == RecordKind::uniform; }
    /// Time of the next sample of the grid, s; infinite without a grid.
    double next_time() const {
        return on_grid() ? static_cast<double>(count_) / settings_.rate
                         : std::numeric_limits<double>::infinity();
    }
    /// Adds a sample at `t` s. field: T. current: A.
    void add(double t, const Sample& sample, const ContactMode& mode,
             const std::array<double, 3>& field, const PerCoil& current);
    /// Adds an event at the sample that was added last.
    void add_event(EventKind kind) {
        if (!settings_.dropped[kEventColumn]) {
            recording_.event.push_back(static_cast<std::int8_t>(kind));
        }
    }
    /// Returns the samples that no sink has taken; none with a sink.
    Recording take();

private:
    void hand_over();

    RecordSettings settings_;
    double sign_;
    bool whole_plane_;
    std::int64_t count_ = 0;  // of the grid's samples, those before `from` among them
    Recording recording_;
};

}  // namespace stickslip
