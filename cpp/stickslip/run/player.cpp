#include "stickslip/run/player.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "stickslip/scenario/coils.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {

Player::Player(const Scenario& scenario, const std::vector<double>& marks,
               const std::atomic<bool>* stop)
    : model_(make_model(scenario, frame_of(scenario))),
      program_(make_program(scenario, model_.frame)),
      hold_period_(scenario.effects.sample_hold_period),
      amplifier_limit_(scenario.effects.amplifier_limit_voltage),
      latency_(scenario.drive.latency),
      field_gain_(stickslip::field_gain(scenario)),
      coils_(robot_coil_set(scenario, model_.frame)),
      circuit_(make_circuit(scenario, model_.frame, program_)),
      dynamics_(model_, make_local_field(scenario, model_.frame, program_, coils_)),
      options_(make_stepper_options(scenario, model_, program_, coils_, stop)),
      source_(program_, hold_period_, latency_, marks,
              [this](double after) {
                  return std::min(model_.shake.next_kink(after),
                                  model_.inner.drive.next_jump(after));
              }),
      transitions_(dynamics_, state_),
      // Fifty free swings, or periods of the shake.
      watch_(50.0 * std::min(2.0 * std::numbers::pi / options_.swing_rate,
                             model_.shake.shortest_period())) {
    if (model_.frame.whole_plane) {
        plane_ = make_plane_dynamics(scenario, program_, coils_, dynamics_);
        transitions_.set_plane(*plane_);
    }
    const Start start = initial_state(scenario, model_);
    state_ = start.state;
    touches_down_ = start.touches_down;
    dynamics_.set_contact_age(start.contact_age);
}

void Player::begin_segment() {
    if (is_stepped()) drive_further_coils();
    is_open_ = true;
    dynamics_.set_contact_age(dynamics_.contact_age() + segment_.duration);
    segment_ = circuit_.advance(voltages_);
    tau_ = 0.0;
    memory_ = {.born = false};
    watch_.begin();
    dynamics_.begin_segment(segment_, state_.body.x, state_.body.z);
    if (plane_) plane_->field().begin_segment(segment_, place(state_.body));
}

// Coils that the scenario's drive does not use, and a step does.
void Player::drive_further_coils() {
    PerCoil gain = plane_ ? plane_->field().gain() : dynamics_.field().gain();
    const PerCoil before = gain;
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        if (voltages_.first[k] != 0.0 || voltages_.last[k] != 0.0) gain[k] = field_gain_[k];
    }
    if (gain == before) return;
    if (plane_) {
        plane_->field().set_gain(gain);
    } else {
        dynamics_.field().set_gain(gain);
    }
}

void Player::begin() {
    has_begun_ = true;
    if (plane_) {
        plane_->watch().begin(plane_->facing(plane_->field().at(0.0), place(state_.body)));
    }
    transitions_.begin(touches_down_);
    memory_ = {};
    memory_.stalled = watch_.stalled();
}

Status Player::handle(Event event) {
    watch_.event(time());
    if (event == Event::heading) {
        const Facing now = plane_->facing(plane_->field().at(tau_), place(state_.body));
        const Status status = plane_->watch().pass(now, time());
        if (status != Status::ok) return status;
    }
    transitions_.handle(event, tau_);
    memory_ = {};
    memory_.stalled = watch_.stalled();
    if (watch_.hangs()) return Status::too_many_events;
    const BodyState& body = state_.body;
    const double sum = state_.inner.place + state_.inner.velocity + body.x + body.y + body.z +
                       body.angle + body.vx + body.vy + body.vz + body.omega;
    return std::isfinite(sum) ? Status::ok : Status::not_finite;
}

void Player::stay_there() {
    if (is_at_end()) return;
    const SimulationState there = world();
    const auto own = [this](const PerCoil& v) { return model_.frame.to_robot(v); };
    circuit_.set_currents(own(there.current), own(there.field_lag), own(there.capacitor));
    dynamics_.set_contact_age(dynamics_.contact_age() + tau_);
    segment_.duration = tau_ = 0.0;
    is_open_ = false;
}

std::array<double, 3> Player::field(double tau, const BodyState& body) const {
    if (plane_) {
        const SpatialFieldValue b = plane_->field().at(tau)(body.x, body.y, body.z);
        return {b.bx, b.by, b.bz};
    }
    const PlanarField b = dynamics_.field_at(tau)(body.x, body.z);
    return {b.bx, 0.0, b.bz};
}

Pull Player::pull(double tau, const BodyState& body) const {
    const PlainDynamics<double>& robot = dynamics_.robot();
    const Pose pose = dynamics_.pose(body.angle);
    const double mx = robot.pull * robot.moment_x(pose), mz = robot.pull * robot.moment_z(pose);
    const auto pressing = [&](const Load& load) {
        return (state_.mode.touch == Touch::none ? 0.0 : load.contact_adhesion) - load.fz;
    };
    if (plane_) {
        const HeadedField seen = plane_->headed(plane_->field().at(tau), body.x, body.y, body.z);
        const Slip velocity = seen.heading.seen(body.vx, body.vy);
        const Slip pull = {mx * seen.along.dbx_dx + mz * seen.along.dbx_dz,
                           mx * seen.across_s + mz * seen.across_z};
        return {seen.heading.x(pull), seen.heading.y(pull),
                pressing(plane_->load(seen, tau, pose, velocity, body.vz, body.omega))};
    }
    const PlanarField field = dynamics_.field_at(tau)(body.x, body.z);
    return {
        mx * field.dbx_dx + mz * field.dbx_dz, 0.0,
        pressing(dynamics_.load(field, tau, body.x, body.z, pose, body.vx, body.vz, body.omega))};
}

PerCoilOf<CoilField> Player::field_of_coils() const {
    const BodyState& body = state_.body;
    return plane_ ? plane_->field().of_coils(place(body), body.heading)
                  : dynamics_.field().of_coils(dynamics_.in_ground(tau_, {body.x, body.z}));
}

FieldCourse Player::field_course() const {
    const BodyState& body = state_.body;
    FieldCourse result =
        plane_ ? plane_->field().course(place(body))
               : dynamics_.field().course(dynamics_.in_ground(tau_, {body.x, body.z}));
    result.segment = &segment_;
    return result;
}

SimulationState Player::world() const {
    SimulationState result = motion();
    // Within a segment the circuit is at its end already.
    PerCoil current = circuit_.currents(), lag = circuit_.field_lag();
    PerCoil capacitor = circuit_.capacitors();
    if (!is_at_end()) {
        capacitor = circuit_.capacitors(voltages_, segment_, tau_);
        current = segment_.currents(tau_);
        const PerCoil field = segment_.field_currents(tau_);
        for (std::size_t k = 0; k < kCoilCount; ++k) lag[k] = field[k] - current[k];
    }
    result.current = model_.frame.to_world(current);
    result.field_lag = model_.frame.to_world(lag);
    result.capacitor = model_.frame.to_world(capacitor);
    return result;
}

RunSnapshot Player::snapshot() const {
    RunSnapshot result;
    result.state = state_;
    result.contact_age = dynamics_.contact_age() + tau_;
    result.circuit = circuit_.memory();
    result.steps = source_.steps().memory();
    if (plane_) result.heading = plane_->watch().state();
    result.gain = plane_ ? plane_->field().gain() : dynamics_.field().gain();
    result.begun = has_begun_;
    result.touches_down = touches_down_;
    result.in_whole_plane = in_whole_plane();
    return result;
}

void Player::restore(const RunSnapshot& snapshot) {
    if (snapshot.in_whole_plane != in_whole_plane()) {
        throw std::invalid_argument(in_whole_plane()
                                        ? "the snapshot is of a run in one plane, and this one is "
                                          "in the whole plane"
                                        : "the snapshot is of a run in the whole plane, and this "
                                          "one is in one plane");
    }
    state_ = snapshot.state;
    dynamics_.set_quadrant(state_.body.quadrant);
    dynamics_.set_contact_age(snapshot.contact_age);
    circuit_.restore(snapshot.circuit);
    source_.restore(snapshot.steps);
    if (plane_) {
        plane_->watch().set_state(snapshot.heading);
        plane_->field().set_gain(snapshot.gain);
    } else {
        dynamics_.field().set_gain(snapshot.gain);
    }
    has_begun_ = snapshot.begun;
    touches_down_ = snapshot.touches_down;
    segment_.duration = tau_ = 0.0;
    is_open_ = false;
}

}  // namespace stickslip
