#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "stickslip/contact/contact_transitions.hpp"
#include "stickslip/contact/phase_of.hpp"
#include "stickslip/drive/segment_source.hpp"
#include "stickslip/field/turning_points.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/initial_state.hpp"
#include "stickslip/run/run_snapshot.hpp"
#include "stickslip/solver/progress_watch.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// Pull of the field's gradient, and the force that it is compared with.
struct Pull {
    double x = 0.0, y = 0.0;  ///< N, along the surface, in the robot's own frame
    /// N, with which everything but inertia and the normal force presses on the surface.
    double pressing = 0.0;
};

/// The motion of a run: segments of voltage one after another, the phases between events, and what
/// each event makes of the state. It depends
/// neither on the method nor on what is recorded or measured.
class Player {
public:
    /// marks: further times (s) at which a segment must end. stop: ends the motion from outside; or
    /// nullptr.
    Player(const Scenario& scenario, const std::vector<double>& marks,
           const std::atomic<bool>* stop);
    // Members point to members.
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// Plays the steps of `steps()` from now on, and not the drive of the scenario, which says only
    /// how strong the fields are. `on_step` is called at the end of each step.
    void play_steps(std::function<void()> on_step) {
        source_.play_steps({hold_period_, amplifier_limit_, latency_, sign() < 0.0},
                           std::move(on_step));
    }
    bool is_stepped() const { return source_.is_stepped(); }
    ControlSteps& steps() { return source_.steps(); }
    const ControlSteps& steps() const { return source_.steps(); }

    bool in_whole_plane() const { return plane_.has_value(); }
    double sign() const { return model_.frame.sign; }
    /// The body in the ground's frame, carried by the surface, `time` s since the run began.
    BodyState in_ground(BodyState body, double time) const {
        const SurfaceMotion surface = model_.shake.at(time);
        body.x += surface.x;
        body.z += surface.z;
        body.vx += surface.vx;
        body.vz += surface.vz;
        return body;
    }
    double duration() const { return latency_ + program_.duration(); }  ///< s, of the whole drive
    const Model& model() const { return model_; }
    const Circuit& circuit() const { return circuit_; }
    const StepperOptions& options() const { return options_; }

    // Segments.

    /// Takes the next segment and returns true; false where all is played.
    bool take_segment() { return source_.next(voltages_); }
    void begin_segment();
    void end_segment() { is_open_ = false; }
    /// Whether a segment has begun, and `end_segment` was not called yet.
    bool is_open() const { return is_open_; }
    bool is_at_end() const { return tau_ >= segment_.duration; }
    const VoltageSegment& voltages() const { return voltages_; }
    const CurrentSegment& segment() const { return segment_; }
    double tau() const { return tau_; }  ///< s, in the segment
    double absolute(double tau) const { return segment_.start + tau; }
    double time() const { return absolute(tau_); }
    /// The motion ends within the segment: the currents are from now on those of that instant.
    void stay_there();

    // Phases.

    /// Calls `use` with the phase of the state.
    void with_phase(auto&& use) {
        dynamics_.set_quadrant(state_.body.quadrant);
        if (plane_) {
            stickslip::with_phase(TurningFrame(*plane_, state_.body.heading), state_, use);
        } else {
            stickslip::with_phase(FixedFrame(dynamics_), state_, use);
        }
    }
    /// The motion begins: with the mode that the forces allow.
    void begin();
    bool has_begun() const { return has_begun_; }
    /// Goes on from where a phase has ended.
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end);
    /// Handles an event where the last phase ended; ok, or why the motion ends.
    Status handle(Event event);
    /// Changes of the contact by the last event.
    const std::vector<EventKind>& changes() const { return transitions_.changes(); }
    const std::array<std::int64_t, kEventKinds>& counts() const { return transitions_.counts(); }

    Dynamics& dynamics() { return dynamics_; }
    const Dynamics& dynamics() const { return dynamics_; }
    PlaneDynamics& plane() { return *plane_; }
    const PlaneDynamics& plane() const { return *plane_; }
    PhaseMemory& memory() { return memory_; }
    const HybridState& state() const { return state_; }
    const BodyState& body() const { return state_.body; }

    // Values at the robot's place.

    /// Whether the robot has left the place where the field is known.
    bool is_outside() const {
        return plane_ ? plane_->field().outside() : dynamics_.field().outside();
    }
    /// Field at the robot's place, `tau` seconds into the segment, T.
    std::array<double, 3> field(double tau, const BodyState& body) const;
    /// The pull on a body, `tau` seconds into the segment.
    Pull pull(double tau, const BodyState& body) const;
    /// Field and gradient of each coil there, per ampere.
    PerCoilOf<CoilField> field_of_coils() const;
    /// Whether a free shape, or the surface, may turn the field anywhere; else its course over the
    /// segment.
    bool has_field_shape() const {
        return plane_ ? plane_->field().has_shape()
                      : dynamics_.field().has_shape() || !model_.shake.absent();
    }
    FieldCourse field_course() const;
    /// Sample at `tau` seconds into the segment.
    Sample sample(double tau) const {
        return plane_ ? stickslip::sample(*plane_, state_, tau)
                      : stickslip::sample(dynamics_, state_, tau);
    }
    /// Total angle by which the heading has turned to and fro, rad.
    double turned() const { return plane_ ? plane_->watch().state().turned : 0.0; }

    /// State in the world's frame, without currents.
    SimulationState motion() const {
        return world_state(state_, dynamics_.contact_age() + tau_, sign(), in_whole_plane());
    }
    SimulationState world() const;
    /// Snapshot between two steps, or where one has failed, without the Run's knowledge of its end.
    RunSnapshot snapshot() const;
    /// Throws std::invalid_argument for a snapshot of a run in another plane.
    void restore(const RunSnapshot& snapshot);

private:
    static Place place(const BodyState& body) { return {body.x, body.y, body.z}; }
    void drive_further_coils();

    const Model model_;
    const VoltageProgram program_;
    const double hold_period_;      // s, effect `sample_hold`
    const double amplifier_limit_;  // V, effect of that name
    const double latency_;          // s, of the drive
    const PerCoil field_gain_;
    const CoilSet coils_;
    Circuit circuit_;
    Dynamics dynamics_;
    const StepperOptions options_;
    std::optional<PlaneDynamics> plane_;  // of a robot that moves in the whole plane

    SegmentSource source_;
    VoltageSegment voltages_;
    CurrentSegment segment_;
    double tau_ = 0.0;
    bool is_open_ = false, has_begun_ = false;
    bool touches_down_ = false;  // as the motion begins
    HybridState state_;
    ContactTransitions transitions_;
    ProgressWatch watch_;
    PhaseMemory memory_;
};

template <class Phase>
void Player::end_phase(Phase& phase, const PhaseEnd<Phase>& end) {
    tau_ = end.tau;
    state_.body = phase.body(end.tau, end.y);
    if constexpr (Phase::kHasInner) state_.inner = phase.inner(end.y);
    if constexpr (Phase::kSlips) {
        const auto contact = phase.contact(end.y), slip = phase.slip(end.y);
        state_.contact_x = contact[0];
        state_.slip_velocity = slip[0];
        if constexpr (Phase::kTurns) {
            state_.contact_y = contact[1];
            state_.slip_y = slip[1];
        }
    }
}

}  // namespace stickslip
