#include "stickslip/run/window_observer.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/numbers/roots.hpp"

namespace stickslip {
namespace {

// Speed that a robot hardly exceeds while the field turns, over the velocity scale, at which it
// swings freely by a radian. Twice as much changes no extreme of tests/test_extremes.py by 1e-6.
constexpr double kUsualSpeed = 0.1;

}  // namespace

void WindowObserver::watch_window(double time) {
    const double slack = boundary_slack(player_.duration());
    if (!has_opened_ && time >= window_.start - slack) {
        observer_.open(time, window_.end, player_.in_ground(player_.body(), time));
        has_opened_ = true;
        opened_ = player_.body();
        turned_before_ = player_.turned();
    }
    if (observer_.is_open()) {
        observer_.pass(time, player_.in_ground(player_.body(), time));
    }
    if (observer_.is_open() && time >= window_.end - slack) close_window(time);
}

void WindowObserver::close_window(double time) {
    observer_.close(time, player_.in_ground(player_.body(), time), player_.sign(), of_window_);
    const double span = time - observer_.start();
    if (sees_drive_) drive_.close(span, of_window_);
    if (!(span > 0.0)) return;
    const double radius = player_.model().shape.radius();
    of_window_.turning_speed = (player_.turned() - turned_before_) * radius / span;
    if (!asks_pull_) return;
    const BodyState& closed = player_.body();
    const double x = closed.x - opened_.x, y = closed.y - opened_.y, way = std::hypot(x, y);
    // By the balance of momentum, which has the impacts too.
    const Model& model = player_.model();
    const double normal = pulled_.pressing + model.mass * (closed.vz - opened_.vz);
    // In flight throughout the two cancel but for the error of the steps.
    constexpr double kNothing = 1e-6;
    const double held = normal > kNothing * std::abs(pulled_.pressing)
                            ? model.friction.static_coefficient * normal
                            : 0.0;
    of_window_.pull_share =
        way > 0.0 && held > 0.0 ? (pulled_.x * x + pulled_.y * y) / (way * held) : 0.0;
}

// The field is looked at within the steps, at the robot's place: in the course of a segment it
// moves through a gradient.
void WindowObserver::plan_looks() {
    if (!sees_drive_) return;
    looks_.clear();
    const bool in_window = observer_.is_open();
    // The field goes on from the last segment, but for the first of the run or of the window.
    if (!drive_.has_seen_field(in_window)) {
        drive_.see_field(squared_field(0.0, player_.body()), in_window);
    }
    if (player_.has_field_shape()) {
        looks_.push_back({{0.0, player_.segment().duration}, true, in_window});
    } else {
        const double speed = kUsualSpeed * player_.options().scales.velocity;
        for_each_field_turn(
            player_.field_course(), speed, [&](const FieldTurn& turn, double least, double most) {
                const bool for_most = drive_.would_be_most(most * most);
                const bool for_least = in_window && drive_.would_be_least(least * least);
                if (for_most || for_least) looks_.push_back({turn, for_most, for_least});
            });
        std::reverse(looks_.begin(), looks_.end());
    }
    next_look_ = looks_.empty() ? kNoLook : looks_.back().turn.from;
}

// Gauss's quadrature with three points, of the order of the steps.
void WindowObserver::weigh(double from, double to, BodyAt body_at) {
    static const double kAside = std::sqrt(0.15);
    for (const double at : {0.5 - kAside, 0.5, 0.5 + kAside}) {
        const double tau = from + at * (to - from);
        const double weight = (at == 0.5 ? 8.0 : 5.0) / 18.0 * (to - from);
        const Pull pull = player_.pull(tau, body_at(tau));
        pulled_.x += weight * pull.x;
        pulled_.y += weight * pull.y;
        pulled_.pressing += weight * pull.pressing;
    }
}

void WindowObserver::look_at_field(double from, double to, BodyAt body_at) {
    const bool in_window = observer_.is_open();
    const auto square = [&](double tau) {
        const double value = squared_field(tau, body_at(tau));
        drive_.see_field(value, in_window);
        return value;
    };
    const auto worth = [this](double value) { return drive_.would_be_least(value); };
    const auto negative = [&](double tau) { return -square(tau); };
    const auto worth_negative = [this](double value) { return drive_.would_be_most(-value); };
    while (next_look_ <= to) {
        const FieldLook& look = looks_.back();
        const FieldTurn& turn = look.turn;
        const double begin = std::max(turn.from, from), end = std::min(turn.to, to);
        const int parts = end - begin > 0.5 * (to - from) ? 2 : 1;
        if (look.for_least) least_value(begin, end, parts, square, worth);
        if (look.for_most) least_value(begin, end, parts, negative, worth_negative);
        if (turn.to > to) break;  // it goes on after these
        end_look();
    }
}

void WindowObserver::end_look() {
    looks_.pop_back();
    next_look_ = looks_.empty() ? kNoLook : looks_.back().turn.from;
}

void WindowObserver::end_segment(double duration) {
    if (!sees_drive_ || !player_.is_open() || !(duration > 0.0)) return;
    if (duration < player_.segment().duration) {  // the run has ended within it
        VoltageSegment voltages = player_.voltages();
        voltages.last = voltage_at(voltages, voltages.start + duration);
        voltages.end = voltages.start + duration;
        CurrentSegment played = player_.segment();
        played.duration = duration;
        end_segment(voltages, played);
    } else {
        end_segment(player_.voltages(), player_.segment());
    }
}

void WindowObserver::end_segment(const VoltageSegment& voltages, const CurrentSegment& played) {
    const bool in_window = observer_.is_open();
    drive_.end_segment(voltages, played, in_window);
    drive_.see_field(squared_field(played.duration, player_.body()), in_window);
    drive_.pull(player_.field_of_coils(), played,
                [this](double tau) { return player_.dynamics().field().factor(tau); });
}

void WindowObserver::write(Summary& summary) const {
    const double time = summary.simulated_time;
    summary = of_window_;
    summary.simulated_time = time;
    summary.events = player_.counts();
    if (!sees_drive_) return;
    drive_.write(summary);
    if (!player_.has_begun()) return;
    const Model& model = player_.model();
    const double held = model.friction.static_coefficient * model.pressing();
    const double moment = std::abs(model.moment * (1.0 + model.gradient_excess));
    summary.pull_ratio = held > 0.0 ? moment * drive_.slope_max() / held : 0.0;
    const std::array<double, 3> before = drive_.steady_field(start_fields_),
                                now = drive_.steady_field(player_.field_of_coils());
    const double size = std::hypot(before[0], before[1], before[2]);
    const double change = std::hypot(now[0] - before[0], now[1] - before[1], now[2] - before[2]);
    summary.field_change = size > 0.0 ? change / size : 0.0;
}

}  // namespace stickslip
