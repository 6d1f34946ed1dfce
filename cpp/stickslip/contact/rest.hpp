#pragma once

#include <array>

#include "stickslip/contact/phases.hpp"

namespace stickslip {

/// A face lies still: y = (x of the centre of mass), which no rate moves, so that it keeps its
/// bits. What changes are the forces, with the currents, and a user's or a free shape's with time.
class FaceRestPhase : public PhaseBase<Dynamics> {
public:
    static constexpr int kDim = 1;
    static constexpr int kEvents = 4;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = false;
    static constexpr bool kRests = true;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {
        Event::ahead_lifts, Event::behind_lifts, Event::breaks_backward, Event::breaks_forward};

    explicit FaceRestPhase(Dynamics& dynamics)
        : PhaseBase(dynamics), face_(model().face(quadrant())) {}

    void rates(const Expansion& field, const State& y, State& dydt, Values& g) const {
        const FaceReaction reaction = solve(field, y);
        const Pose pose = dynamics_->pose(0.0);
        const double normal = reaction.normal();
        const auto limit = [&](double slip) {
            return dynamics_->static_limit(slip, y[0], pose, normal, field.tau) * normal;
        };
        dydt = {0.0};
        g = {reaction.ahead, reaction.behind, limit(-1.0) - reaction.friction,
             limit(1.0) + reaction.friction};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to(*this, y); }
    Point<double> centre(const State& y, const Pose&) const { return {y[0], face_.height}; }
    State begin(const BodyState& body) const { return {body.x}; }
    BodyState body(double, const State& y) const {
        return {y[0], face_.height, 0.0, 0.0, 0.0, 0.0, quadrant()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        const FaceReaction reaction = solve(field_at(tau), y);
        return {body(tau, y), {reaction.normal(), reaction.friction}, contact_x(y), 0.0};
    }
    State scale(const Scales& s) const { return {s.length}; }
    double speed(const State&) const { return 0.0; }
    double angle(const State&) const { return 0.0; }
    double omega(const State&) const { return 0.0; }
    double contact_x(const State& y) const { return y[0] + face_.half_base + face_.shift; }

private:
    FaceReaction solve(const Expansion& field, const State& y) const {
        const Load load =
            dynamics_->load(field, y[0], face_.height, dynamics_->pose(0.0), 0.0, 0.0, 0.0);
        return face_reaction(model(), quadrant(), load, true, 0.0);
    }

    Face face_;
};

}  // namespace stickslip
