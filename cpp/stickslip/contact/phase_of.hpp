#pragma once

#include <type_traits>

#include "stickslip/contact/face_phases.hpp"
#include "stickslip/contact/inner_phase.hpp"
#include "stickslip/contact/turning_frame.hpp"

namespace stickslip {

/// Calls `use` with the phase of a state, but for its inner mass.
template <class Frame>
void with_outer_phase(const Frame& frame, const HybridState& state, auto&& use) {
    const typename Frame::Place contact = frame.place(state.contact_x, state.contact_y);
    if (state.mode.touch == Touch::none) {
        use(FlightIn<Frame>(frame));
    } else if (state.rests()) {
        use(FaceRestIn<Frame>(frame));
    } else if (state.mode.slip == 0) {
        use(CornerStickIn<Frame>(frame, contact));
    } else {
        frame.with_slide(state, [&](const auto& slide) {
            using Slide = std::remove_cvref_t<decltype(slide)>;
            if (state.mode.touch == Touch::face) {
                use(FaceSlideIn<Slide>(frame, slide));
            } else {
                use(CornerSlipIn<Slide>(frame, contact, slide));
            }
        });
    }
}

/// Calls `use` with the phase of a state. In the whole plane there is no inner mass.
template <class Frame>
void with_phase(const Frame& frame, const HybridState& state, auto&& use) {
    if constexpr (!Frame::kTurns) {
        if (!frame.dynamics().model().inner.absent()) {
            with_outer_phase(frame, state, [&](const auto& phase) {
                using Phase = std::remove_cvref_t<decltype(phase)>;
                use(WithInner<Phase>(phase, state.inner));
            });
            return;
        }
    }
    with_outer_phase(frame, state, use);
}

/// Sample of a recording at `tau` s. The dynamics are a copy: looking must not move the field's
/// expansion of the steps to come.
template <class Frame>
Sample look(const Frame& copy, const HybridState& state, double tau) {
    copy.dynamics().set_quadrant(state.body.quadrant);
    Sample result;
    with_phase(copy, state, [&](auto phase) {
        const auto y = phase.begin(state.body);
        phase.field().rebase(phase.place_of(tau, y));
        result = phase.sample(tau, y);
    });
    return result;
}
inline Sample sample(Dynamics dynamics, const HybridState& state, double tau) {
    return look(FixedFrame(dynamics), state, tau);
}
inline Sample sample(const PlaneDynamics& now, const HybridState& state, double tau) {
    Dynamics upright = now.upright();
    PlaneDynamics plane(now, upright);
    return look(TurningFrame(plane), state, tau);
}

}  // namespace stickslip
