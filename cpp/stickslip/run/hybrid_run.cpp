#include "stickslip/run/hybrid_run.hpp"

#include <cmath>
#include <numbers>

#include "stickslip/scenario/coils.hpp"

namespace stickslip {
namespace {

// Of the velocity scale, at which a robot swings freely by a radian: what it hardly exceeds while
// the field turns. Twice as much changes no extreme of tests/test_extremes.py by 1e-6.
constexpr double kUsualSpeed = 0.1;

}  // namespace

HybridRun::HybridRun(const Scenario& scenario, RunControl* control,
                     std::optional<StopCondition> stop)
    : sign_(frame_sign(scenario)),
      window_(measuring_window(scenario)),
      program_(make_program(scenario)),
      hold_period_(scenario.effects.sample_hold_period),
      amplifier_limit_(scenario.effects.amplifier_limit_voltage),
      field_gain_(stickslip::field_gain(scenario)),
      chain_(make_measurement_chain(scenario)),
      coils_(robot_coil_set(scenario)),
      model_(make_model(scenario)),
      circuit_(make_circuit(scenario, program_)),
      dynamics_(model_, make_local_field(scenario, program_, coils_)),
      options_(make_stepper_options(scenario, model_, program_, coils_,
                                    control ? &control->stop : nullptr)),
      recorder_(scenario.record, chain_, sign_, turns(scenario)),
      observer_(pulse_period(scenario)),
      drive_(circuit_),
      control_(control),
      stop_(stop),
      max_check_interval_(max_check_interval(model_, options_)),
      source_(program_, hold_period_, marks()),
      transitions_(dynamics_, state_),
      // Fifty free swings.
      watch_(50.0 * 2.0 * std::numbers::pi / options_.swing_rate) {
    result_.most_steps = scenario.solver.max_steps;
    result_.swing_rate = options_.swing_rate;
    result_.decay = fastest_decay(scenario, model_, options_.swing_rate);
    result_.map = scenario.map;
    if (turns(scenario)) {
        plane_ = make_plane_dynamics(scenario, program_, coils_, dynamics_);
        transitions_.set_plane(*plane_);
    }
    const Start start = initial_state(scenario, model_);
    state_ = start.state;
    touches_down_ = start.touches_down;
    dynamics_.set_contact_age(start.contact_age);
}

bool HybridRun::next_phase() {
    while (goes_on()) {
        if (plane_ && stretch_is_open_) watch_heading();
        if (!goes_on()) break;
        if (tau_ >= segment_.duration) {
            if (!next_segment()) break;
        } else if (state_.rests()) {
            run_rest();
        } else {
            dynamics_.set_quadrant(state_.body.quadrant);
            return true;
        }
    }
    const bool failed = result_.status != Status::ok;
    if (source_.is_stepped()) {
        if (failed) stay_there();
    } else if (failed) {
        observe_to(tau_);
    } else {
        finish();
    }
    return false;
}

bool HybridRun::next_segment() {
    // The integrators look too; a body at rest needs none.
    if (control_ && control_->stop.load(std::memory_order_relaxed)) {
        result_.status = Status::interrupted;
        return false;
    }
    if (stretch_is_open_) end_stretch();
    if (!source_.next(voltages_)) return false;
    if (++segment_count_ > options_.most_steps) {
        result_.status = Status::too_many_steps;
        return false;
    }
    if (source_.is_stepped())
        drive_further_coils();
    else
        watch_window(voltages_.start);
    if (!goes_on()) return false;
    begin_segment(voltages_);
    if (!begun_) begin();
    return goes_on();
}

void HybridRun::end_stretch() {
    stretch_is_open_ = false;
    if (planar_watch_) {
        HorizontalField field = dynamics_.field().horizontal(state_.body.x, state_.body.z);
        field.segment = &segment_;
        planar_watch_->watch(field);
    }
    // A run that is stepped has no summary.
    if (!source_.is_stepped()) observe_stretch(segment_);
}

// Ends the run where its heading ends to be known.
void HybridRun::watch_heading() {
    constexpr double kRounding = 1e-9;  // s; the end is not known better
    if (plane_->has_moved()) plane_->watch_at(tau_, place(state_.body));
    const HeadingEnd& end = plane_->watch().end();
    if (tau_ < end.tau - kRounding) return;
    result_.status = end.status;
    result_.heading_end = end;
    state_.body.heading = plane_->watch().state().heading.angle();
}

void HybridRun::observe_stretch(const CurrentSegment& played) {
    drive_.stretch(voltages_, played, observer_.is_open());
    drive_.see_field(squared_field(played.duration, state_.body), observer_.is_open());
    drive_.pull(field_of_coils(), played,
                [this](double tau) { return dynamics_.field().factor(tau); });
}

PerCoilOf<CoilField> HybridRun::field_of_coils() const {
    const BodyState& body = state_.body;
    return plane_ ? plane_->field().of_coils(place(body), body.heading)
                  : dynamics_.field().of_coils(body.x, body.z);
}

void HybridRun::write_pull_and_change() {
    const double held = model_.friction.static_coefficient *
                        (dynamics_.robot().adhesion + model_.mass * std::abs(model_.gravity_z));
    const double moment = std::abs(model_.moment * (1.0 + model_.gradient_excess));
    result_.summary.pull_ratio = held > 0.0 ? moment * drive_.slope_max() / held : 0.0;
    const std::array<double, 3> before = drive_.steady_field(start_fields_),
                                now = drive_.steady_field(field_of_coils());
    const double size = std::hypot(before[0], before[1], before[2]);
    const double change = std::hypot(now[0] - before[0], now[1] - before[1], now[2] - before[2]);
    result_.summary.field_change = size > 0.0 ? change / size : 0.0;
}

// Where the field may turn in the stretch that has begun, of which the robot is at its start. There
// it is looked at within the steps, at the robot's place: in the course of a stretch it moves
// through a gradient.
void HybridRun::plan_looks() {
    const BodyState& body = state_.body;
    looks_.clear();
    const bool in_window = observer_.is_open();
    // The field goes on from the last stretch, but for the first of the run or of the window.
    if (!drive_.has_seen_field(in_window)) drive_.see_field(squared_field(0.0, body), in_window);
    if (plane_ ? plane_->field().has_shape() : dynamics_.field().has_shape()) {
        // A free shape may turn it anywhere.
        looks_.push_back({{0.0, segment_.duration}, true, in_window});
    } else {
        FieldCourse course =
            plane_ ? plane_->field().course(place(body)) : dynamics_.field().course(body.x, body.z);
        course.segment = &segment_;
        const double speed = kUsualSpeed * options_.scales.velocity;
        for_each_field_turn(course, speed, [&](const FieldTurn& turn, double least, double most) {
            const bool for_most = turn.curve <= 0.0 && drive_.would_be_most(most * most);
            const bool for_least =
                in_window && turn.curve >= 0.0 && drive_.would_be_least(least * least);
            if (for_most || for_least) looks_.push_back({turn, for_most, for_least});
        });
        std::reverse(looks_.begin(), looks_.end());
    }
    next_look_ = looks_.empty() ? kNoLook : looks_.back().turn.from;
}

void HybridRun::end_look() {
    looks_.pop_back();
    next_look_ = looks_.empty() ? kNoLook : looks_.back().turn.from;
}

std::array<double, 3> HybridRun::field(double tau, const BodyState& body) const {
    if (plane_) {
        const SpatialFieldValue b = plane_->field().at(tau)(body.x, body.y, body.z);
        return {b.bx, b.by, b.bz};
    }
    const PlanarField b = dynamics_.field_at(tau)(body.x, body.z);
    return {b.bx, 0.0, b.bz};
}

// Coils that the scenario's drive does not use, and a step does.
void HybridRun::drive_further_coils() {
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

// Boundaries of stretches carry rounding; the window's ends, and a stop's time, are some of them.
void HybridRun::watch_window(double time) {
    const double slack = 1e-9 * program_.duration();
    if (!measured_ && time >= window_.start - slack) {
        observer_.open(time, window_.end, state_.body);
        measured_ = true;
        if (plane_) turned_before_ = plane_->watch().state().turned;
    }
    if (observer_.is_open()) observer_.pass(time, state_.body);
    if (observer_.is_open() && time >= window_.end - slack) {
        close_window(time);
    }
    if (stop_ && stop_->quantity == StopCondition::Quantity::time) {
        result_.stopped = distance(time + slack, state_.body) <= 0.0;
    }
}

void HybridRun::close_window(double time) {
    observer_.close(time, state_.body, sign_, result_.summary);
    const double span = time - observer_.start();
    drive_.close(span, result_.summary);
    if (!(span > 0.0)) return;
    const double turned = plane_ ? plane_->watch().state().turned - turned_before_ : 0.0;
    result_.summary.turning_speed = turned * model_.shape.radius() / span;
}

std::vector<double> HybridRun::marks() const {
    std::vector<double> result = {window_.start, window_.end};
    if (stop_ && stop_->quantity == StopCondition::Quantity::time) {
        result.push_back(stop_->value);
        std::sort(result.begin(), result.end());
    }
    return result;
}

void HybridRun::begin() {
    transitions_.begin(touches_down_);
    begun_ = true;
    start_fields_ = field_of_coils();
    after_event(0.0);
}

SimulationState HybridRun::state() const {
    SimulationState result = motion();
    // Within a stretch the circuit is at its end already.
    PerCoil current = circuit_.currents(), lag = circuit_.field_lag();
    if (tau_ < segment_.duration) {
        current = segment_.currents(tau_);
        const PerCoil field = segment_.field_currents(tau_);
        for (std::size_t k = 0; k < kCoilCount; ++k) lag[k] = field[k] - current[k];
    }
    result.current = sign_ > 0.0 ? current : turned(current);
    result.field_lag = sign_ > 0.0 ? lag : turned(lag);
    return result;
}

PlaneHandover HybridRun::hand_over() const {
    PlaneHandover result = {state(), source_.steps().world_memory(), planar_watch_->state()};
    HeadingWatch::State& heading = result.heading;
    heading.lost = heading.lost || heading.heading.cosine < 0.0;
    heading.heading.cosine *= sign_;
    return result;
}

void HybridRun::take_over(const PlaneHandover& handover) {
    source_.restore(handover.steps);
    plane_->watch().set_state(handover.heading);
    if (!handover.heading.lost) return;
    result_.status = Status::heading_lost;
    result_.summary.simulated_time = source_.steps().time();
}

RunSnapshot HybridRun::snapshot() const {
    RunSnapshot result;
    result.state = state_;
    result.contact_age = dynamics_.contact_age() + tau_;
    result.circuit = circuit_.memory();
    result.steps = source_.steps().memory();
    result.heading = plane_ ? plane_->watch().state() : planar_watch_->state();
    result.gain = plane_ ? plane_->field().gain() : dynamics_.field().gain();
    result.begun = begun_;
    result.touches_down = touches_down_;
    result.in_whole_plane = in_whole_plane();
    result.status = result_.status;
    result.end = result_.summary.simulated_time;
    return result;
}

void HybridRun::restore(const RunSnapshot& snapshot) {
    state_ = snapshot.state;
    dynamics_.set_quadrant(state_.body.quadrant);
    dynamics_.set_contact_age(snapshot.contact_age);
    circuit_.restore(snapshot.circuit);
    source_.restore(snapshot.steps);
    (plane_ ? plane_->watch() : *planar_watch_).set_state(snapshot.heading);
    if (plane_) {
        plane_->field().set_gain(snapshot.gain);
    } else {
        dynamics_.field().set_gain(snapshot.gain);
    }
    begun_ = snapshot.begun;
    touches_down_ = snapshot.touches_down;
    result_.status = snapshot.status;
    result_.summary.simulated_time = snapshot.end;
    segment_.duration = tau_ = 0.0;
    stretch_is_open_ = false;
}

void HybridRun::stay_there() {
    if (tau_ >= segment_.duration) return;
    const SimulationState there = state();
    const auto own = [this](const PerCoil& world) { return sign_ > 0.0 ? world : turned(world); };
    circuit_.set_currents(own(there.current), own(there.field_lag));
    dynamics_.set_contact_age(dynamics_.contact_age() + tau_);
    segment_.duration = tau_ = 0.0;
    stretch_is_open_ = false;
}

void HybridRun::begin_segment(const VoltageSegment& voltages) {
    stretch_is_open_ = true;
    dynamics_.set_contact_age(dynamics_.contact_age() + segment_.duration);
    segment_ = circuit_.advance(voltages);
    tau_ = 0.0;
    memory_ = {.born = false};
    watch_.begin();
    dynamics_.begin_stretch(segment_, state_.body.x, state_.body.z);
    if (plane_) plane_->begin_stretch(segment_, place(state_.body));
    if (!source_.is_stepped()) plan_looks();
    fastest_decay_ =
        *std::max_element(segment_.rate.begin(), segment_.rate.begin() + segment_.exponentials);
}

// Of a run that ends within a stretch; where a stretch ends, it was observed as a whole.
void HybridRun::observe_to(double tau) {
    if (!stretch_is_open_ || !(tau > 0.0)) return;
    CurrentSegment played = segment_;
    played.duration = tau;
    observe_stretch(played);
    if (plane_) plane_->watch().cut(tau);
}

void HybridRun::finish() {
    if (result_.stopped) {
        observe_to(tau_);
        if (observer_.is_open()) close_window(absolute(tau_));
        return;
    }
    // The grid's last sample may lie beyond the end by rounding.
    sample_until(program_.duration() * (1.0 + 1e-12), absolute(0.0),
                 [&](double) { return snapshot(segment_.duration); });
    if (observer_.is_open()) close_window(program_.duration());
}

void HybridRun::record(double t, double tau, const Snapshot& snapshot) {
    recorder_.add(t, snapshot, state_.mode, field(tau, snapshot.body), segment_.currents(tau));
}

void HybridRun::handle(Event event, double tau) {
    watch_.event(absolute(tau));
    if (watch_.hangs()) result_.status = Status::too_many_events;
    transitions_.handle(event, tau);
    after_event(tau);
    const BodyState& body = state_.body;
    if (!std::isfinite(body.x + body.y + body.z + body.angle + body.vx + body.vy + body.vz +
                       body.omega)) {
        result_.status = Status::not_finite;
    }
}

void HybridRun::after_event(double tau) {
    memory_ = {};
    memory_.stalled = watch_.stalled();
    // A face that has landed may lie still from now on, so that no step looks.
    if (stop_ && distance(absolute(tau), state_.body) <= 0.0) result_.stopped = true;
    if (!recorder_.at_event(absolute(tau))) return;
    // One sample for each change at this instant, with the state after all of them.
    for (const EventKind kind : transitions_.changes()) {
        record(absolute(tau), tau, snapshot(tau));
        recorder_.add_event(kind);
    }
}

void HybridRun::run_rest() {
    if (plane_) {
        dynamics_.set_quadrant(state_.body.quadrant);
        const PlaneFaceRest rest(*plane_, state_.body);
        run_rest(rest, plane_->field().outside());
        if (result_.status == Status::ok) state_.body.heading = rest.body(tau_).heading;
    } else {
        const FaceRest rest(dynamics_, state_.body);
        run_rest(rest, dynamics_.field().outside());
    }
}

template <class Rest>
void HybridRun::run_rest(const Rest& rest, bool outside) {
    if (outside) {
        result_.status = Status::left_workspace;
        return;
    }
    RestEnd end = end_of_rest(rest, memory_, tau_, tau_end(), fastest_decay_, max_check_interval_,
                              options_.stop);
    const double stop = find_stop(rest, end.tau);
    result_.stopped = stop <= end.tau;
    if (result_.stopped) end = {Event::none, stop};
    observer_.rest(state_.body.theta());
    if (next_look_ <= end.tau) {
        look_at_field(tau_, end.tau, [this](double) -> const BodyState& { return state_.body; });
    }
    sample_until(absolute(end.tau), absolute(tau_), [&](double at) { return rest.snapshot(at); });
    pass_to(end.tau);
    if (end.event != Event::none) {
        handle(end.event, end.tau);
    } else if (end.tau < tau_end() && !result_.stopped) {
        result_.status = Status::interrupted;
    }
}

void HybridRun::pass_to(double tau) {
    result_.summary.simulated_time = absolute(tau);
    if (control_) control_->simulated_time.fetch_add(tau - tau_, std::memory_order_relaxed);
    tau_ = tau;
}

void HybridRun::fail(const WrenchNotFinite& failure) {
    result_.status = Status::not_finite;
    result_.effect = failure.effect;
    result_.summary.simulated_time = failure.time;
    if (source_.is_stepped()) {
        stay_there();
    } else {
        observe_to(failure.time - segment_.start);
    }
}

RunResult HybridRun::take_result(const StepCounts& counts) {
    drive_.write(result_.summary);
    if (begun_) write_pull_and_change();
    result_.steps = counts;
    result_.summary.events = transitions_.counts();
    observer_.write(sign_, result_.summary);
    chain_.apply(result_.summary);
    result_.recording = recorder_.take();
    result_.final_body = state_.body;
    result_.final_state = state();
    RunResult taken = std::move(result_);
    result_.map = taken.map;  // a restored run may fail again
    return taken;
}

}  // namespace stickslip
