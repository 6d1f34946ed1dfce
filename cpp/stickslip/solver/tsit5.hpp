#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "stickslip/numbers/elementary.hpp"
#include "stickslip/solver/event_location.hpp"
#include "stickslip/solver/loop.hpp"
#include "stickslip/solver/motion_trace.hpp"

namespace stickslip {

template <std::size_t N>
using Stage = std::integral_constant<std::size_t, N>;

/// One step of the Runge-Kutta pair 5(4) of Ch. Tsitouras, Computers & Mathematics with
/// Applications 62 (2011) 770-775, with its free interpolant of fourth order.
template <class Phase>
struct Tsit5Step {
    using Real = typename Phase::Real;
    using State = typename Phase::State;
    static constexpr std::size_t kDim = Phase::kDim;

    State weight;  ///< of each coordinate's error in the norm
    State first;
    std::array<State, 7> slope;
    State last;
    Real start;  ///< s
    Real width;  ///< s

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(weight, first, slope, last, start, width);
    }

    /// Coordinates at a fraction of the step, each computed where it is asked for: most event
    /// functions need one or two.
    class At {
    public:
        At(const Tsit5Step& step, double s) : step_(step), b_(weights(s)) {}
        double operator[](std::size_t i) const {
            const auto& k = step_.slope;
            return step_.first[i] +
                   step_.width *
                       (b_[0] * k[0][i] + b_[1] * k[1][i] + b_[2] * k[2][i] + b_[3] * k[3][i] +
                        b_[4] * k[4][i] + b_[5] * k[5][i] + b_[6] * k[6][i]);
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

/// Fills the step's stages and end; the squared error norm (accepted if at most one).
template <class Phase, class Samples>
[[gnu::always_inline]] inline typename Phase::Real tsit5_stages(const Phase& phase,
                                                                Tsit5Step<Phase>& step,
                                                                Samples& samples) {
    using Table = Tsit5Table;
    using Real = typename Phase::Real;
    using State = typename Phase::State;
    const Real h = step.width;
    // The field at the stages' times does not wait for the stages: it is computed first, and the
    // processor overlaps it with the chain of dependent stages.
    const auto field_at = [&](std::size_t stage) __attribute__((always_inline)) {
        return phase.field_at(fma(Real(Table::c[stage]), h, step.start));
    };
    const std::array<decltype(phase.field_at(h)), 5> field = {field_at(1), field_at(2), field_at(3),
                                                              field_at(4), field_at(5)};

    const auto stage_end = [&](auto row) __attribute__((always_inline)) {
        constexpr std::size_t kStages = decltype(row)::value;
        State y = step.first;
        for (std::size_t j = 0; j < kStages; ++j) {
            const Real weight = h * Table::a[kStages - 1][j];
            for (std::size_t i = 0; i < y.size(); ++i) y[i] = fma(weight, step.slope[j][i], y[i]);
        }
        return y;
    };
    const auto lower = [&](const typename Phase::Values& g) __attribute__((always_inline)) {
        for (std::size_t i = 0; i < g.size(); ++i) {
            samples.lowest[i] = lesser(samples.lowest[i], g[i]);
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

    Real sum = 0.0;
    for (std::size_t i = 0; i < step.last.size(); ++i) {
        Real error = Table::error[0] * step.slope[0][i];
        for (std::size_t j = 1; j < 7; ++j) {
            error = fma(Real(Table::error[j]), step.slope[j][i], error);
        }
        error *= h * step.weight[i];
        sum = fma(error, error, sum);
    }
    return sum;
}

/// Width of the steps: the controller PI of Hairer and Wanner, with exponents 0.17 and 0.04 for the
/// fifth order. The next step waits for it, and a part in a thousand is of no importance.
template <class Real>
struct WidthControl {
    Real proposal;   ///< s, width of the next step
    Real log_error;  ///< base 2, of the last accepted step
    Real rejected;   ///< 1 after a step that was not accepted, else 0

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(proposal, log_error, rejected);
    }

    /// Lower limit of the log2 of the error: one below 1e-4 of the tolerance is taken as that.
    static constexpr double kLeastLogError = -13.3;

    /// After an accepted step. `cut`: it was shortened to the end of a segment, and its length says
    /// nothing of the next.
    [[gnu::always_inline]] void accept(Real width, Real squared_error, MaskOf<Real> cut) {
        const Real now = 0.5 * rough_log2(greater(squared_error, Real(1e-20)));
        Real factor = 0.9 * rough_exp2(fnma(Real(0.17), now, 0.04 * log_error));
        factor = lesser(greater(factor, Real(0.2)), Real(8.0));
        factor = select(rejected > 0.0, lesser(factor, Real(1.0)), factor);
        const Real next = width * factor;
        proposal = select(cut, greater(proposal, next), next);
        log_error = greater(now, Real(kLeastLogError));
        rejected = 0.0;
    }
    void reject(double width, double squared_error) {
        const double factor =
            std::isfinite(squared_error)
                ? std::max(0.2, 0.9 * rough_exp2(-0.1 * rough_log2(squared_error)))
                : 0.1;
        proposal = width * factor;
        rejected = 1.0;
    }
};

/// Where the integration of a phase stands. All members are numbers, so that a pack of phases has
/// the same members as packs (run/step_kernel.cpp).
template <class Phase>
struct Tsit5Progress {
    using Real = typename Phase::Real;

    Real tau_end;            ///< s
    Real most_steps;         ///< that may be accepted
    Real max_step;           ///< s, infinite for no limit
    Real min_time_constant;  ///< s
    Real half_reach;         ///< m
    // State carried from step to step.
    Real tau;       ///< s
    Real look;      ///< s, from when on a step has to be looked at
    Real accepted;  ///< steps
    WidthControl<Real> control;
    MotionTrace<Real> trace;
    Tsit5Step<Phase> step;  ///< the last attempt, `first` and the first slope of the next one
    EventSamples<Phase::kEvents, Real> samples;  ///< of the last attempt, `start` of the next one
    Real error;                                  ///< of the last attempt, squared

    [[gnu::always_inline]] constexpr auto members() {
        return std::tie(tau_end, most_steps, max_step, min_time_constant, half_reach, tau, look,
                        accepted, control, trace, step, samples, error);
    }

    /// Chooses the next attempt's width; true where it goes to the end of the segment.
    [[gnu::always_inline]] MaskOf<Real> begin_step(const Phase& phase) {
        Real width = lesser(control.proposal, max_step);
        // The exponentials of a segment fade from its start; a step that leaps over a fast one sees
        // its first value alone, and the error estimate hardly notices.
        width = lesser(width, greater(min_time_constant, tau));
        // The field's expansion must hold over the step.
        const Real speed = phase.speed(step.first);
        const auto far = width * speed > half_reach;
        if (any(far)) width = select(far, half_reach / speed, width);
        if constexpr (Phase::kTurns && Phase::kSlips) {
            width = std::min(width, phase.longest_step(step.first, step.slope[0]));
        }
        const auto to_end = tau + 1.0001 * width >= tau_end;
        step.start = tau;
        step.width = select(to_end, tau_end - tau, width);
        return to_end;
    }
    /// Makes it, with the same answer.
    [[gnu::always_inline]] MaskOf<Real> attempt(const Phase& phase) {
        const auto to_end = begin_step(phase);
        error = tsit5_stages(phase, step, samples);
        return to_end;
    }
    /// Moves on to the end of the step where it is `done`; `cut`: it goes to the end of the
    /// segment.
    [[gnu::always_inline]] void commit(const Phase& phase, MaskOf<Real> done, MaskOf<Real> cut) {
        if (kIsOne<Real> && !any(done)) return;
        WidthControl<Real> next_control = control;
        next_control.accept(step.width, error, cut);
        blend<Real>(done, control, next_control);
        MotionTrace<Real> longer = trace;
        longer.step(phase, step.width, step.first, step.last);
        blend<Real>(done, trace, longer);
        accepted = select(done, accepted + 1.0, accepted);
        tau = select(done, select(cut, tau_end, tau + step.width), tau);
        blend<Real>(done, step.first, step.last);
        blend<Real>(done, step.slope[0], step.slope[6]);
        blend<Real>(done, samples.start, samples.end);
    }

    // For one run, not a pack.

    bool is_accepted() const { return error <= 1.0; }
    Status reject(StepCounts& counts) {
        ++counts.rejected;
        counts.evaluations += 6;
        control.reject(step.width, error);
        if (control.proposal >= 1e-15 * std::max(1e-3, tau_end)) return Status::ok;
        return std::isfinite(error) ? Status::step_underflow : Status::not_finite;
    }
    double event(const Phase& phase, std::size_t i, double s) const {
        const typename Tsit5Step<Phase>::At at(step, s);
        return phase.event(i, step.start + s * step.width, at);
    }
    void leave(const Phase&, const typename Phase::State&, StepCounts& counts) const {
        const auto steps = static_cast<std::int64_t>(accepted);
        counts.accepted += steps;
        counts.evaluations += 6 * steps;
    }
};

class Tsit5Method {
public:
    template <class Phase>
    using Progress = Tsit5Progress<Phase>;

    explicit Tsit5Method(const StepperOptions& options)
        : first_width_(0.4 * std::pow(options.tolerance / 1e-6, 0.2) / options.swing_rate) {}

    template <class Phase>
    void start(const StepperOptions& options, const Phase& phase, const PhaseMemory& memory,
               const typename Phase::State& rates, Tsit5Progress<Phase>& p) const {
        constexpr double kNone = std::numeric_limits<double>::infinity();
        const typename Phase::State scale = phase.scale(options.scales);
        const double norm = options.tolerance * std::sqrt(static_cast<double>(scale.size()));
        for (std::size_t i = 0; i < scale.size(); ++i) p.step.weight[i] = 1.0 / (scale[i] * norm);
        p.step.slope[0] = rates;
        // A phase begins with the first width: a longer step could leap over the whole of a short
        // one. One that goes on in a new segment of voltage is known to last. Two modes may send
        // the body to each other without time going on: then the step is the shortest that is far
        // above the resolution of time.
        const double usual = memory.born ? first_width_ : 2.0 * first_width_;
        const double width = memory.stalled ? std::min(usual, kShortestStep) : usual;
        p.control = {width, WidthControl<double>::kLeastLogError, 0.0};
        p.look = kNone;
        p.max_step = options.max_step > 0.0 ? options.max_step : kNone;
        if constexpr (Phase::kRests) {
            p.max_step = std::min(p.max_step, options.longest_rest);
        }
        p.min_time_constant = phase.min_time_constant();
        p.half_reach = 0.5 * phase.reach();
        // Without coils there is no field whose expansion has to hold.
        if (options.is_shaken && !phase.field().has_coils()) p.half_reach = kNone;
        if (options.surface_speed > 0.0 && phase.field().has_coils()) {
            p.max_step = std::min(p.max_step, 0.25 * phase.reach() / options.surface_speed);
        }
    }

private:
    double first_width_;  // s, of a phase and of a segment: a part of a free swing that the
                          // tolerance allows
};
using Tsit5 = StepLoop<Tsit5Method>;

}  // namespace stickslip
