#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "stickslip/body/model.hpp"
#include "stickslip/field/heading.hpp"
#include "stickslip/field/horizontal_field.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// How a stretch of voltage ends what is known of a heading.
struct HeadingEnd {
    Status status = Status::ok;                            ///< or heading_lost, turns_too_fast
    double tau = std::numeric_limits<double>::infinity();  ///< s, in the stretch
    double rate = 0.0, limit = 0.0;  ///< rad/s, of a field that turns too fast
};

/// Follows the horizontal field, and with it the robot's heading, over each stretch of voltage
/// before it is played, so that a run can end at the instant when its heading is lost.
class HeadingWatch {
public:
    explicit HeadingWatch(const Model& model);

    /// Horizontal field (T) below which spin friction may hold the robot more than two degrees off
    /// it.
    double weak_field() const { return weak_field_; }

    /// What goes on from stretch to stretch.
    struct State {
        Heading heading;  ///< as the field was last seen above the weak one, or as told
        bool was_weak = true, was_settled = false;  ///< since it was strong; ever strong and slow
        bool lost = false;                          ///< for good
        double turned = 0.0;  ///< rad, by which the heading has turned to and fro
    };
    const State& state() const { return track_.state; }
    void set_state(const State& state) {
        track_ = {};
        track_.state = state;
    }

    /// Looks over a whole stretch, with the field of one place. What `field` points to has to live
    /// as long as the stretch.
    void watch(const HorizontalField& field);
    /// From `tau` on the robot is elsewhere, where the field is this one.
    void move(double tau, const HorizontalField& field);
    /// The stretch is played up to `tau` only.
    void cut(double tau);

    /// Where in the stretch the heading ends to be known, if it does.
    const HeadingEnd& end() const { return end_; }
    /// The heading in the stretch at a time when the field is weak.
    const Heading& held(double tau) const {
        std::size_t k = track_.holds - 1;
        while (k > 0 && track_.hold[k].from > tau) --k;
        return track_.hold[k].heading;
    }
    /// As the stretch begins.
    const Heading& first() const { return track_.hold[0].heading; }

    /// Of the angle by which the heading lags behind the field, in the linear motion of yaw that
    /// the field's stiffness gives, rad: the rate of turning over the yaw's own frequency. Chosen:
    /// beside the field by this angle the robot still has all but a fiftieth of it along.
    static constexpr double kMostTurning = 0.2;

private:
    // Times at which a field becomes weak, with the heading that stays.
    struct Hold {
        double from = 0.0;
        Heading heading;
    };
    static constexpr std::size_t kMostHolds = 4;
    struct Track {
        State state;
        double tau = 0.0;  // s, of the last look
        std::size_t holds = 1;
        std::array<Hold, kMostHolds> hold = {};
    };

    void look_over(double from, double to);
    void look(double tau);
    void look_strong(double tau, const HorizontalField::Vector& field, double size);
    void fade(double tau);
    bool come_back(double tau);
    double size_at(double tau) const;
    void end(const HeadingEnd& how) {
        end_ = how;
        track_.state.lost = true;
    }

    double weak_field_;
    double yaw_;  // rad/s over the root of the horizontal field in T, the yaw's own frequency
    HorizontalField field_;
    double from_ = 0.0;    // s, from where on it is this field
    Track track_, begun_;  // now, and there
    HeadingEnd end_;
};

}  // namespace stickslip
