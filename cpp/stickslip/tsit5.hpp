#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/event_location.hpp"
#include "stickslip/stepping.hpp"

namespace stickslip {

/// One step of the Runge-Kutta pair 5(4) of Ch. Tsitouras, Computers & Mathematics with
/// Applications 62 (2011) 770-775, with its free interpolant of fourth order.
template <class Phase>
struct Tsit5Step {
    using State = typename Phase::State;
    static constexpr std::size_t kDim = Phase::kDim;

    double start = 0.0;  ///< s
    double width = 0.0;  ///< s
    State first = {}, last = {};
    std::array<State, 7> slope = {};

    /// Coordinates at the fraction s of the step.
    State dense(double s) const {
        const double ss = s * s;
        const double b1 = -1.0530884977290216 * s * (s - 1.3299890189751412) *
                          (ss - 1.4364028541716351 * s + 0.7139816917074209);
        const double b2 = 0.1017 * ss * (ss - 2.1966568338249754 * s + 1.2949852507374631);
        const double b3 =
            2.490627285651252793 * ss * (ss - 2.38535645472061657 * s + 1.57803468208092486);
        const double b4 =
            -16.54810288924490272 * (s - 1.21712927295533244) * (s - 0.61620406037800089) * ss;
        const double b5 =
            47.37952196281928122 * (s - 1.203071208372362603) * (s - 0.658047292653547382) * ss;
        const double b6 = -34.87065786149660974 * (s - 1.2) * (s - 0.666666666666666667) * ss;
        const double b7 = 2.5 * (s - 1.0) * (s - 0.6) * ss;
        State y;
        for (std::size_t i = 0; i < kDim; ++i) {
            y[i] = first[i] + width * (b1 * slope[0][i] + b2 * slope[1][i] + b3 * slope[2][i] +
                                       b4 * slope[3][i] + b5 * slope[4][i] + b6 * slope[5][i] +
                                       b7 * slope[6][i]);
        }
        return y;
    }
};

/// Adaptive integration of a phase by Tsit5, with events located on the dense output.
class Tsit5 {
public:
    explicit Tsit5(const StepperOptions& options) : options_(options) {}

    const StepCounts& counts() const { return counts_; }

    /// Integrates from `tau` to `tau_end` or the first event. `observe(step, s)` is called for each
    /// step with the fraction of it that belongs to the phase.
    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            typename Phase::State y, Observer&& observe);

private:
    template <class Phase>
    double stages(const Phase& phase, Tsit5Step<Phase>& step,
                  EventSamples<Phase::kEvents>& samples);

    double next_width(double error);

    StepperOptions options_;
    StepCounts counts_;
    double width_ = 0.0;            // proposal carried along a phase
    double previous_error_ = 1e-4;  // of the proportional-integral controller
};

/// Fills the step's stages and end and returns the error norm (accepted if at most one).
template <class Phase>
double Tsit5::stages(const Phase& phase, Tsit5Step<Phase>& step,
                     EventSamples<Phase::kEvents>& samples) {
    constexpr double a21 = 0.161;
    constexpr double a31 = -0.008480655492356989, a32 = 0.335480655492357;
    constexpr double a41 = 2.8971530571054935, a42 = -6.359448489975075, a43 = 4.3622954328695815;
    constexpr double a51 = 5.325864828439257, a52 = -11.748883564062828, a53 = 7.4955393428898365,
                     a54 = -0.09249506636175525;
    constexpr double a61 = 5.86145544294642, a62 = -12.92096931784711, a63 = 8.159367898576159,
                     a64 = -0.071584973281401, a65 = -0.028269050394068383;
    constexpr double b1 = 0.09646076681806523, b2 = 0.01, b3 = 0.4798896504144996,
                     b4 = 1.379008574103742, b5 = -3.290069515436081, b6 = 2.324710524099774;
    constexpr double e1 = -0.00178001105222577714, e2 = -0.0008164344596567469,
                     e3 = 0.007880878010261995, e4 = -0.1447110071732629, e5 = 0.5823571654525552,
                     e6 = -0.45808210592918697, e7 = 1.0 / 66.0;
    constexpr std::size_t n = Phase::kDim;
    const auto& k = step.slope;
    const auto& y = step.first;
    const double h = step.width, t = step.start;
    typename Phase::State u;
    std::array<double, Phase::kEvents> g;
    auto lower = [&] {
        for (std::size_t i = 0; i < g.size(); ++i)
            samples.lowest[i] = std::min(samples.lowest[i], g[i]);
    };
    samples.lowest = samples.start;
    for (std::size_t i = 0; i < n; ++i) u[i] = y[i] + h * (a21 * k[0][i]);
    phase.rates(t + 0.161 * h, u, step.slope[1], samples.early);
    g = samples.early;
    lower();
    for (std::size_t i = 0; i < n; ++i) u[i] = y[i] + h * (a31 * k[0][i] + a32 * k[1][i]);
    phase.rates(t + 0.327 * h, u, step.slope[2], g);
    lower();
    for (std::size_t i = 0; i < n; ++i) {
        u[i] = y[i] + h * (a41 * k[0][i] + a42 * k[1][i] + a43 * k[2][i]);
    }
    phase.rates(t + 0.9 * h, u, step.slope[3], samples.late);
    g = samples.late;
    lower();
    for (std::size_t i = 0; i < n; ++i) {
        u[i] = y[i] + h * (a51 * k[0][i] + a52 * k[1][i] + a53 * k[2][i] + a54 * k[3][i]);
    }
    phase.rates(t + 0.9800255409045097 * h, u, step.slope[4], g);
    lower();
    for (std::size_t i = 0; i < n; ++i) {
        u[i] = y[i] +
               h * (a61 * k[0][i] + a62 * k[1][i] + a63 * k[2][i] + a64 * k[3][i] + a65 * k[4][i]);
    }
    phase.rates(t + h, u, step.slope[5], g);
    lower();
    for (std::size_t i = 0; i < n; ++i) {
        step.last[i] = y[i] + h * (b1 * k[0][i] + b2 * k[1][i] + b3 * k[2][i] + b4 * k[3][i] +
                                   b5 * k[4][i] + b6 * k[5][i]);
    }
    phase.rates(t + h, step.last, step.slope[6], samples.end);
    counts_.evaluations += 6;
    const auto scale = phase.scale(options_.scales);
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double error = h *
                             (e1 * k[0][i] + e2 * k[1][i] + e3 * k[2][i] + e4 * k[3][i] +
                              e5 * k[4][i] + e6 * k[5][i] + e7 * k[6][i]) /
                             scale[i];
        sum += error * error;
    }
    return std::sqrt(sum / static_cast<double>(n)) / options_.tolerance;
}

/// Factor on the width after an accepted step: the controller PI 4/5 of Hairer and Wanner.
inline double Tsit5::next_width(double error) {
    const double bounded = std::max(error, 1e-10);
    const double factor = 0.9 * std::pow(bounded, -0.17) * std::pow(previous_error_, 0.04);
    previous_error_ = std::max(error, 1e-4);
    return std::clamp(factor, 0.2, 8.0);
}

template <class Phase, class Observer>
PhaseEnd<Phase> Tsit5::advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                               typename Phase::State y, Observer&& observe) {
    using Finder = EventFinder<Phase::kEvents>;
    Tsit5Step<Phase> step;
    EventSamples<Phase::kEvents> samples;
    step.first = y;
    phase.rebase(tau, y);
    phase.rates(tau, y, step.slope[0], samples.start);
    ++counts_.evaluations;
    if (memory.fresh) {
        // A step carried over from another phase can leap over the whole of a short one.
        width_ = 0.02 / options_.swing_rate;
        previous_error_ = 1e-4;
        for (std::size_t i = 0; i < Phase::kEvents; ++i) {
            memory.armed[i] = samples.start[i] > 0.0;
        }
        memory.fresh = false;
    }
    const double least = 1e-15 * std::max(1e-3, tau_end);
    bool after_rejection = false;
    while (tau < tau_end) {
        if (options_.stop && options_.stop->load(std::memory_order_relaxed)) {
            return {Status::interrupted, Event::none, tau, step.first};
        }
        double width = options_.max_step > 0.0 ? std::min(width_, options_.max_step) : width_;
        const bool to_end = tau + 1.0001 * width >= tau_end;
        if (to_end) width = tau_end - tau;
        step.start = tau;
        step.width = width;
        const double error = stages(phase, step, samples);
        if (!(error <= 1.0)) {
            ++counts_.rejected;
            const double factor =
                std::isfinite(error) ? std::max(0.2, 0.9 * std::pow(error, -0.2)) : 0.1;
            width_ = width * factor;
            after_rejection = true;
            if (width_ < least) {
                return {std::isfinite(error) ? Status::step_underflow : Status::not_finite,
                        Event::none, tau, step.first};
            }
            continue;
        }
        ++counts_.accepted;
        const auto value = [&](std::size_t i, double s) {
            typename Phase::State unused;
            typename Phase::Values g;
            phase.rates(step.start + s * step.width, step.dense(s), unused, g);
            ++counts_.evaluations;
            return g[i];
        };
        const EventHit hit = Finder::find(samples, memory.armed, value);
        if (hit) {
            observe(step, hit.s);
            return {Status::ok, Phase::kEvent[static_cast<std::size_t>(hit.index)],
                    tau + hit.s * width, hit.s == 0.0 ? step.first : step.dense(hit.s)};
        }
        observe(step, 1.0);
        const double factor = next_width(error);
        // The last step of a stretch may have been cut short; its length says nothing of the next.
        const double proposal = width * (after_rejection ? std::min(factor, 1.0) : factor);
        width_ = to_end ? std::max(width_, proposal) : proposal;
        after_rejection = false;
        tau = to_end ? tau_end : tau + width;
        step.first = step.last;
        step.slope[0] = step.slope[6];
        samples.start = samples.end;
        phase.rebase(tau, step.first);
        if (phase.outside()) return {Status::left_workspace, Event::none, tau, step.first};
    }
    return {Status::ok, Event::none, tau_end, step.first};
}

}  // namespace stickslip
