#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "stickslip/contact/contact.hpp"
#include "stickslip/solver/stepping.hpp"

/// The physics of a contact is written once, in the upright plane of the robot (phases.hpp,
/// contact.cpp). A frame says what is beside it: nothing, for a robot that stays in the plane y = 0
/// (here), or what is across, for one whose plane turns with the field (turning_frame.hpp). Places
/// and velocities of a state are the world's. A frame has
///   Place               a vector of the world in the surface: x, or x and y
///   Vector              the same as the robot sees it: along its heading, across, and size()
///   Load                a LoadOf, and what acts across
///   Seen                what a robot at a place feels of the field, with its heading
///   kBreaks, kFrameEvents       events that break a stick; those that all its phases have beside
///   their own dynamics()          of the upright plane; field(), field_at(tau): of the coils
///   place(x, y)         a Place; part(y, i): among the coordinates of a phase, from the i-th on;
///                       both(value): of one number for all
///   vector(along, across)    a Vector; in_plane(heading, v), in_world(heading, v): there and back
///   moved(place, heading, d)    d further along a heading
///   seen_at(field, place, z), seen_at_corner(field, place, pose)   with the centre of mass or the
///                       pivot corner there; heading_at, heading_at_corner(tau, ...): only which
///                       way; last_heading(): as the robot was last known to face
///   load(seen, tau, pose, velocity, vz, omega)   forces but those of touching corners
///   across(load)        what of them is across, N
///   events(seen)        values of kFrameEvents
///   left_to_break(friction, limit)   values of kBreaks; `limit(slip_sign)`: friction that holds, N
///   body, sample      of a state; centre(place, z): where the field's expansion is looked at;
///                       in_ground(tau, centre): the same as the coils see it
///   along_front(v)      what the summary counts of a slip; of_face(middle, face): at which place
///   with_slide(state, use)   the slip of a state, see SignedSlide
/// and for the question of what follows from a slip (contact.cpp)
///   is_slow(slip)       whether static friction may hold it; has_begun(slip): whether it has a way
///   against(friction)   the way in which a contact slips against its friction, of size one
///   begun(slip, direction)    a slip that goes on, or begins, that way
///   direction_of(slip, friction, onset)   its way; without a velocity that of the onset, or
///                       against the friction that would hold it
///   direction_to_slip(friction, onset, acceleration)   in which a corner breaks loose, where
///                       `acceleration(direction)` is that of its slip
///   mark(direction)     ContactMode::slip
/// Numbers may be packs, but not those of this last part.
namespace stickslip {

/// Puts numbers, and arrays of numbers, one after another from the N-th on. No loop and no counter,
/// for which the compiler would have them in memory.
template <std::size_t N = 0, class Array, class Part, class... Parts>
[[gnu::always_inline]] constexpr void put(Array& to, const Part& part, const Parts&... parts) {
    if constexpr (requires { std::tuple_size<Part>::value; }) {
        constexpr std::size_t kSize = std::tuple_size_v<Part>;
        [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
            ((to[N + I] = part[I]), ...);
        }
        (std::make_index_sequence<kSize>());
        if constexpr (sizeof...(parts) > 0) put<N + kSize>(to, parts...);
    } else {
        to[N] = part;
        if constexpr (sizeof...(parts) > 0) put<N + 1>(to, parts...);
    }
}
template <class Array, class... Parts>
[[gnu::always_inline]] constexpr Array gather(const Parts&... parts) {
    Array result = {};
    put(result, parts...);
    return result;
}

/// The events of a phase from its parts.
template <std::size_t... N>
constexpr auto join(const std::array<Event, N>&... events) {
    return gather<std::array<Event, (N + ...)>>(events...);
}

/// The plane y = 0. A slip is a number with a sign, and what is across is the constant zero.
template <class D>
class FixedFrame {
public:
    using Real = typename D::Real;
    static constexpr bool kTurns = false;
    static constexpr std::size_t kSurface = 1;
    using Place = std::array<Real, kSurface>;
    using Field = ExpansionOf<Real>;

    struct Vector {
        Real along = 0.0;
        static constexpr double across = 0.0;

        [[gnu::always_inline]] Real size() const { return magnitude(along); }
    };
    using Load = LoadOf<Real>;
    struct Ahead {};
    struct Seen {
        [[no_unique_address]] Ahead heading;
        Real x, z;  // m, centre of mass
        PlanarFieldOf<Real> field;
    };

    static constexpr std::array kBreaks = {Event::breaks_backward, Event::breaks_forward};
    static constexpr std::array<Event, 0> kFrameEvents = {};

    FixedFrame(D& dynamics) : dynamics_(&dynamics) {}

    D& dynamics() const { return *dynamics_; }
    auto& field() const { return dynamics_->field(); }
    [[gnu::always_inline]] Field field_at(Real tau) const { return dynamics_->field_at(tau); }

    [[gnu::always_inline]] static Place part(const auto& y, std::size_t i) { return {y[i]}; }
    static Place place(double x, double) { return {x}; }
    static Place both(Real value) { return {value}; }
    [[gnu::always_inline]] static Real size(const Place& v) { return magnitude(v[0]); }
    static Vector vector(const Slip& v) { return {v.along}; }
    static Slip slip(const Vector& v) { return {v.along, 0.0}; }
    [[gnu::always_inline]] static Vector vector(Real along, const auto&) { return {along}; }

    static Ahead last_heading() { return {}; }
    static Ahead heading_at(double, const Place&, double) { return {}; }
    static Ahead heading_at_corner(double, const Place&, const Pose&) { return {}; }
    [[gnu::always_inline]] static Place moved(const Place& place, Ahead, Real distance) {
        return {place[0] + distance};
    }
    [[gnu::always_inline]] static Vector in_plane(Ahead, const Place& v) { return {v[0]}; }
    [[gnu::always_inline]] static Place in_world(Ahead, const Vector& v) { return {v.along}; }

    [[gnu::always_inline]] static Seen seen_at(const Field& field, const Place& place, Real z) {
        return {{}, place[0], z, field(place[0], z)};
    }
    [[gnu::always_inline]] static Seen seen_at_corner(const Field& field, const Place& corner,
                                                      const PoseOf<Real>& pose) {
        // The corner's own distance from the middle of the field does not wait for the pose.
        const Real back = pose.place();
        return {{},
                corner[0] - back,
                pose.height,
                field.beside((corner[0] - field.centre[0]) - back, pose.height - field.centre[1])};
    }
    [[gnu::always_inline]] Load load(const Seen& seen, Real tau, const PoseOf<Real>& pose,
                                     const Vector& velocity, Real vz, Real omega) const {
        return dynamics_->load(seen.field, tau, seen.x, seen.z, pose, velocity.along, vz, omega);
    }
    static constexpr double across(const Load&) { return 0.0; }
    [[gnu::always_inline]] static std::array<Real, 0> events(const Seen&) { return {}; }
    [[gnu::always_inline]] static std::array<Real, 2> left_to_break(const Vector& friction,
                                                                    auto&& limit) {
        return {limit(-1.0) - friction.along, limit(1.0) + friction.along};
    }

    BodyState body(Ahead, const Place& place, double z, double angle, const Place& velocity,
                   double vz, double omega) const {
        return {place[0], z, angle, velocity[0], vz, omega, dynamics_->quadrant()};
    }
    static Sample sample(const BodyState& body, double normal, const Vector& friction,
                         const Place& contact, const Vector& slip) {
        return {body, {normal, friction.along}, contact[0], slip.along};
    }
    [[gnu::always_inline]] static PlaceOf<Real, 2> centre(const Place& place, Real z) {
        return {place[0], z};
    }
    auto in_ground(double tau, const auto& centre) const {
        return dynamics_->in_ground(tau, centre);
    }
    [[gnu::always_inline]] static Real along_front(const Place& v) { return v[0]; }
    /// Point at which a face's slip is watched: its end.
    static Place of_face(const Place& middle, const Face& face) {
        return {middle[0] + face.place()};
    }
    void with_slide(const HybridState& state, auto&& use) const;

    static bool is_slow(const Vector& slip) { return slip.along == 0.0; }
    static bool has_begun(const Vector& slip) { return slip.along != 0.0; }
    static Vector against(const Vector& friction) { return {friction.along > 0.0 ? -1.0 : 1.0}; }
    /// Leaves the velocity as it is: the mode tells that it slips, and which way.
    static Vector begun(const Vector& slip, const Vector&) { return slip; }
    static Vector direction_of(const Vector& slip, const Vector& friction, int onset) {
        if (slip.along != 0.0) return {slip.along > 0.0 ? 1.0 : -1.0};
        return onset != 0 ? Vector{static_cast<double>(onset)} : against(friction);
    }
    static Vector direction_to_slip(const Vector& friction, int onset, auto&&) {
        return direction_of({}, friction, onset);
    }
    static int mark(const Vector& direction) { return direction.along > 0.0 ? 1 : -1; }

private:
    D* dynamics_;
};

/// The slip of a phase in the fixed frame, to one side until it stops. A slide has
///   kEnds, kFrameEvents         the event that ends it, and others
///   begin()             the slip (m/s) as the phase begins
///   direction(heading, slip)  that against which friction acts, of size one
///   left(slip)          value of kEnds; events(slip): of kFrameEvents
///   longest_step(slip, acceleration)   s, of one that a step must not leap over
template <class D>
class SignedSlide {
public:
    using Frame = FixedFrame<D>;
    using Real = typename D::Real;
    using Place = typename Frame::Place;
    static constexpr Event kEnds = Event::slip_stops;
    static constexpr std::array<Event, 0> kFrameEvents = {};

    /// slip_sign: +1 or -1; velocity: m/s.
    SignedSlide(Real slip_sign, Real velocity) : slip_sign_(slip_sign), begin_{velocity} {}

    const Place& begin() const { return begin_; }
    [[gnu::always_inline]] typename Frame::Vector direction(auto, const Place&) const {
        return {slip_sign_};
    }
    [[gnu::always_inline]] Real left(const Place& slip) const { return slip_sign_ * slip[0]; }
    [[gnu::always_inline]] static std::array<Real, 0> events(const Place&) { return {}; }

private:
    Real slip_sign_;
    Place begin_;
};

template <class D>
void FixedFrame<D>::with_slide(const HybridState& state, auto&& use) const {
    // An event has put the slip to zero; a face moves on with what the body had left of it.
    const bool lies = state.mode.touch == Touch::face;
    use(SignedSlide<D>(state.mode.slip, lies ? state.body.vx : state.slip_velocity));
}

}  // namespace stickslip
