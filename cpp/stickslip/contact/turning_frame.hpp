#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "stickslip/contact/frame.hpp"
#include "stickslip/contact/plane_dynamics.hpp"
#include "stickslip/solver/event_location.hpp"

namespace stickslip {

/// The upright plane of a robot that turns with the field; see frame.hpp. A heading that turns
/// moves nothing by itself: a stuck edge keeps its middle, a body in flight its centre of mass, a
/// face its middle.
class TurningFrame {
public:
    using Real = double;
    static constexpr bool kTurns = true;
    static constexpr std::size_t kSurface = 2;
    using Place = std::array<double, kSurface>;
    using Field = SpatialExpansion;
    using Vector = Slip;
    using Load = PlaneLoad;
    using Seen = HeadedField;

    static constexpr std::array kBreaks = {Event::breaks_loose};
    static constexpr std::array kFrameEvents = {Event::heading};

    /// front: rad, what the slip of the summary is counted along.
    explicit TurningFrame(PlaneDynamics& plane, double front = 0.0)
        : plane_(&plane), front_(Heading::of_angle(front)) {}

    Dynamics& dynamics() const { return plane_->upright(); }
    SpatialField& field() const { return plane_->field(); }
    Field field_at(double tau) const { return plane_->field().at(tau); }

    static Place part(const auto& y, std::size_t i) { return {y[i], y[i + 1]}; }
    static Place place(double x, double y) { return {x, y}; }
    static Place both(double value) { return {value, value}; }
    static double size(const Place& v) { return Slip{v[0], v[1]}.size(); }
    static Vector vector(const Slip& v) { return v; }
    static Slip slip(const Vector& v) { return v; }
    static Vector vector(double along, double across) { return {along, across}; }

    /// Heading in which the robot was last seen.
    const Heading& last_heading() const { return plane_->watch().state().heading; }
    Heading heading_at(double tau, const Place& place, double z) const {
        return seen_at(field_at(tau), place, z).heading;
    }
    Heading heading_at_corner(double tau, const Place& corner, const Pose& pose) const {
        return seen_at_corner(field_at(tau), corner, pose).heading;
    }
    static Place moved(const Place& place, const Heading& h, double distance) {
        return {place[0] + distance * h.cosine, place[1] + distance * h.sine};
    }
    static Vector in_plane(const Heading& h, const Place& v) { return h.seen(v[0], v[1]); }
    static Place in_world(const Heading& h, const Vector& v) { return {h.x(v), h.y(v)}; }

    Seen seen_at(const Field& field, const Place& place, double z) const {
        return plane_->headed(field, place[0], place[1], z);
    }
    Seen seen_at_corner(const Field& field, const Place& corner, const Pose& pose) const {
        return plane_->headed_at_corner(field, corner[0], corner[1], pose);
    }
    Load load(const Seen& seen, double tau, const Pose& pose, const Vector& velocity, double vz,
              double omega) const {
        return plane_->load(seen, tau, pose, velocity, vz, omega);
    }
    static double across(const Load& load) { return load.across; }
    std::array<double, 1> events(const Seen& seen) const {
        return {plane_->watch().left(seen.horizontal)};
    }
    static std::array<double, 1> left_to_break(const Vector& friction, auto&& limit) {
        return {limit(against(friction).along) - friction.size()};
    }

    BodyState body(const Heading& h, const Place& place, double z, double angle,
                   const Place& velocity, double vz, double omega) const {
        return {place[0], z,           angle,    velocity[0], vz, omega, dynamics().quadrant(),
                place[1], velocity[1], h.angle()};
    }
    static Sample sample(const BodyState& body, double normal, const Vector& friction,
                         const Place& contact, const Vector& slip) {
        return {body,       {normal, friction.along}, contact[0], slip.along,
                contact[1], friction.across,          slip.across};
    }
    static stickslip::Place centre(const Place& place, double z) { return {place[0], place[1], z}; }
    static stickslip::Place in_ground(double, const stickslip::Place& centre) { return centre; }
    /// Component of a world vector along the front, the heading as the phase began.
    double along_front(const Place& v) const { return front_.cosine * v[0] + front_.sine * v[1]; }
    /// Point at which a face's slip is watched: its middle, as its end moves when the heading
    /// turns.
    static Place of_face(const Place& middle, const Face&) { return middle; }
    void with_slide(const HybridState& state, auto&& use) const;

    /// Whether a slip is within the capture speed, with rounding. A slow slip sticks if static
    /// friction can hold it. Otherwise its friction keeps the direction that it had when the phase
    /// began, until the slip stops or is twice as fast. (A friction that follows a slow slip is
    /// stiff: its direction changes within v / (mu g), less than 1 us.)
    static bool is_slow(const Vector& slip) { return slip.size() <= kCaptureSpeed * (1.0 + 1e-9); }
    static bool has_begun(const Vector& slip) { return slip.size() > kLeastSlip; }
    static Vector against(const Vector& friction) {
        const double size = friction.size();
        if (!(size > 0.0)) return {1.0, 0.0};
        return {-friction.along / size, -friction.across / size};
    }
    /// The velocity says which way, also of a contact that has just broken loose.
    static Vector begun(const Vector& slip, const Vector& direction) {
        if (has_begun(slip)) return slip;
        return {kLeastSlip * direction.along, kLeastSlip * direction.across};
    }
    static Vector direction_of(const Vector& slip, const Vector& friction, int) {
        const double speed = slip.size();
        return speed > 0.0 ? Vector{slip.along / speed, slip.across / speed} : against(friction);
    }
    static Vector direction_to_slip(const Vector& friction, int onset, auto&& acceleration);
    static int mark(const Vector&) { return 1; }

private:
    static constexpr double kLeastSlip = 1e-9;  // m/s, of a contact that has just broken loose

    PlaneDynamics* plane_;
    Heading front_;
};

/// The way of the slip is that of the acceleration that it gets under friction against it. The
/// rod's turning makes the contact lighter along than across, so that the way is not quite that of
/// the force: it is looked for, from the force's on. Where friction one way is next to nothing, the
/// ways that a small force can take are too few to be found, and are next to the force's.
Slip TurningFrame::direction_to_slip(const Vector& friction, int, auto&& acceleration) {
    const auto direction_at = [](double angle) { return Slip{std::cos(angle), std::sin(angle)}; };
    const auto turned = [&](double angle) {
        const Slip direction = direction_at(angle), a = acceleration(direction);
        return Heading{direction.along, direction.across}.seen(a.along, a.across);
    };
    const auto turning = [&](double angle) { return turned(angle).across; };
    const double force = std::atan2(-friction.across, -friction.along);
    double slip_angle = force;
    // Slip goes to a way in which the acceleration does not turn it and to which others turn.
    search_around(force, [&](double low, double high) {
        if (!(turning(low) >= 0.0 && turning(high) <= 0.0)) return false;
        const double found = find_root(low, high, turning);
        // A way that speeds up. Where friction only just gives way, one that next to does not.
        constexpr double kNothing = 1e-4;  // of what friction does to a slip; measured: 3e-6
        const double back = turned(found + std::numbers::pi).along;
        if (turned(found).along < -kNothing * std::abs(back)) return false;
        slip_angle = found;
        return true;
    });
    return direction_at(slip_angle);
}

/// The slip of a phase along a vector, see frame.hpp. kSlow: it began slow (`is_slow`), and
/// friction keeps its way.
template <bool kSlow>
class VectorSlide {
public:
    using Frame = TurningFrame;
    using Place = Frame::Place;
    static constexpr Event kEnds = kSlow ? Event::slip_stops : Event::slip_slows;
    static constexpr std::array<Event, kSlow ? 1 : 0> kFrameEvents = [] {
        std::array<Event, kSlow ? 1 : 0> result = {};
        if constexpr (kSlow) result[0] = Event::slip_quickens;
        return result;
    }();

    explicit VectorSlide(const Place& begin) : begin_(begin), direction_(direction_of(begin)) {}

    const Place& begin() const { return begin_; }
    Slip direction(const Heading& h, const Place& slip) const {
        return Frame::in_plane(h, kSlow ? direction_ : direction_of(slip));
    }
    double left(const Place& slip) const {
        if constexpr (kSlow) return direction_[0] * slip[0] + direction_[1] * slip[1];
        return size(slip) - kCaptureSpeed;
    }
    /// Event functions: the speed (m/s) that a slow slip still lacks to be a fast one.
    static std::array<double, kFrameEvents.size()> events(const Place& slip) {
        std::array<double, kFrameEvents.size()> result = {};
        if constexpr (kSlow) result[0] = 2.0 * kCaptureSpeed - size(slip);
        return result;
    }
    /// Where a fast slip ends its friction has no direction, so that a step which leaps over the
    /// end is rejected again and again.
    static double longest_step(const Place& slip, const Place& acceleration) {
        constexpr double kMost = 0.7;  // of the time to the end; measured
        const double change = slip[0] * acceleration[0] + slip[1] * acceleration[1];
        const double speed = size(slip);
        return !kSlow && change < 0.0 ? kMost * speed * speed / -change
                                      : std::numeric_limits<double>::infinity();
    }

private:
    static double size(const Place& v) { return Frame::size(v); }
    static Place direction_of(const Place& slip) {
        const double speed = size(slip);
        return speed > 0.0 ? Place{slip[0] / speed, slip[1] / speed} : Place{1.0, 0.0};
    }

    Place begin_, direction_;
};

void TurningFrame::with_slide(const HybridState& state, auto&& use) const {
    const Place slip = {state.slip_velocity, state.slip_y};
    if (is_slow({slip[0], slip[1]})) {
        use(VectorSlide<true>(slip));
    } else {
        use(VectorSlide<false>(slip));
    }
}

}  // namespace stickslip
