#pragma once

#include <cmath>

#include "stickslip/contact/face_phases.hpp"

namespace stickslip {

/// A phase of a body in which a mass moves: y = (its own coordinates, place and velocity of the
/// mass along its line).
template <class Phase>
class WithInner : public Phase {
    using Root = PhaseBase<FixedFrame<Dynamics>>;
    static constexpr std::size_t kOwn = Phase::kDim;

public:
    using typename Phase::Field, typename Phase::Place;
    using Own = typename Phase::State;
    static constexpr bool kRests = false;
    static constexpr bool kHasInner = true;
    static constexpr std::array kEvent =
        join(Phase::kEvent, std::array{Event::inner_ahead, Event::inner_behind});
    static constexpr int kDim = Phase::kDim + 2;
    static constexpr int kEvents = kEvent.size();
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;

    WithInner(const Phase& phase, const InnerState& start) : Phase(phase), start_(start) {}

    void rates(const Field& field, const State& y, State& dydt, Values& g) const {
        const Own body = own(y);
        const InnerState mass = inner(y);
        Dynamics& dynamics = Root::dynamics();
        const Pose pose = dynamics.pose(Phase::angle(body));
        Own slopes;
        typename Phase::Values values;
        std::array<double, 2> a = {};
        dynamics.set_inner(mass);
        dynamics.move_with(field.tau, pose, [&] {
            Phase::rates(field, body, slopes, values);
            return a = Phase::acceleration(body, slopes);
        });
        const bool rests = mass.stop != 0;
        put(dydt, slopes, mass.velocity,
            rests ? 0.0 : dynamics.inner_acceleration(field.tau, pose, a[0], a[1]));
        put(g, values, left(mass, 1), left(mass, -1));
    }
    double event(std::size_t i, double tau, const auto& y) const {
        const State state = y;
        if (start_.stop != 0) return Root::event_by_rates(*this, i, tau, state);
        look_at(tau, state);
        if (i < Phase::kEvents) return Phase::event(i, tau, own(state));
        return left(inner(state), kEvent[i] == Event::inner_ahead ? 1 : -1);
    }
    State begin(const BodyState& body) const {
        State y;
        put(y, Phase::begin(body), start_.place, start_.velocity);
        return y;
    }
    State scale(const Scales& s) const {
        State result;
        put(result, Phase::scale(s), s.length, s.velocity);
        return result;
    }
    Sample sample(double tau, const State& y) const {
        look_at(tau, y);
        Sample result = Phase::sample(tau, own(y));
        result.inner = inner(y);
        return result;
    }
    InnerState inner(const State& y) const { return {y[kOwn], y[kOwn + 1], start_.stop}; }

    BodyState body(double tau, const State& y) const { return Phase::body(tau, own(y)); }
    auto place_of(double tau, const State& y) const { return Phase::place_of(tau, own(y)); }
    double speed(const State& y) const { return Phase::speed(own(y)); }
    double angle(const State& y) const { return Phase::angle(own(y)); }
    double omega(const State& y) const { return Phase::omega(own(y)); }
    double slip_place(const State& y) const { return Phase::slip_place(own(y)); }
    double slip_speed(const State& y) const { return Phase::slip_speed(own(y)); }
    Place contact(const State& y) const { return Phase::contact(own(y)); }
    Place slip(const State& y) const { return Phase::slip(own(y)); }
    bool nearly_jams(double tau, const State& y) const requires
        requires(const Phase& phase, const Own& body) {
        phase.nearly_jams(tau, body);
    }
    {
        look_at(tau, y);
        return Phase::nearly_jams(tau, own(y));
    }

private:
    static Own own(const State& y) {
        Own result;
        for (std::size_t i = 0; i < kOwn; ++i) result[i] = y[i];
        return result;
    }
    // Gives the phase's own formulas this inner mass, and its push on a stop.
    void look_at(double tau, const State& y) const {
        Root::dynamics().set_inner(inner(y));
        if (start_.stop != 0) Root::event_by_rates(*this, 0, tau, y);
    }
    // The distance to a stop, m, or the push on the one it rests on, N: zero at the event.
    double left(const InnerState& mass, int stop) const {
        if (mass.stop == stop) return Root::dynamics().push();
        return Root::model().inner.left(mass, stop);
    }

    InnerState start_;
};

}  // namespace stickslip
