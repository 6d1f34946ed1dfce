#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "stickslip/contact/plane_phase.hpp"

namespace stickslip {

/// Nothing touches: y = (x, y, z, angle, vx, vy, vz, omega).
class PlaneFlight : public PlanePhase {
public:
    static constexpr int kDim = 8;
    static constexpr int kEvents = 5;
    static constexpr bool kSlips = false;
    static constexpr bool kFlies = true;
    using State = std::array<double, kDim>;
    using Values = std::array<double, kEvents>;
    static constexpr std::array<Event, kEvents> kEvent = {Event::pivot_touches, Event::behind_lands,
                                                          Event::ahead_lands,
                                                          Event::opposite_touches, Event::heading};

    using PlanePhase::PlanePhase;

    void rates(const SpatialExpansion& field, const State& y, State& dydt, Values& g) const {
        const Pose pose = upright().pose(y[3]);
        const HeadedField headed = plane_->headed(field, y[0], y[1], y[2]);
        const Heading& h = headed.heading;
        const PlaneLoad load =
            plane_->load(headed, field.tau, pose, h.seen(y[4], y[5]), y[6], y[7]);
        const Slip acceleration = {load.along.fx * robot().per_mass,
                                   load.across * robot().per_mass};
        dydt = {y[4],
                y[5],
                y[6],
                y[7],
                h.x(acceleration),
                h.y(acceleration),
                load.along.fz * robot().per_mass,
                load.along.torque * robot().per_inertia};
        const auto gaps = corner_gaps(robot(), y[2] - pose.height, pose);
        g = {gaps[0], gaps[1], gaps[2], gaps[3], plane_->watch().left(headed.horizontal)};
    }
    double event(std::size_t i, double tau, const auto& y) const {
        if (i == 4) return event_by_rates(*this, i, tau, y);
        const Pose pose = upright().pose(y[3]);
        return corner_gaps(robot(), y[2] - pose.height, pose)[i];
    }
    void rebase(const State& y) { plane_->field().rebase({y[0], y[1], y[2]}); }
    State begin(const BodyState& body) const {
        return {body.x, body.y, body.z, body.angle, body.vx, body.vy, body.vz, body.omega};
    }
    BodyState body(double tau, const State& y) const {
        const Heading h = plane_->headed(field_at(tau), y[0], y[1], y[2]).heading;
        return {y[0], y[2], y[3], y[4], y[6], y[7], quadrant(), y[1], y[5], h.angle()};
    }
    Snapshot snapshot(double tau, const State& y) const {
        Snapshot result;
        result.body = body(tau, y);
        return result;
    }
    State scale(const Scales& s) const {
        return {s.length, s.length, s.length, 1.0, s.velocity, s.velocity, s.velocity, s.rate};
    }
    double speed(const State& y) const { return std::hypot(y[4], y[5]) + std::abs(y[6]); }
    double angle(const State& y) const { return y[3]; }
    double omega(const State& y) const { return y[7]; }
    double place_along(const State& y) const { return along_front(y[0], y[1]); }
    double event_rounding() const { return 2.0 * kFlightRounding * robot().radius; }
};

}  // namespace stickslip
