#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "stickslip/contact/contact.hpp"
#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// A face that lies still. Nothing has to be integrated: the forces are linear in the currents,
/// which are known in closed form (a user's may change with time as it likes), so only the end of
/// rest is looked for.
class FaceRest {
public:
    static constexpr int kEvents = 4;
    static constexpr std::array<Event, kEvents> kEvent = {
        Event::ahead_lifts, Event::behind_lifts, Event::breaks_backward, Event::breaks_forward};
    using Values = std::array<double, kEvents>;

    FaceRest(Dynamics& dynamics, const BodyState& body) : dynamics_(&dynamics), body_(body) {
        dynamics_->rebase_field(body.x, body.z);
    }

    Values values(double tau) const {
        const FaceReaction reaction = solve(tau);
        const Pose pose = dynamics_->pose(0.0);
        const double normal = reaction.normal();
        const auto limit = [&](double slip) {
            return dynamics_->static_limit(slip, body_.x, pose, normal, tau) * normal;
        };
        return {reaction.ahead, reaction.behind, limit(-1.0) - reaction.friction,
                limit(1.0) + reaction.friction};
    }

    Snapshot snapshot(double tau) const {
        const FaceReaction reaction = solve(tau);
        const Face face = dynamics_->model().face(body_.quadrant);
        const double end = body_.x + face.half_base + face.shift;
        return {body_, {reaction.normal(), reaction.friction}, end, 0.0};
    }

private:
    FaceReaction solve(double tau) const {
        const Load load = dynamics_->load(dynamics_->field_at(tau), body_.x, body_.z,
                                          dynamics_->pose(0.0), 0.0, 0.0, 0.0);
        return face_reaction(dynamics_->model(), body_.quadrant, load, true, 0.0);
    }

    Dynamics* dynamics_;
    BodyState body_;
};

/// How a rest ended: by an event, or at the end of what was looked at.
struct RestEnd {
    Event event = Event::none;
    double tau = 0.0;
};

/// Time (s) that may pass between two looks at a body that lies still. The exponentials of a
/// stretch die out from its start, so it may grow with `tau`. `fastest`: the largest decay rate of
/// the currents, 1/s.
inline double rest_look(double tau, double fastest) {
    return std::max(0.125 / fastest, 0.125 * tau);
}

/// Where in [tau, tau_end] a function of a rest first falls through zero, or infinity.
double fall_in_rest(double tau, double tau_end, double fastest, auto&& value) {
    while (tau < tau_end) {
        const double width = std::min(rest_look(tau, fastest), tau_end - tau);
        if (const EventHit hit = find_fall([&](double s) { return value(tau + s * width); })) {
            return tau + hit.s * width;
        }
        tau = tau + width >= tau_end ? tau_end : tau + width;
    }
    return std::numeric_limits<double>::infinity();
}

/// The first event in [tau, tau_end] of a body that lies still. `fastest`: as above. `longest`: the
/// longest time between two looks, s. Ends early, without event, where `stop` is set.
template <class Rest>
RestEnd end_of_rest(const Rest& rest, PhaseMemory& memory, double tau, double tau_end,
                    double fastest, double longest = std::numeric_limits<double>::infinity(),
                    const std::atomic<bool>* stop = nullptr) {
    using Finder = EventFinder<Rest::kEvents>;
    typename Rest::Values start = rest.values(tau);
    memory.begin(start, 0.0);
    while (tau < tau_end) {
        if (stop && stop->load(std::memory_order_relaxed)) return {Event::none, tau};
        const double usual = std::min(rest_look(tau, fastest), longest);
        const double width = std::min(memory.stalled ? kShortestStep : usual, tau_end - tau);
        const auto value = [&](std::size_t i, double s) { return rest.values(tau + s * width)[i]; };
        EventSamples<Rest::kEvents> samples;
        samples.start = start;
        samples.early = rest.values(tau + Finder::kEarly * width);
        samples.late = rest.values(tau + Finder::kLate * width);
        samples.end = rest.values(tau + width);
        for (std::size_t i = 0; i < Rest::kEvents; ++i) {
            samples.lowest[i] = std::min({samples.start[i], samples.early[i], samples.late[i]});
        }
        const EventHit hit = Finder::find(samples, memory.armed, memory.stalled, value);
        memory.stalled = false;
        if (hit) return {Rest::kEvent[static_cast<std::size_t>(hit.index)], tau + hit.s * width};
        tau = tau + width >= tau_end ? tau_end : tau + width;
        start = samples.end;
    }
    return {Event::none, tau_end};
}

/// Longest time (s) between two looks at a body that rests. A free shape changes with time over
/// the distance of its knots. A user's force may too, and nothing is known of how fast: it is
/// looked at as often as a phase's first step would.
inline double max_check_interval(const Model& model, const StepperOptions& options) {
    const double shaped = 0.125 * model.least_time();
    if (model.user_effects.empty()) return shaped;
    const double look = std::min(0.25 / options.swing_rate, shaped);
    return options.max_step > 0.0 ? std::min(look, options.max_step) : look;
}

}  // namespace stickslip
