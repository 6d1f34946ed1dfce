#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

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
    State weight = {};  ///< of each coordinate's error in the norm

    /// Coordinates at a fraction of the step, each had where it is asked for: most event functions
    /// need one or two.
    class At {
    public:
        At(const Tsit5Step& step, double s) : step_(step), b_(weights(s)) {}
        double operator[](std::size_t i) const {
            const auto& k = step_.slope;
            return step_.first[i] + step_.width * (b_[0] * k[0][i] + b_[1] * k[1][i] +
                                                   b_[2] * k[2][i] + b_[3] * k[3][i] +
                                                   b_[4] * k[4][i] + b_[5] * k[5][i] +
                                                   b_[6] * k[6][i]);
        }
        operator State() const {
            State y;
            for (std::size_t i = 0; i < kDim; ++i) y[i] = (*this)[i];
            return y;
        }

    private:
        const Tsit5Step& step_;
        std::array<double, 7> b_;
    };

    State dense(double s) const { return At(*this, s); }

    static std::array<double, 7> weights(double s) {
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
        return {b1, b2, b3, b4, b5, b6, b7};
    }
};

/// Coefficients of the pair. The last row of `a` is the step itself (first same as last).
struct Tsit5Table {
    static constexpr std::array<double, 6> c = {0.0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0};
    static constexpr double a[6][6] = {
        {0.161},
        {-0.008480655492356989, 0.335480655492357},
        {2.8971530571054935, -6.359448489975075, 4.3622954328695815},
        {5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525},
        {5.86145544294642, -12.92096931784711, 8.159367898576159, -0.071584973281401,
         -0.028269050394068383},
        {0.09646076681806523, 0.01, 0.4798896504144996, 1.379008574103742, -3.290069515436081,
         2.324710524099774}};
    static constexpr std::array<double, 7> error = {-0.00178001105222577714,
                                                    -0.0008164344596567469,
                                                    0.007880878010261995,
                                                    -0.1447110071732629,
                                                    0.5823571654525552,
                                                    -0.45808210592918697,
                                                    1.0 / 66.0};
};

/// Adaptive integration of a phase by Tsit5, with events located on the dense output.
class Tsit5 {
public:
    explicit Tsit5(const StepperOptions& options)
        : options_(options),
          first_width_(0.4 * std::pow(options.tolerance / 1e-6, 0.2) / options.swing_rate) {}

    const StepperOptions& options() const { return options_; }
    const StepCounts& counts() const { return counts_; }

    /// Integrates from `tau` to `tau_end` or the first event. `observe(step, s)` is called for each
    /// step with the fraction of it that belongs to the phase.
    template <class Phase, class Observer>
    PhaseEnd<Phase> advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                            typename Phase::State y, Observer&& observe);

private:
    template <std::size_t N>
    using Stage = std::integral_constant<std::size_t, N>;

    template <class Phase>
    double stages(const Phase& phase, Tsit5Step<Phase>& step,
                  EventSamples<Phase::kEvents>& samples);

    double next_width(double squared_error);

    StepperOptions options_;
    StepCounts counts_;
    double first_width_;  // s, of a phase: a part of a free swing that the tolerance allows
    double width_ = 0.0;  // s, proposal carried along a phase
    // The controller takes an error below 1e-4 of the tolerance for that.
    static constexpr float kLeastLogError = -13.3f;  // base 2
    float previous_log_error_ = kLeastLogError;
};

/// Fills the step's stages and end and returns the squared error norm (accepted if at most one).
template <class Phase>
double Tsit5::stages(const Phase& phase, Tsit5Step<Phase>& step,
                     EventSamples<Phase::kEvents>& samples) {
    using Table = Tsit5Table;
    using State = typename Phase::State;
    const double h = step.width;
    // The field at the stages' times does not wait for the stages: it is had at once, and the
    // processor overlaps it with the chain of dependent stages.
    std::array<Expansion, 5> field;
    for (std::size_t s = 0; s < 5; ++s) field[s] = phase.field_at(step.start + Table::c[s + 1] * h);

    const auto stage_end = [&](auto row) {
        constexpr std::size_t kStages = decltype(row)::value;
        State y = step.first;
        for (std::size_t j = 0; j < kStages; ++j) {
            const double weight = h * Table::a[kStages - 1][j];
            for (std::size_t i = 0; i < y.size(); ++i) y[i] += weight * step.slope[j][i];
        }
        return y;
    };
    const auto lower = [&](const typename Phase::Values& g) {
        for (std::size_t i = 0; i < g.size(); ++i) {
            samples.lowest[i] = std::min(samples.lowest[i], g[i]);
        }
    };
    typename Phase::Values g;
    samples.lowest = samples.start;
    phase.rates(field[0], stage_end(Stage<1>()), step.slope[1], samples.early);
    lower(samples.early);
    phase.rates(field[1], stage_end(Stage<2>()), step.slope[2], g);
    lower(g);
    phase.rates(field[2], stage_end(Stage<3>()), step.slope[3], samples.late);
    lower(samples.late);
    phase.rates(field[3], stage_end(Stage<4>()), step.slope[4], g);
    lower(g);
    phase.rates(field[4], stage_end(Stage<5>()), step.slope[5], g);
    lower(g);
    step.last = stage_end(Stage<6>());
    phase.rates(field[4], step.last, step.slope[6], samples.end);
    counts_.evaluations += 6;

    double sum = 0.0;
    for (std::size_t i = 0; i < step.last.size(); ++i) {
        double error = 0.0;
        for (std::size_t j = 0; j < 7; ++j) error += Table::error[j] * step.slope[j][i];
        error *= h * step.weight[i];
        sum += error * error;
    }
    return sum;
}

/// Factor on the width after an accepted step: the controller PI of Hairer and Wanner, with
/// exponents 0.17 and 0.04 for the fifth order. It needs no more than single precision, and the
/// next step waits for it.
inline double Tsit5::next_width(double squared_error) {
    const float log_error = 0.5f * std::log2(static_cast<float>(std::max(squared_error, 1e-20)));
    const float factor = 0.9f * std::exp2(0.04f * previous_log_error_ - 0.17f * log_error);
    previous_log_error_ = std::max(log_error, kLeastLogError);
    return std::clamp(static_cast<double>(factor), 0.2, 8.0);
}

template <class Phase, class Observer>
PhaseEnd<Phase> Tsit5::advance(Phase& phase, PhaseMemory& memory, double tau, double tau_end,
                               typename Phase::State y, Observer&& observe) {
    using Finder = EventFinder<Phase::kEvents>;
    Tsit5Step<Phase> step;
    EventSamples<Phase::kEvents> samples;
    step.first = y;
    const typename Phase::State scale = phase.scale(options_.scales);
    for (std::size_t i = 0; i < scale.size(); ++i) {
        step.weight[i] =
            1.0 / (scale[i] * options_.tolerance * std::sqrt(static_cast<double>(scale.size())));
    }
    phase.rebase(tau, y);
    phase.rates(phase.field_at(tau), y, step.slope[0], samples.start);
    ++counts_.evaluations;
    if (memory.fresh) {
        // A step carried over from another phase can leap over the whole of a short one.
        width_ = first_width_;
        previous_log_error_ = kLeastLogError;
        memory.begin(samples.start);
        // Each of two modes sends the body to the other without time going on: the mode is kept for
        // the shortest step that is far above the resolution of time.
        if (memory.stalled) width_ = std::min(width_, kShortestStep);
    } else {
        // The same phase over a kink of the voltage, which excites the swing anew.
        width_ = std::min(width_, 2.0 * first_width_);
    }
    const double least = 1e-15 * std::max(1e-3, tau_end);
    bool after_rejection = false;
    while (tau < tau_end) {
        if (options_.stop && options_.stop->load(std::memory_order_relaxed)) {
            return {Status::interrupted, Event::none, tau, step.first};
        }
        double width = options_.max_step > 0.0 ? std::min(width_, options_.max_step) : width_;
        // The exponentials of a stretch fade from its start; a step that leaps over a fast one sees
        // its first value alone, and the error estimate hardly notices.
        width = std::min(width, std::max(phase.fading_time(), tau));
        // The field's expansion must hold over the step.
        const double speed = phase.speed(step.first);
        if (width * speed > 0.5 * phase.reach()) width = 0.5 * phase.reach() / speed;
        const bool to_end = tau + 1.0001 * width >= tau_end;
        if (to_end) width = tau_end - tau;
        if (!(tau + width > tau)) return {Status::step_underflow, Event::none, tau, step.first};
        step.start = tau;
        step.width = width;
        const double error = stages(phase, step, samples);
        if (!(error <= 1.0)) {
            ++counts_.rejected;
            const double factor =
                std::isfinite(error) ? std::max(0.2, 0.9 * std::pow(error, -0.1)) : 0.1;
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
            ++counts_.evaluations;
            const typename Tsit5Step<Phase>::At at(step, s);
            return phase.event(i, step.start + s * step.width, at);
        };
        const EventHit hit = Finder::find(samples, memory.armed, memory.stalled, value);
        memory.stalled = false;
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
