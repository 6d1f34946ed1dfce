#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "stickslip/event_location.hpp"
#include "stickslip/stepping.hpp"

namespace stickslip {

/// A step of the Rosenbrock method RODAS, order 4(3), stiffly accurate, with its interpolant of
/// third order: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section VI.4.
template <class Phase>
struct RosenbrockStep {
    using State = typename Phase::State;
    double start = 0.0, width = 0.0;  ///< s
    State first = {}, last = {};
    State bend = {}, twist = {};  ///< of the interpolant

    State dense(double s) const {
        State y;
        for (std::size_t i = 0; i < y.size(); ++i) {
            y[i] = first[i] * (1.0 - s) + s * (last[i] + (1.0 - s) * (bend[i] + s * twist[i]));
        }
        return y;
    }
};

/// Integrates the phases in which a contact slips along a vector. The direction of a slow slip is
/// drawn to that of the force within a time that goes with the slip velocity: where a slip begins
/// and ends the equations are as stiff as one likes, although the motion is smooth. An explicit
/// method would follow that time, this one does not.
class Rosenbrock {
public:
    explicit Rosenbrock(const StepperOptions& options)
        : options_(options),
          first_width_(0.4 * std::pow(options.tolerance / 1e-6, 0.25) / options.swing_rate) {}

    const StepCounts& counts() const { return counts_; }
    void reset_counts() { counts_ = {}; }
    double memory() const { return width_; }
    void restore(double width) { width_ = width; }

    /// As `Tsit5::advance`. most_steps: that are left to the run.
    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            typename Phase::State y, std::int64_t most_steps, Observer&& observe);

private:
    /// Makes a step; its squared error over the tolerance.
    template <class Phase>
    double attempt(const Phase& phase, RosenbrockStep<Phase>& step,
                   const typename Phase::State& rates, const typename Phase::State& scale);

    StepperOptions options_;
    StepCounts counts_;
    double first_width_;  // s, of a phase
    double width_ = 0.0;  // s, carried along a phase from one stretch of voltage to the next
};

template <class Phase>
double Rosenbrock::attempt(const Phase& phase, RosenbrockStep<Phase>& step,
                           const typename Phase::State& rates, const typename Phase::State& scale) {
    constexpr int kDim = Phase::kDim;
    constexpr double kGamma = 0.25;
    constexpr double kAlpha[6] = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0};
    constexpr double kTime[6] = {0.25, -0.1043, 0.1035, -0.03620000000000023, 0.0, 0.0};
    constexpr double kA[6][5] = {
        {},
        {1.544},
        {0.9466785280815826, 0.2557011698983284},
        {3.314825187068521, 2.896124015972201, 0.9986419139977817},
        {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895},
        {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 1.0}};
    constexpr double kC[6][5] = {
        {},
        {-5.6688},
        {-2.430093356833875, -0.2063599157091915},
        {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
        {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.7089089320616},
        {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
         -6.058818238834054}};
    constexpr double kBend[5] = {10.12623508344586, -7.487995877610167, -34.80091861555747,
                                 -7.992771707568823, 1.025137723295662};
    constexpr double kTwist[5] = {-0.6762803392801253, 6.087714651680015, 16.43084320892478,
                                  24.76722511418386, -6.594389125716872};
    // Of the scale of a coordinate, and of the step: the root of the rounding; the rates change
    // smoothly with time, whose difference may be wide.
    constexpr double kNudge = 1e-8, kNudgeOfTime = 1e-3;

    using State = typename Phase::State;
    // The first coordinates are the place: over the nanometres of a step the rates do not see it.
    constexpr int kPlace = 2, kRest = kDim - kPlace;
    using Vector = Eigen::Matrix<double, kDim, 1>;
    using Map = Eigen::Map<const Vector>;
    const double h = step.width;
    typename Phase::Values unused;
    const auto rates_at = [&](const auto& field, const State& y) {
        State result;
        phase.rates(field, y, result, unused);
        return result;
    };
    const auto here = phase.field_at(step.start);
    Eigen::Matrix<double, kDim, kRest> derivatives;
    for (int j = 0; j < kRest; ++j) {
        State nudged = step.first;
        const auto k = static_cast<std::size_t>(kPlace + j);
        nudged[k] += kNudge * phase.nudge(options_.scales)[k];
        const double width = nudged[k] - step.first[k];
        const State changed = rates_at(here, nudged);
        derivatives.col(j) = (Map(changed.data()) - Map(rates.data())) / width;
    }
    Eigen::Matrix<double, kRest, kRest> system = -derivatives.template bottomRows<kRest>();
    system.diagonal().array() += 1.0 / (h * kGamma);
    const double later = kNudgeOfTime * h;
    const State changed = rates_at(phase.field_at(step.start + later), step.first);
    const Vector by_time = (Map(changed.data()) - Map(rates.data())) / later;
    const Eigen::PartialPivLU<Eigen::Matrix<double, kRest, kRest>> solver(system);
    counts_.evaluations += kRest + 1 + 5;

    std::array<Vector, 6> k;
    State y = step.first;
    for (std::size_t i = 0; i < 6; ++i) {
        Vector right = (h * kTime[i]) * by_time;
        y = step.first;
        for (std::size_t j = 0; j < i; ++j) {
            right += (kC[i][j] / h) * k[j];
            for (std::size_t r = 0; r < y.size(); ++r) {
                y[r] += kA[i][j] * k[j][static_cast<Eigen::Index>(r)];
            }
        }
        const State at = i == 0 ? rates : rates_at(phase.field_at(step.start + kAlpha[i] * h), y);
        right += Map(at.data());
        k[i].template tail<kRest>() = solver.solve(right.template tail<kRest>());
        k[i].template head<kPlace>() =
            (h * kGamma) * (right.template head<kPlace>() +
                            derivatives.template topRows<kPlace>() * k[i].template tail<kRest>());
    }
    double sum = 0.0;
    for (std::size_t r = 0; r < y.size(); ++r) {
        const auto row = static_cast<Eigen::Index>(r);
        step.last[r] = y[r] + k[5][row];
        step.bend[r] = step.twist[r] = 0.0;
        for (std::size_t j = 0; j < 5; ++j) {
            step.bend[r] += kBend[j] * k[j][row];
            step.twist[r] += kTwist[j] * k[j][row];
        }
        const double error = k[5][row] / (options_.tolerance * scale[r]);
        sum += error * error;
    }
    return sum / static_cast<double>(y.size());
}

template <class Phase, class Observer>
PhaseEnd<Phase> Rosenbrock::advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                                    typename Phase::State y, std::int64_t most_steps,
                                    Observer&& observe) {
    using State = typename Phase::State;
    using Values = typename Phase::Values;
    using Finder = EventFinder<Phase::kEvents>;
    phase.rebase(y);
    State rates;
    EventSamples<Phase::kEvents> samples;
    phase.rates(phase.field_at(tau), y, rates, samples.start);
    ++counts_.evaluations;
    if (memory.fresh) {
        width_ = first_width_;
        memory.begin(samples.start, phase.event_rounding());
        if (memory.stalled) width_ = std::min(width_, kShortestStep);
    } else {
        width_ = std::min(width_, 2.0 * first_width_);
    }
    PhaseEnd<Phase> end{
        Status::ok, Event::none, tau, y, {phase.angle(y), phase.angle(y), slip_place(phase, y)}};
    const auto leave = [&](Status status) {
        end.status = status;
        return end;
    };
    RosenbrockStep<Phase> step;
    step.last = y;
    bool rejected = false;
    while (tau < tau_end) {
        if (options_.stop && options_.stop->load(std::memory_order_relaxed)) {
            return leave(Status::interrupted);
        }
        if (most_steps-- <= 0) return leave(Status::too_many_steps);
        step.start = tau;
        step.first = end.y;
        double width = std::min(width_, std::max(phase.min_time_constant(), tau));
        width = std::min(width, phase.longest_step(end.y, rates));
        if (options_.max_step > 0.0) width = std::min(width, options_.max_step);
        const double speed = phase.speed(step.first);
        if (width * speed > 0.5 * phase.reach()) width = 0.5 * phase.reach() / speed;
        const bool to_end = tau + 1.0001 * width >= tau_end;
        step.width = to_end ? tau_end - tau : width;
        if (!(tau + step.width > tau)) return leave(Status::step_underflow);

        const double error = attempt(phase, step, rates, phase.scale(options_.scales, step.first));
        // Fourth order, of the squared error.
        const double factor = std::clamp(0.9 * std::pow(error, -0.125), 0.2, rejected ? 1.0 : 6.0);
        if (!(error <= 1.0)) {
            ++counts_.rejected;
            rejected = true;
            width_ = step.width * (std::isfinite(error) ? factor : 0.1);
            if (width_ >= 1e-15 * std::max(1e-3, tau_end)) continue;
            return leave(std::isfinite(error) ? Status::step_underflow : Status::not_finite);
        }
        rejected = false;
        width_ = to_end ? std::max(width_, step.width * factor) : step.width * factor;
        ++counts_.accepted;

        const auto look = [&](double s, const State& at, State& slope) {
            Values g;
            phase.rates(phase.field_at(step.start + s * step.width), at, slope, g);
            ++counts_.evaluations;
            return g;
        };
        State slope, last_rates;
        samples.early = look(Finder::kEarly, step.dense(Finder::kEarly), slope);
        samples.late = look(Finder::kLate, step.dense(Finder::kLate), slope);
        samples.end = look(1.0, step.last, last_rates);
        for (std::size_t i = 0; i < samples.lowest.size(); ++i) {
            samples.lowest[i] = std::min({samples.start[i], samples.early[i], samples.late[i]});
        }
        const EventHit hit =
            Finder::find(samples, memory.armed, memory.stalled, [&](std::size_t i, double s) {
                ++counts_.evaluations;
                return phase.event(i, step.start + s * step.width, step.dense(s));
            });
        memory.stalled = false;
        const double stop = observe(step, hit.s);
        const bool stops = hit ? stop < hit.s : stop <= 1.0;
        const double s = stops ? stop : hit.s;
        if (hit || stops) {
            end.tau = step.start + s * step.width;
            end.y = s == 0.0 ? step.first : step.dense(s);
            look(s, end.y, last_rates);
        } else {
            end.tau = tau = to_end ? tau_end : tau + step.width;
            end.y = step.last;
        }
        end.trace.step(phase, s * step.width, step.first, rates, end.y, last_rates);
        if (stops) return end;
        if (hit) {
            end.event = Phase::kEvent[static_cast<std::size_t>(hit.index)];
            return end;
        }
        rates = last_rates;
        samples.start = samples.end;
        phase.rebase(end.y);
        if (phase.outside()) return leave(Status::left_workspace);
    }
    return end;
}

}  // namespace stickslip
