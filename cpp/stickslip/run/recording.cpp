#include "stickslip/run/recording.hpp"

#include <cmath>

namespace stickslip {

std::int8_t contact_code(const ContactMode& mode, double frame_sign) {
    if (mode.touch == Touch::none) return 0;
    const int slip = mode.slip == 0 ? 0 : (mode.slip * frame_sign > 0.0 ? 1 : 2);
    return static_cast<std::int8_t>((mode.touch == Touch::corner ? 1 : 4) + slip);
}

ContactMode seen_along(ContactMode mode, double along) {
    if (mode.slip != 0) mode.slip = along < 0.0 ? -1 : 1;
    return mode;
}

Recorder::Recorder(const RecordSettings& settings, double frame_sign, bool whole_plane,
                   bool has_inner)
    : settings_(settings), sign_(frame_sign), whole_plane_(whole_plane) {
    for (std::size_t k = 0; k < kColumns; ++k) {
        const RecordColumn& column = kRecordColumns[k];
        if (column.of_plane && !whole_plane) settings_.dropped.set(k);
        if (column.of_inner && !has_inner) settings_.dropped.set(k);
    }
    if (!on_grid()) return;
    // The product is rounded: the first sample is not before `from`, and none is left out.
    count_ = static_cast<std::int64_t>(std::floor(settings.from * settings.rate));
    if (next_time() < settings.from) ++count_;
}

void Recorder::hand_over() {
    settings_.sink(std::exchange(recording_, {}));
}

Recording Recorder::take() {
    if (settings_.sink) {
        if (!recording_.t.empty()) hand_over();
        return {};
    }
    return std::move(recording_);
}

void Recorder::add(double t, const Sample& s, const ContactMode& mode,
                   const std::array<double, 3>& field, const PerCoil& current) {
    // Not as it fills: the event of the last sample comes after it.
    if (settings_.sink && recording_.t.size() == kChunk) hand_over();
    Recording& r = recording_;
    std::size_t index = 0;  // in the order of the table
    const auto put = [&](auto& column, const auto& value) {
        if (!settings_.dropped[index++]) column.push_back(value);
    };
    put(r.t, t);
    put(r.x, sign_ * s.body.x);
    put(r.z, s.body.z);
    put(r.theta, s.body.theta());
    put(r.vx, sign_ * s.body.vx);
    put(r.vz, s.body.vz);
    put(r.omega, s.body.omega);
    put(r.normal_force, s.reaction.normal);
    put(r.friction_force, sign_ * s.reaction.friction);
    put(r.contact_x, sign_ * s.contact_x);
    put(r.slip_velocity, sign_ * s.slip_velocity);
    put(r.bx, sign_ * field[0]);
    put(r.by, sign_ * field[1]);
    put(r.bz, field[2]);
    put(r.current, sign_ > 0.0 ? current : turned(current));
    put(r.contact, contact_code(whole_plane_ ? seen_along(mode, s.slip_velocity) : mode, sign_));
    ++index;  // the event comes after the sample
    put(r.y, s.body.y);
    put(r.vy, s.body.vy);
    put(r.heading, s.body.heading);
    put(r.friction_across, s.friction_across);
    put(r.contact_y, s.contact_y);
    put(r.slip_across, s.slip_across);
    put(r.inner_place, s.inner.place);
    put(r.inner_velocity, s.inner.velocity);
    ++count_;
}

}  // namespace stickslip
