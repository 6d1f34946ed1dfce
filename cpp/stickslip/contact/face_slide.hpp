#pragma once

#include "stickslip/contact/phases.hpp"

namespace stickslip {

/// A face slides: y = (x of the centre of mass, slip velocity).
class FaceSlidePhase : public PhaseBase<Dynamics> {
public:
    static constexpr int kDim = 2;
    static constexpr int kEvents = 3;
    static constexpr bool kSlips = true;
    static constexpr bool kFlies = false;
    using State = std::array<Real, kDim>;
    using Values = std::array<Real, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::ahead_lifts, Event::behind_lifts,
                                                          Event::slip_stops};

    FaceSlidePhase(Dynamics& dynamics, int slip)
        : PhaseBase(dynamics), slip_(slip), face_(model().face(quadrant())) {}

    [[gnu::always_inline]] void rates(const Expansion& field, const State& y, State& dydt,
                                      Values& g) const {
        Load load;
        const FaceReaction reaction = solve(field, y, load);
        dydt = {y[1], (load.fx + reaction.friction) * robot().per_mass};
        g = {reaction.ahead, reaction.behind, slip_ * y[1]};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 2) return slip_ * y[1];
        return event_by_rates(*this, i, tau, y);
    }
    void rebase(const State& y) { rebase_to(*this, y); }
    Point<double> centre(const State& y, const Pose&) const { return {y[0], height()}; }
    State begin(const BodyState& body) const { return {body.x, body.vx}; }
    BodyState body(double, const State& y) const {
        return {y[0], height(), 0.0, y[1], 0.0, 0.0, quadrant()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        Load load;
        const FaceReaction reaction = solve(field_at(tau), y, load);
        const double end = contact_x(y) + face_.roll;
        return {body(tau, y), {reaction.normal(), reaction.friction}, end, y[1]};
    }
    State scale(const Scales& s) const { return {s.length, s.velocity}; }
    double speed(const State& y) const { return std::abs(y[1]); }
    double angle(const State&) const { return 0.0; }
    double omega(const State&) const { return 0.0; }
    double contact_x(const State& y) const {
        return y[0] + (face_.half_base + face_.shift - face_.roll);
    }
    double slip_velocity(const State& y) const { return y[1]; }

private:
    double height() const { return face_.height; }
    FaceReaction solve(const Expansion& field, const State& y, Load& load) const {
        const Pose pose = dynamics_->pose(0.0);
        load = dynamics_->load(field, y[0], height(), pose, y[1], 0.0, 0.0);
        const double normal = load.contact_adhesion - load.fz;
        const double coefficient = dynamics_->kinetic(slip_, y[1], y[0], pose, normal, field.tau);
        return face_reaction(model(), quadrant(), load, false, slip_ * coefficient);
    }

    int slip_;
    Face face_;
};

}  // namespace stickslip
