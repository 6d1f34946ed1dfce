#include "stickslip/run/run.hpp"

#include <algorithm>
#include <vector>

namespace stickslip {

void Run::go() {
    try {
        while (next_phase()) play_phase();
    } catch (const WrenchNotFinite& failure) {
        fail(failure);
    }
}

bool Run::next_phase() {
    while (goes_on()) {
        if (!player_.is_at_end()) return true;
        if (!next_segment()) break;
    }
    if (result_.status != Status::ok) {
        end_here();
    } else if (!player_.is_stepped()) {
        finish();
    }
    return false;
}

void Run::end_here() {
    if (player_.is_stepped()) {
        player_.stay_there();
    } else {
        window_observer_.end_segment(player_.tau());
    }
}

bool Run::next_segment() {
    if (is_interrupted()) {
        result_.status = Status::interrupted;
        return false;
    }
    const bool is_stepped = player_.is_stepped();  // such a run has no summary
    if (player_.is_open()) {
        if (!is_stepped) window_observer_.end_segment(player_.segment().duration);
        player_.end_segment();
    }
    if (!player_.take_segment()) return false;
    if (++segments_played_ > player_.options().most_steps) {
        result_.status = Status::too_many_steps;
        return false;
    }
    if (!is_stepped) {
        const double time = player_.voltages().start;
        window_observer_.watch_window(time);
        if (player_.has_begun()) result_.stopped = stops_by(time);
        if (result_.stopped) return false;
    }
    player_.begin_segment();
    if (player_.is_outside()) {
        result_.status = Status::left_workspace;
        return false;
    }
    if (!is_stepped) window_observer_.plan_looks();
    if (!player_.has_begun()) begin();
    return goes_on();
}

void Run::begin() {
    player_.begin();
    window_observer_.begin();
    result_.stopped = stops_by(player_.time());
    after_event();
}

template <class Phase, bool kEffects>
void Run::play_in_kernel(Phase& phase, const StepKernel<Phase, kEffects>& kernel) {
    const LawSet& laws = player_.model().laws;
    StepNumbers<Phase, kEffects> numbers;
    enter(phase, numbers);
    while (true) {
        if (tsit5_.is_stopped()) {
            // The last step may already be in the record.
            if (numbers.done > 0.0) numbers.progress.commit(phase, true, false);
            phase.field().rebase(phase.place_of(numbers.progress.tau, numbers.progress.step.first));
            const auto end = tsit5_.leave(phase, numbers.progress, Status::interrupted);
            end_phase(phase, end, tsit5_.counts().accepted);
            return;
        }
        const StepRound round = kernel.run(numbers, laws.table(), laws.numbers());
        if (round.flagged == 0) continue;
        const Attempt found = finish(phase, numbers, round);
        if (found == Attempt::segment || found == Attempt::phase) return;
    }
}

void Run::play_phase() {
    player_.with_phase([this](auto phase) {
        if constexpr (requires { StepKernels().plain.of(phase); } && !decltype(phase)::kHasInner) {
            if (fits_kernels_) {
                const StepKernels& kernels = step_kernels();
                if (is_plain()) {
                    play_in_kernel(phase, kernels.plain.of(phase));
                } else {
                    play_in_kernel(phase, kernels.extended.of(phase));
                }
                return;
            }
        }
        const auto advance = [&](auto& method) {
            const auto end =
                method.advance(phase, player_.memory(), player_.tau(), player_.segment().duration,
                               phase.begin(player_.body()), observer(phase));
            end_phase(phase, end, method.counts().accepted);
        };
#ifdef STICKSLIP_WITH_ARKODE
        // A body at rest has no error that would tell ARKODE how far to step.
        if constexpr (!decltype(phase)::kRests) {
            if (arkode_) {
                arkode_->set_counts(tsit5_.counts());
                advance(*arkode_);
                tsit5_.set_counts(arkode_->counts());
                return;
            }
        }
#endif
        advance(tsit5_);
    });
}

void Run::finish() {
    const double end = result_.stopped ? player_.time() : player_.duration();
    // The grid's last sample may lie beyond the end by rounding. Where the run ends as it begins,
    // the first is left.
    sample_until(end * (1.0 + 1e-12), player_.absolute(0.0),
                 [&](double) { return player_.sample(player_.tau()); });
    if (result_.stopped) window_observer_.end_segment(player_.tau());
    window_observer_.close(end);
    result_.stopped = result_.stopped || stops_by(end);
}

// Whether the run is to stop where a segment begins or its drive ends, at `time`: within rounding,
// as all that has boundaries of segments for ends.
bool Run::stops_by(double time) const {
    return stop_ && stop_->quantity == StopCondition::Quantity::time &&
           distance(time + boundary_slack(player_.duration()), player_.body()) <= 0.0;
}

// Samples of the uniform grid in (…, limit] s of absolute time; `sample_at` in the segment.
void Run::sample_until(double limit, double from, FunctionRef<Sample(double tau)> sample_at) {
    for (double t = recorder_.next_time(); t <= limit && !is_interrupted();
         t = recorder_.next_time()) {
        const double tau = std::max(t, from) - player_.segment().start;
        record(t, tau, sample_at(tau));
    }
}

double Run::find_stop(double start, double width, double s,
                      FunctionRef<BodyState(double tau, double part)> body_of) const {
    if (stop_->quantity == StopCondition::Quantity::time) return kGoesOn;
    const EventHit hit = find_fall([&](double part) {
        const double at = part * s;
        const double tau = start + at * width;
        return distance(player_.absolute(tau), body_of(tau, at));
    });
    return hit ? hit.s * s : kGoesOn;
}

void Run::record(double t, double tau, const Sample& sample) {
    Sample seen = sample;
    seen.body = player_.in_ground(sample.body, t);
    seen.contact_x += seen.body.x - sample.body.x;
    recorder_.add(t, seen, player_.state().mode, player_.field(tau, sample.body),
                  player_.segment().currents(tau));
}

void Run::handle(Event event) {
    const Status status = player_.handle(event);
    if (status != Status::ok) result_.status = status;
    after_event();
}

void Run::after_event() {
    const double tau = player_.tau(), time = player_.time();
    if (stop_ && distance(time, player_.body()) <= 0.0) result_.stopped = true;
    if (!recorder_.at_event(time)) return;
    // One sample for each change at this instant, with the state after all of them.
    for (const EventKind kind : player_.changes()) {
        record(time, tau, player_.sample(tau));
        recorder_.add_event(kind);
    }
}

void Run::reset_counts() {
    segments_played_ = 0;
    result_.counted_from = time();
    tsit5_.set_counts({});
}

RunSnapshot Run::snapshot() const {
    RunSnapshot result = player_.snapshot();
    result.status = result_.status;
    result.end = result_.summary.simulated_time;
    return result;
}

void Run::restore(const RunSnapshot& snapshot) {
    player_.restore(snapshot);
    result_.status = snapshot.status;
    result_.heading_end = {};
    result_.summary.simulated_time = snapshot.end;
}

void Run::fail(const WrenchNotFinite& failure) {
    result_.status = Status::not_finite;
    result_.effect = failure.effect;
    result_.summary.simulated_time = failure.time;
    if (player_.is_stepped()) {
        player_.stay_there();
    } else {
        window_observer_.end_segment(failure.time - player_.segment().start);
    }
}

RunResult Run::take_result() {
    window_observer_.write(result_.summary);
    result_.steps = tsit5_.counts();
    result_.recording = recorder_.take();
    result_.final_body = player_.body();
    result_.final_state = player_.world();
    if (result_.status != Status::ok) result_.decay = decay();
    return std::move(result_);
}

std::string Run::message() const {
    RunResult now = result_;  // a stepped run has no record
    now.steps = tsit5_.counts();
    now.decay = decay();
    return stickslip::message(now);
}

}  // namespace stickslip
