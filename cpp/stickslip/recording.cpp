#include "stickslip/recording.hpp"

namespace stickslip {

const char* name(EventKind kind) {
    static constexpr std::array<const char*, kEventKinds> names = {
        "slip_start", "stick", "reversal",  "lift_off", "touch_down",
        "landing",    "tip",   "roll_over", "rebound",  "painleve"};
    return names[static_cast<std::size_t>(kind)];
}

std::int8_t contact_code(const ContactMode& mode, double frame_sign) {
    if (mode.touch == Touch::none) return 0;
    const int slip = mode.slip == 0 ? 0 : (mode.slip * frame_sign > 0.0 ? 1 : 2);
    return static_cast<std::int8_t>((mode.touch == Touch::corner ? 1 : 4) + slip);
}

void Recorder::add(double t, const Snapshot& s, const ContactMode& mode, const PlanarField& field,
                   double across, const PerCoil& current) {
    Recording& r = recording_;
    r.t.push_back(t);
    r.x.push_back(sign_ * s.body.x);
    r.z.push_back(s.body.z);
    r.theta.push_back(s.body.theta());
    r.vx.push_back(sign_ * s.body.vx);
    r.vz.push_back(s.body.vz);
    r.omega.push_back(s.body.omega);
    r.normal_force.push_back(s.reaction.normal);
    r.friction_force.push_back(sign_ * s.reaction.friction);
    r.contact_x.push_back(sign_ * s.contact_x);
    r.slip_velocity.push_back(sign_ * s.slip_velocity);
    r.bx.push_back(sign_ * field.bx);
    r.by.push_back(sign_ * across);
    r.bz.push_back(field.bz);
    r.current.push_back(sign_ > 0.0 ? current : turned(current));
    r.contact.push_back(contact_code(mode, sign_));
    ++count_;
}

}  // namespace stickslip
