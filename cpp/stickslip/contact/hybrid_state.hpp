#pragma once

#include <type_traits>

#include "stickslip/contact/face_slide.hpp"
#include "stickslip/contact/phases.hpp"
#include "stickslip/contact/plane_corner.hpp"
#include "stickslip/contact/plane_face.hpp"
#include "stickslip/contact/plane_flight.hpp"
#include "stickslip/contact/rest.hpp"

namespace stickslip {

/// What goes on from phase to phase.
struct HybridState {
    BodyState body;
    ContactMode mode;
    double contact_x = 0.0;      ///< m, pivot corner; kept, not derived, so that a stuck one stays
    double slip_velocity = 0.0;  ///< m/s
    // Of a robot that moves in the whole plane: what is above is along x, this along y.
    double contact_y = 0.0;  ///< m
    double slip_y = 0.0;     ///< m/s

    bool rests() const { return mode.touch == Touch::face && mode.slip == 0; }
};

/// Calls `use` with the phase of a state.
void with_phase(Dynamics& dynamics, const HybridState& state, auto&& use) {
    const int slip = state.mode.slip;
    if (state.mode.touch == Touch::none) {
        use(FlightPhase(dynamics));
    } else if (state.rests()) {
        use(FaceRestPhase(dynamics));
    } else if (state.mode.touch == Touch::face) {
        use(FaceSlidePhase(dynamics, slip));
    } else if (slip == 0) {
        use(CornerStickPhase(dynamics, state.contact_x));
    } else {
        use(CornerSlipPhase(dynamics, state.contact_x, slip, state.slip_velocity));
    }
}

/// The same of one that moves in the whole plane.
void with_plane_phase(PlaneDynamics& plane, const HybridState& state, auto&& use) {
    if (state.mode.touch == Touch::none) {
        use(PlaneFlight(plane));
    } else if (state.rests()) {
        use(PlaneFaceRest(plane));
    } else if (state.mode.slip == 0) {
        use(PlaneCornerStick(plane, state.contact_x, state.contact_y));
    } else {
        const Slip slip = {state.slip_velocity, state.slip_y};
        const auto use_slip = [&](auto slow) {
            constexpr bool kSlow = decltype(slow)::value;
            if (state.mode.touch == Touch::face) {
                use(PlaneFaceSlide<kSlow>(plane, slip));
            } else {
                use(PlaneCornerSlip<kSlow>(plane, state.contact_x, state.contact_y, slip));
            }
        };
        is_slow(slip) ? use_slip(std::true_type()) : use_slip(std::false_type());
    }
}

/// What a recording sees at `tau`. The dynamics are a copy: looking must not move the
/// field's expansion of the steps to come.
inline Snapshot snapshot(Dynamics dynamics, const HybridState& state, double tau) {
    dynamics.set_quadrant(state.body.quadrant);
    Snapshot result;
    with_phase(dynamics, state, [&](auto phase) {
        const auto y = phase.begin(state.body);
        phase.rebase(y);
        result = phase.snapshot(tau, y);
    });
    return result;
}
inline Snapshot snapshot(const PlaneDynamics& now, const HybridState& state, double tau) {
    Dynamics upright = now.upright();
    PlaneDynamics plane(now, upright);
    upright.set_quadrant(state.body.quadrant);
    Snapshot result;
    with_plane_phase(plane, state, [&](auto phase) {
        const auto y = phase.begin(state.body);
        phase.rebase(y);
        result = phase.snapshot(tau, y);
    });
    return result;
}

}  // namespace stickslip
