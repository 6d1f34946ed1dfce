#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stickslip/contact/impact.hpp"
#include "stickslip/contact/plane_dynamics.hpp"
#include "stickslip/numbers/rows.hpp"

namespace stickslip {

/// Changes of the contact that a run counts and that a recording "events" holds.
enum class EventKind {
    slip_start,
    stick,
    reversal,
    lift_off,
    touch_down,
    landing,
    tip,
    roll_over,
    rebound,
    painleve,
};

inline constexpr auto kEvents = std::to_array<Word<EventKind>>({
    {EventKind::slip_start, "slip_start", "a sticking contact slips"},
    {EventKind::stick, "stick", "a slipping contact sticks"},
    {EventKind::reversal, "reversal", "a slip stops and goes on the other way"},
    {EventKind::lift_off, "lift_off", "the last contact is lost"},
    {EventKind::touch_down, "touch_down", "a corner meets the surface out of flight"},
    {EventKind::landing, "landing", "a body on one corner comes to lie on a face"},
    {EventKind::tip, "tip", "a body on a face goes to one corner"},
    {EventKind::roll_over, "roll_over",
     "a body on one corner goes to the next at once, as the face between lands"},
    {EventKind::rebound, "rebound",
     "the second corner of a body on one corner meets the surface and bounces off"},
    {EventKind::painleve, "painleve", "a slip had no solution and was stopped by an impulse"},
});
static_assert(in_order(kEvents));
inline constexpr std::size_t kEventKinds = kEvents.size();

/// Transitions of the state at events: an impact if there is one, then the mode that the forces
/// allow.
class ContactTransitions {
public:
    ContactTransitions(Dynamics& dynamics, HybridState& state)
        : dynamics_(dynamics), state_(state) {}
    /// The robot moves in the whole plane from now on; `plane` has to outlive this.
    void set_plane(PlaneDynamics& plane) { plane_ = &plane; }

    /// Begins with the present state, whose mode the forces may not allow. `touches_down`: with
    /// the impact of a corner on the surface that approaches it.
    void begin(bool touches_down);

    /// Takes over the counts of a run that goes on.
    void set_counts(const std::array<std::int64_t, kEventKinds>& counts) { counts_ = counts; }
    /// Handles an event at `tau` seconds into the segment.
    void handle(Event event, double tau);

    /// Changes of the contact by the last event, in order.
    const std::vector<EventKind>& changes() const { return changes_; }
    /// Number of events of each kind in the whole run.
    const std::array<std::int64_t, kEventKinds>& counts() const { return counts_; }

private:
    template <class How>
    void change(double tau, How&& how);
    // Velocities along the heading and across while an event is handled; the world's after it.
    void enter_heading(double tau);
    void leave_heading();
    void react(Event event, double tau);
    void land(int quadrant, Arrival arrival, double tau);
    void touch_down(int corner_offset, double tau);
    // onset: which way an event has broken the contact loose, 0: none has.
    void settle(Touch touch, const Slip& slip, int onset, double tau);
    Slip slip() const { return {state_.slip_velocity, state_.slip_y}; }
    void move_contact(double distance) {
        state_.contact_x += distance * heading_.cosine;
        state_.contact_y += distance * heading_.sine;
    }
    void pivot_on_rear_end();
    void place_by_contact();
    // The velocity of the body along the line of the inner mass, m/s, and what its jump does to
    // that mass, which nothing strikes.
    double along_inner() const;
    void follow_with_inner();
    // The inner mass meets a stop, or lets go of it.
    void meet_stop(int stop, double tau);
    void strike_stop(int stop, Touch touch, bool slips, double tau);
    void count(EventKind kind);
    void count_change(const ContactMode& before);

    const Model& model() const { return dynamics_.model(); }
    Pose pose() const { return dynamics_.pose(state_.body.angle); }

    Dynamics& dynamics_;
    HybridState& state_;
    PlaneDynamics* plane_ = nullptr;
    Heading heading_;
    double along_inner_ = 0.0;  // m/s, as the inner mass last knew
    std::vector<EventKind> changes_;
    std::array<std::int64_t, kEventKinds> counts_ = {};
};

}  // namespace stickslip
