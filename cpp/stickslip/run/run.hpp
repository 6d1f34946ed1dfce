#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "stickslip/run/player.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/run/simulation.hpp"
#include "stickslip/run/step_numbers.hpp"
#include "stickslip/run/window_observer.hpp"
#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/tsit5.hpp"
#ifdef STICKSLIP_WITH_ARKODE
#include "stickslip/solver/arkode.hpp"
#endif

namespace stickslip {

/// One run, from its scenario's initial state to the end of its drive, or step by step. A Player
/// moves the robot, a Recorder and a WindowObserver look at each step.
class Run {
public:
    /// Ends early where `stop` is met. Throws std::invalid_argument for a method that is not in
    /// this build.
    explicit Run(const Scenario& scenario, RunControl* control = nullptr,
                 std::optional<StopCondition> stop = std::nullopt);

    /// Plays to the end; the result is then to be taken.
    void go();
    RunResult take_result();
    /// Sentence on how it ended and what to do about it; see stickslip::message.
    std::string message() const;
    /// Gives the record's sink what there is.
    void hand_over_record() { recorder_.take(); }

    /// See Player. After its last step such a run can be given more.
    void play_steps(std::function<void()> on_step) { player_.play_steps(std::move(on_step)); }
    ControlSteps& steps() { return player_.steps(); }
    const ControlSteps& steps() const { return player_.steps(); }
    /// Counts anew what solver.max_steps limits.
    void reset_counts();
    RunSnapshot snapshot() const;
    void restore(const RunSnapshot& snapshot);
    Status status() const { return result_.status; }
    /// Time (s) that the run has reached, or at which it failed.
    double time() const { return result_.summary.simulated_time; }
    const Player& player() const { return player_; }

    // For lanes, which integrate the phases of several runs together.

    /// Plays up to the next phase that has to be integrated; false if the run is over.
    bool next_phase();
    /// Integrates that phase up to its end, or that of the segment of voltage.
    void play_phase();
    Player& player() { return player_; }
    /// Writes the numbers that the steps of the phase begin with.
    template <class Phase, bool kEffects>
    void enter(Phase& phase, StepNumbers<Phase, kEffects>& numbers);
    /// Outcome of an attempt. With a `far_step` the field's far centre has moved; after a segment
    /// of voltage the phase goes on.
    enum class Attempt { step, far_step, segment, phase };
    /// Accepts an attempt or not, looks for events, and says in the numbers how to go on.
    template <class Phase, bool kEffects>
    Attempt finish(Phase& phase, StepNumbers<Phase, kEffects>& numbers, const StepRound& round);
    /// Ends the run where it is.
    void give_up(Status status) {
        result_.status = status;
        end_here();
    }
    /// Whether packs can have it: a kernel makes its steps, and it has no stop condition and no
    /// record on a grid.
    bool fits_packs() const { return fits_kernels_ && !recorder_.on_grid() && !stop_; }
    /// Whether its phases have no named effect.
    bool is_plain() const {
        return player_.dynamics().is_plain() && player_.circuit().exponentials() == 1;
    }

private:
    bool is_tsit5() const {
#ifdef STICKSLIP_WITH_ARKODE
        return !arkode_;
#else
        return true;
#endif
    }
    // Observer that is called for each step of a phase, see StepLoop::advance.
    template <class Phase>
    auto observer(Phase& phase);
    // Goes on from where a phase has ended, after so many steps of the run.
    template <class Phase>
    void end_phase(Phase& phase, const PhaseEnd<Phase>& end, std::int64_t steps_taken);
    template <class Phase, bool kEffects>
    void play_in_kernel(Phase& phase, const StepKernel<Phase, kEffects>& kernel);
    // Time (s, in the segment) from which on steps have to be looked at.
    double next_look() const;
    template <class Phase, bool kEffects>
    void set_around(StepNumbers<Phase, kEffects>& numbers) const;
    template <class Phase, bool kEffects>
    void set_memory(StepNumbers<Phase, kEffects>& numbers);
    bool next_segment();
    // Ends a run within a segment.
    void end_here();
    void begin();
    void finish();
    bool goes_on() const {
        return result_.status == Status::ok && !result_.stopped;
    }
    bool is_interrupted() const {
        return control_ && control_->stop.load(std::memory_order_relaxed);
    }
    void handle(Event event);
    void after_event();
    void sample_until(double limit, double from, FunctionRef<Sample(double tau)> sample_at);
    void record(double t, double tau, const Sample& sample);
    double distance(double t, const BodyState& body) const {
        return stop_->distance(t, player_.sign(), player_.in_ground(body, t));
    }
    bool stops_by(double time) const;
    // The fraction, up to s, of a step at which the condition is met, or kGoesOn.
    double find_stop(double start, double width, double s,
                     FunctionRef<BodyState(double tau, double part)> body_of) const;
    void fail(const WrenchNotFinite& failure);
    Decay decay() const {
        return fastest_decay(player_.model(), player_.options().swing_rate);
    }

    Player player_;
    WindowObserver window_observer_;
    Recorder recorder_;
    Tsit5 tsit5_;
    bool fits_kernels_;  // no effect but smooth ones
#ifdef STICKSLIP_WITH_ARKODE
    std::optional<Arkode> arkode_;  // where solver.method asks for it
#endif
    RunControl* control_;
    const std::optional<StopCondition> stop_;
    RunResult result_;
    std::int64_t segments_played_ = 0;
};

template <class Phase>
auto Run::observer(Phase& phase) {
    return [this, &phase](const auto& step, double s) {
        const auto body_of = [&](double tau, double part) {
            return phase.body(tau, part == 0.0 ? step.first : step.dense(part));
        };
        const auto body_at = [&](double tau) {
            return body_of(tau, (tau - step.start) / step.width);
        };
        double stop = kGoesOn;
        const double met = stop_ ? find_stop(step.start, step.width, s, body_of) : kGoesOn;
        if (met <= s) s = stop = met;
        if constexpr (Phase::kTurns) {
            PlaneDynamics& plane = player_.plane();
            const auto facing = [&](double tau) { return plane.facing(phase.field_at(tau)); };
            const HeadingEnd end = plane.watch().follow(player_.absolute(0.0), step.start,
                                                        step.start + s * step.width, facing);
            if (end.status != Status::ok) {
                result_.heading_end = end;
                s = stop = (end.tau - step.start) / step.width;
            }
        }
        result_.stopped = met <= s && result_.heading_end.status == Status::ok;
        const double last = step.start + s * step.width;
        if (last >= window_observer_.next_look()) {
            window_observer_.look_at_field(step.start, last, body_at);
        }
        if (window_observer_.weighs()) window_observer_.weigh(step.start, last, body_at);
        const double limit = player_.absolute(last);
        if (recorder_.next_time() <= limit) {
            sample_until(limit, player_.absolute(step.start), [&](double at) {
                return phase.sample(at, step.dense((at - step.start) / step.width));
            });
        }
        return stop;
    };
}

inline double Run::next_look() const {
    if (stop_ || window_observer_.weighs()) return 0.0;
    const double sample = recorder_.next_time() - player_.segment().start;
    // Either side of the difference is rounded.
    return std::min(window_observer_.next_look(), sample - 1e-9 * std::abs(sample));
}

template <class Phase, bool kEffects>
void Run::enter(Phase& phase, StepNumbers<Phase, kEffects>& numbers) {
    tsit5_.begin(phase, player_.memory(), player_.tau(), player_.segment().duration,
                 phase.begin(player_.body()), numbers.progress);
    numbers.progress.look = next_look();
    numbers.robot = player_.dynamics().robot();
    set_around(numbers);
    numbers.contact_x = phase.contact(numbers.progress.step.first)[0];
    numbers.slip = player_.state().mode.slip;
    numbers.workspace = player_.dynamics().field().workspace();
    numbers.done = 0.0;
    numbers.place = {};
    set_memory(numbers);
}

template <class Phase, bool kEffects>
void Run::set_around(StepNumbers<Phase, kEffects>& numbers) const {
    const LocalField& field = player_.dynamics().field();
    numbers.far = field.far();
    numbers.field = field.segment();
    if constexpr (kEffects) {
        numbers.named = {{field.further(1), field.further(2)}, player_.dynamics().law_moment()};
    }
}

template <class Phase, bool kEffects>
void Run::set_memory(StepNumbers<Phase, kEffects>& numbers) {
    const PhaseMemory& memory = player_.memory();
    for (std::size_t i = 0; i < Phase::kEvents; ++i) {
        numbers.unarmed[i] = memory.armed[i] ? 0.0 : 1.0;
    }
    numbers.stalled = memory.stalled ? 1.0 : 0.0;
}

template <class Phase, bool kEffects>
Run::Attempt Run::finish(Phase& phase, StepNumbers<Phase, kEffects>& numbers,
                         const StepRound& round) {
    PhaseMemory& memory = player_.memory();
    for (std::size_t i = 0; i < Phase::kEvents; ++i) memory.armed[i] = numbers.unarmed[i] == 0.0;
    LocalField& field = player_.dynamics().field();
    if (field.centre() != numbers.field.centre) {
        field.set_near(numbers.field);
        if constexpr (kEffects) {
            field.set_near(1, numbers.named.further[0]);
            field.set_near(2, numbers.named.further[1]);
        }
    }
    const auto far = field.far().centre;
    PhaseEnd<Phase> end;
    const Tsit5::Finish found =
        tsit5_.finish(phase, memory, numbers.progress, round.to_end != 0, round.may_fire != 0,
                      numbers.place, observer(phase), end);
    if (found == Tsit5::Finish::phase) {
        const bool goes_on = end.status == Status::ok && end.event == Event::none;
        end_phase(phase, end, tsit5_.counts().accepted);
        return goes_on ? Attempt::segment : Attempt::phase;
    }
    numbers.done = found == Tsit5::Finish::accepted ? 1.0 : 0.0;
    numbers.progress.look = next_look();
    set_memory(numbers);
    if (field.far().centre == far) return Attempt::step;
    set_around(numbers);
    return Attempt::far_step;
}

template <class Phase>
void Run::end_phase(Phase& phase, const PhaseEnd<Phase>& end, std::int64_t steps_taken) {
    const double duration = end.tau - player_.tau();
    window_observer_.phase(phase, end, duration);
    player_.end_phase(phase, end);
    result_.summary.simulated_time = player_.time();
    if (control_) control_->add_time(duration);
    result_.status = end.status;
    if (result_.heading_end.status != Status::ok) {
        result_.status = result_.heading_end.status;
        return;
    }
    // Near the point where sliding loses its solution the reaction grows faster than any step can
    // follow: the limit is the impulse that stops the slip.
    if constexpr (requires { phase.nearly_jams(end.tau, end.y); }) {
        if (end.status == Status::step_underflow && phase.nearly_jams(end.tau, end.y)) {
            result_.status = Status::ok;
            handle(Event::sliding_jams);
            return;
        }
    }
    if (end.status == Status::ok && end.event != Event::none) handle(end.event);
    // A phase that ends in its first step does not look at the budget.
    const bool spent = steps_taken > player_.options().most_steps;
    if (result_.status == Status::ok && spent) result_.status = Status::too_many_steps;
}

}  // namespace stickslip
