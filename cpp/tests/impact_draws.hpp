#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/contact/impact.hpp"
#include "support.hpp"

/// Random impacts and the conditions that any of them has to meet.
namespace stickslip::test {

inline double kinetic_energy(const Model& model, const BodyState& body) {
    return 0.5 * model.mass * (body.vx * body.vx + body.vz * body.vz) +
           0.5 * model.inertia * body.omega * body.omega;
}

inline Model random_impact_model(Random& random, double most_friction, double restitution) {
    Model model = paper_model();
    const double mu = random.between(0.0, most_friction);
    model.friction = {mu, mu * random.between(0.0, 1.0)};
    model.restitution = restitution;
    return model;
}

struct CornerImpact {
    Model model;
    Pose pose;
    BodyState before;

    CornerImpact(Random& random, double most_friction, double restitution)
        : model(random_impact_model(random, most_friction, restitution)) {
        do {
            before.quadrant = random.integer(-4, 4);
            before.angle = random.between(0.0, kQuarterTurn);
            pose =
                model.shape.pose(before.quadrant, std::cos(before.angle), std::sin(before.angle));
            before.vx = random.between(-1.0, 1.0);
            before.vz = random.between(-1.0, 1.0);
            before.omega = random.between(-1e4, 1e4);
        } while (corner_velocity_z(pose, before.vz, before.omega) > -1e-3);
    }
};

struct FaceImpact {
    Model model;
    BodyState before;
    Arrival arrival;
    bool old_slips = false;
    double base = 0.0, rise = 0.0;

    FaceImpact(Random& random, double most_friction, double restitution)
        : model(random_impact_model(random, most_friction, restitution)) {
        constexpr std::array<Arrival, 3> arrivals = {Arrival::ahead, Arrival::behind,
                                                     Arrival::both};
        arrival = arrivals[static_cast<std::size_t>(random.integer(0, 2))];
        before.quadrant = random.integer(-4, 4);
        base = model.shape.half_base(before.quadrant);
        rise = model.shape.half_rise(before.quadrant);
        before.vx = random.between(-1.0, 1.0);
        if (arrival == Arrival::both) {
            const double ahead = random.between(-1.0, -1e-3), behind = random.between(-1.0, -1e-3);
            before.vz = 0.5 * (ahead + behind);
            before.omega = 0.5 * (behind - ahead) / base;
        } else {
            // About the end that touches already.
            const double omega = random.between(1.0, 1e4);
            before.omega = arrival == Arrival::ahead ? omega : -omega;
            before.vz = -omega * base;
            old_slips = random.coin();
            if (!old_slips) before.vx = before.omega * rise;
        }
    }
    bool ahead_arrives() const { return arrival != Arrival::behind; }
    bool behind_arrives() const { return arrival != Arrival::ahead; }
    double friction_of(bool arrives) const {
        return arrives || old_slips ? model.friction.kinetic_coefficient
                                    : model.friction.static_coefficient;
    }
};

/// Impulses at the ends of a face (N s), from the change of the robot's momenta.
struct FaceImpulses {
    double ahead, behind, tangential;

    FaceImpulses(const FaceImpact& impact, const BodyState& after) {
        const Model& model = impact.model;
        const double sum = model.mass * (after.vz - impact.before.vz);
        tangential = model.mass * (after.vx - impact.before.vx);
        const double turning = model.inertia * (after.omega - impact.before.omega);
        const double difference = -(turning + impact.rise * tangential) / impact.base;
        ahead = 0.5 * (sum + difference);
        behind = 0.5 * (sum - difference);
    }
};

}  // namespace stickslip::test
