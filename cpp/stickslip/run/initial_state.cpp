#include "stickslip/run/initial_state.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/run/recording.hpp"
#include "stickslip/scenario/parameters.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {
namespace {

// Tolerance of lengths relative to the body's radius, and of velocities to those of its corners:
// far above the rounding of a state that a run has left, far below the accuracy of any state.
constexpr double kSlack = 1e-9;
constexpr double kLeastVelocity = 1e-15;  // m/s

/// Places a state on, or above, the surface.
class Starter {
public:
    Starter(const Scenario& scenario, const Model& model)
        : given_(scenario.initial),
          word_(find_choice("initial.contact")->get(scenario)),
          model_(model),
          shape_(model.shape),
          sign_(model.frame.sign),
          whole_plane_(model.frame.whole_plane),
          heading_(whole_plane_ ? start_heading(scenario) : Heading{}) {}

    Start start() {
        place();
        place_inner();
        start_.contact_age = given_.contact_age;
        const double gap = check_height();
        BodyState& body = start_.state.body;
        if (gap <= kSlack * shape_.radius() && given_.contact != ContactWord::flight) {
            body.z = pose().height;
        }
        switch (given_.contact) {
            case ContactWord::from_motion:
                from_motion(gap);
                break;
            case ContactWord::flight:
                start_.state.mode = {Touch::none, 0};
                break;
            case ContactWord::corner_stick:
            case ContactWord::corner_slip_forward:
            case ContactWord::corner_slip_backward:
                require_touch(gap);
                on_corner(body.angle == 0.0 && stays_on_rear_corner());
                require_no_lift();
                set_slip(ContactWord::corner_slip_forward, ContactWord::corner_slip_backward);
                break;
            case ContactWord::face_stick:
            case ContactWord::face_slip_forward:
            case ContactWord::face_slip_backward:
                require_touch(gap);
                require_flat();
                start_.state.mode.touch = Touch::face;
                set_slip(ContactWord::face_slip_forward, ContactWord::face_slip_backward);
                break;
        }
        // So far the velocities were along the heading and across.
        const Slip velocity = {body.vx, body.vy};
        const Slip slip = {start_.state.slip_velocity, start_.state.slip_y};
        if (whole_plane_) {
            body.vx = heading_.x(velocity);
            body.vy = heading_.y(velocity);
            body.heading = heading_.angle();
            start_.state.slip_velocity = heading_.x(slip);
            start_.state.slip_y = heading_.y(slip);
        }
        const Pose placed = pose();
        start_.state.contact_x = body.x + placed.place() * heading_.cosine;
        start_.state.contact_y = body.y + placed.place() * heading_.sine;
        return start_;
    }

private:
    void place() {
        BodyState& body = start_.state.body;
        const double quarters = std::floor(given_.theta / kQuarterTurn);
        body.quadrant = static_cast<int>(quarters);
        body.angle = given_.theta - quarters * kQuarterTurn;
        // An angle that rounding has left beside a face is that of the face.
        const double rounding =
            8.0 * std::numeric_limits<double>::epsilon() * (1.0 + std::abs(given_.theta));
        if (kQuarterTurn - body.angle < rounding) {
            ++body.quadrant;
            body.angle = 0.0;
        } else if (body.angle < rounding) {
            body.angle = 0.0;
        }
        body.x = sign_ * given_.x;
        body.vx = sign_ * given_.vx;
        if (whole_plane_) {
            const Slip velocity = heading_.seen(given_.vx, given_.vy);
            body.y = given_.y;
            body.vx = velocity.along;
            body.vy = velocity.across;
        }
        body.vz = given_.vz;
        body.omega = given_.omega;
    }

    // A mass that is at a stop, and does not move, rests there as long as it presses on it.
    void place_inner() {
        const InnerMass& inner = model_.inner;
        if (inner.absent()) return;
        InnerState& state = start_.state.inner;
        state = {given_.inner_place, given_.inner_velocity, 0};
        if (state.place < inner.low || state.place > inner.high) {
            refuse("initial.inner_place", state.place,
                   "from inner.stop_low to inner.stop_high, " + digits(inner.low) + " to " +
                       digits(inner.high) + " m");
        }
        if (state.velocity != 0.0) return;
        state.stop = state.place == inner.high ? 1 : state.place == inner.low ? -1 : 0;
    }

    // Height of the lowest corner above the surface, m.
    double check_height() {
        const double height = pose().height;
        start_.state.body.z = given_.z == 0.0 ? height : given_.z;
        const double gap = start_.state.body.z - height;
        if (gap < -kSlack * shape_.radius()) {
            refuse("initial.z", given_.z,
                   "at least " + lowest(height) +
                       " m, where the lowest corner is on the surface, or 0 for that height");
        }
        return gap;
    }

    void require_touch(double gap) const {
        if (gap > kSlack * shape_.radius()) {
            refuse("initial.z", given_.z,
                   "0 or " + digits(pose().height) +
                       " m, where the lowest corner is on the surface, with initial.contact = \"" +
                       word_ + "\"");
        }
    }

    void require_flat() const {
        if (start_.state.body.angle != 0.0) {
            refuse("initial.theta", given_.theta,
                   "a multiple of pi/2 with initial.contact = \"" + word_ + "\"");
        }
        if (std::abs(given_.omega) * shape_.radius() > slack()) {
            refuse("initial.omega", given_.omega, "0 with initial.contact = \"" + word_ + "\"");
        }
        if (std::abs(given_.vz) > slack()) {
            refuse("initial.vz", given_.vz, "0 with initial.contact = \"" + word_ + "\"");
        }
    }

    void require_no_lift() const {
        const BodyState& body = start_.state.body;
        if (std::abs(corner_velocity_z(pose(), body.vz, body.omega)) > slack()) {
            refuse("initial.vz", given_.vz,
                   digits(body.omega * pose().lever_arm) +
                       " m/s, with which the corner stays on the surface, with initial.contact = "
                       "\"" +
                       word_ + "\"");
        }
    }

    // The slip of a contact of a given mode, whose sign has to be that of the motion.
    void set_slip(ContactWord forward, ContactWord backward) {
        const BodyState& body = start_.state.body;
        const double slip_velocity = corner_velocity_x(pose(), body.vx, body.omega);
        const double along_world = sign_ * slip_velocity;
        const bool moves = std::abs(slip_velocity) > slack() || std::abs(body.vy) > slack();
        const int wanted = given_.contact == forward ? 1 : given_.contact == backward ? -1 : 0;
        // A slip across is neither.
        const bool fits = whole_plane_ ? wanted != 0 : wanted * along_world > 0.0;
        if (moves && !fits) {
            refuse("initial.contact", word_,
                   (wanted == 0 ? "a state whose contact does not move; this one moves at "
                                : "a state whose contact moves that way; this one moves at ") +
                       digits(along_world) + " m/s");
        }
        // In the whole plane a slip has a vector, and its mode no sign.
        start_.state.mode.slip = whole_plane_ ? std::abs(wanted) : wanted * static_cast<int>(sign_);
        start_.state.slip_velocity = moves ? slip_velocity : 0.0;
        start_.state.slip_y = moves ? body.vy : 0.0;
    }

    void from_motion(double gap) {
        HybridState& state = start_.state;
        state.mode = {Touch::none, 0};
        if (gap > kSlack * shape_.radius()) return;
        const BodyState& body = state.body;
        const double front = corner_velocity_z(pose(), body.vz, body.omega);
        // The other corner of a face that lies on the surface.
        const bool flat = body.angle == 0.0;
        const double rear = flat ? front + 2.0 * shape_.half_base(body.quadrant) * body.omega
                                 : std::numeric_limits<double>::infinity();
        if (front < -slack() || rear < -slack()) {
            start_.touches_down = true;
            return;
        }
        const bool front_stays = front <= slack(), rear_stays = rear <= slack();
        if (!front_stays && !rear_stays) return;
        if (front_stays && rear_stays) {
            state.mode.touch = Touch::face;
        } else {
            on_corner(rear_stays);
        }
        const double slip_velocity = corner_velocity_x(pose(), body.vx, body.omega);
        if (std::abs(slip_velocity) > slack() || std::abs(body.vy) > slack()) {
            state.slip_velocity = slip_velocity;
            state.slip_y = body.vy;
            state.mode.slip = whole_plane_ || slip_velocity > 0.0 ? 1 : -1;
        }
    }

    // Whether, of a face on the surface, the rear corner is the one that neither lands nor leaves.
    bool stays_on_rear_corner() const {
        const BodyState& body = start_.state.body;
        const double front = corner_velocity_z(pose(), body.vz, body.omega);
        const double rear = front + 2.0 * shape_.half_base(body.quadrant) * body.omega;
        return std::abs(rear) < std::abs(front);
    }

    // The rear corner of a face is the pivot of the quadrant before, at its end.
    void on_corner(bool rear) {
        start_.state.mode.touch = Touch::corner;
        if (!rear) return;
        start_.state.body.quadrant -= 1;
        start_.state.body.angle = kQuarterTurn;
    }

    Pose pose() const {
        const BodyState& body = start_.state.body;
        return model_.pose(body.quadrant, body.angle);
    }
    double slack() const {
        return kSlack * (std::abs(given_.vx) + std::abs(given_.vy) + std::abs(given_.vz) +
                         std::abs(given_.omega) * shape_.radius()) +
               kLeastVelocity;
    }

    [[noreturn]] static void refuse(const char* key, double value, const std::string& allowed) {
        throw std::invalid_argument(std::string(key) + " = " + digits(value) + ": allowed is " +
                                    allowed);
    }
    [[noreturn]] static void refuse(const char* key, const std::string& word,
                                    const std::string& allowed) {
        throw std::invalid_argument(std::string(key) + " = \"" + word + "\": allowed is " +
                                    allowed);
    }

    const SimulationState& given_;
    const std::string word_;
    const Model& model_;
    const Rectangle& shape_;
    const double sign_;
    const bool whole_plane_;
    const Heading heading_;
    Start start_;
};

}  // namespace

Start initial_state(const Scenario& scenario, const Model& model) {
    return Starter(scenario, model).start();
}

SimulationState world_state(const HybridState& state, double contact_age, double frame_sign,
                            bool in_whole_plane) {
    const BodyState& body = state.body;
    ContactMode mode = state.mode;
    if (in_whole_plane) {
        const Heading heading = Heading::of_angle(body.heading);
        mode = seen_along(mode, heading.seen(state.slip_velocity, state.slip_y).along);
    }
    SimulationState result;
    result.x = frame_sign * body.x;
    result.z = body.z;
    result.theta = body.theta();
    result.vx = frame_sign * body.vx;
    result.y = body.y;
    result.vy = body.vy;
    result.heading = frame_sign < 0.0 ? std::numbers::pi : body.heading;
    result.vz = body.vz;
    result.omega = body.omega;
    result.contact = static_cast<ContactWord>(1 + contact_code(mode, frame_sign));
    result.inner_place = state.inner.place;
    result.inner_velocity = state.inner.velocity;
    result.contact_age = state.mode.touch == Touch::none ? 0.0 : contact_age;
    return result;
}

}  // namespace stickslip
