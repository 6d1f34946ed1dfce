#pragma once

#include <atomic>
#include <cstdint>

#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// Adaptive integration of a phase, with events located on the dense output of its steps. How steps
/// are made is the Method's, which has a
///   start(options, phase, memory, rates, progress)   of a phase, whose rates it begins with
///   Progress<Phase>   where the integration of a phase stands, with
///     tau, tau_end, accepted, most_steps, trace
///     step              the last attempt: start, width, first, last, dense(s); `first` of the next
///     samples           event functions of the last attempt, `start` of the next one
///     attempt(phase)    makes a step; true where it goes to the end of the segment
///     is_accepted(), reject(counts)   the second says why there can be no other attempt, or ok
///     event(phase, i, s)   event function i at a fraction of the step
///     commit(phase, true, to_end)   moves on to the end of the step
///     leave(phase, y, counts)       ends the phase there
template <class Method>
class StepLoop {
public:
    template <class Phase>
    using Progress = typename Method::template Progress<Phase>;

    explicit StepLoop(const StepperOptions& options) : options_(options), method_(options) {}

    const StepCounts& counts() const { return counts_; }
    /// Sets the counts to go on from; options.most_steps limits the sum.
    void set_counts(const StepCounts& counts) { counts_ = counts; }

    /// Integrates from `tau` to `tau_end` or the first event. `observe(step, s)` is called
    /// for the steps on the way, with the fraction s that belongs to the phase; it answers at which
    /// fraction the run is to stop, or kGoesOn.
    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            const typename Phase::State& y, Observer&& observe) {
        Progress<Phase> progress;
        begin(phase, memory, tau, tau_end, y, progress);
        PhaseEnd<Phase> end;
        while (true) {
            if (is_stopped()) return leave(phase, progress, Status::interrupted);
            const bool to_end = progress.attempt(phase);
            const double reached = progress.step.start + progress.step.width;
            const auto place = phase.place_of(reached, progress.step.last);
            const Finish found = finish(phase, memory, progress, to_end, true, place, observe, end);
            if (found == Finish::phase) return end;
            if (found == Finish::rejected) continue;
            progress.commit(phase, true, false);
            phase.field().rebase(place);
        }
    }

    // The parts of `advance`, for steps that a kernel makes (run/step_kernel.cpp).

    bool is_stopped() const {
        return options_.stop && options_.stop->load(std::memory_order_relaxed);
    }
    /// Ends the phase where the last step that was committed has ended.
    template <class Phase>
    PhaseEnd<Phase> leave(Phase& phase, Progress<Phase>& p, Status status) {
        p.leave(phase, p.step.first, counts_);
        return {status, Event::none, p.tau, p.step.first, p.trace};
    }

    template <class Phase>
    void begin(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
               const typename Phase::State& y, Progress<Phase>& progress) {
        typename Phase::State rates;
        phase.field().rebase(phase.place_of(tau, y));
        phase.rates(phase.field_at(tau), y, rates, progress.samples.start);
        ++counts_.evaluations;
        progress.tau = tau;
        progress.tau_end = tau_end;
        progress.accepted = 0.0;
        progress.most_steps = static_cast<double>(options_.most_steps - counts_.accepted);
        progress.step.first = y;
        progress.trace = {phase.angle(y), phase.angle(y), phase.slip_place(y)};
        method_.start(options_, phase, memory, rates, progress);
        memory.begin(progress.samples.start, phase.event_rounding());
    }

    /// Outcome of an attempt: an accepted step, still to be committed; a rejected one; the end of
    /// the phase or of the segment.
    enum class Finish { accepted, rejected, phase };
    /// Accepts an attempt or not and looks for events, if it `may_fire` one. place: where it ends.
    template <class Phase, class Observer>
    Finish finish(Phase& phase, PhaseMemory& memory, Progress<Phase>& p, bool to_end, bool may_fire,
                  const auto& place, Observer&& observe, PhaseEnd<Phase>& end) {
        const auto& step = p.step;
        const auto ended = [&](Status status) {
            end = leave(phase, p, status);
            return Finish::phase;
        };
        if (!(p.tau + step.width > p.tau)) return ended(Status::step_underflow);
        if (!p.is_accepted()) {
            const Status status = p.reject(counts_);
            return status != Status::ok ? ended(status) : Finish::rejected;
        }
        const auto value = [&](std::size_t i, double s) {
            ++counts_.evaluations;
            return p.event(phase, i, s);
        };
        EventHit hit;
        if (may_fire) {
            hit = find_event(p.samples, memory.armed, memory.stalled, value);
        } else {
            memory.armed.fill(true);  // those that had not risen have
        }
        memory.stalled = false;
        const double stop = observe(step, hit.s);
        const bool stops = hit ? stop < hit.s : stop <= 1.0;
        if (hit || stops) {
            const double s = stops ? stop : hit.s;
            const typename Phase::State last = s == 0.0 ? step.first : step.dense(s);
            p.trace.step(phase, s * step.width, step.first, last);
            p.accepted += 1.0;
            const Event event =
                stops ? Event::none : Phase::kEvent[static_cast<std::size_t>(hit.index)];
            end = {Status::ok, event, p.tau + s * step.width, last, p.trace};
            p.leave(phase, last, counts_);
            return Finish::phase;
        }
        phase.field().recentre(place);
        const bool is_spent = p.accepted + 1.0 >= p.most_steps;
        if (!phase.outside() && !to_end && !is_spent) return Finish::accepted;
        p.commit(phase, true, to_end);
        return ended(phase.outside() ? Status::left_workspace
                     : to_end        ? Status::ok
                                     : Status::too_many_steps);
    }

private:
    StepperOptions options_;
    StepCounts counts_;
    Method method_;
};

}  // namespace stickslip
