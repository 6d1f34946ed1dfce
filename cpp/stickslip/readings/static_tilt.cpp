#include "stickslip/readings/static_tilt.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "stickslip/contact/contact.hpp"
#include "stickslip/numbers/roots.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/scenario_rows.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {
namespace {

constexpr int kQuadrants = 4;

// With weight and magnet alone the moment is one sinusoid and changes sign once in a quadrant at
// most; what else may act is looked for on this many intervals.
constexpr int kIntervals = 16;

/// The robot at rest in one field.
class AtRest {
public:
    AtRest(const Model& model, const CoilSet& coils, double bx, double bz)
        : model_(model), dynamics_(model, LocalField(coils, PerCoil{})) {
        field_.terms[0] = bx;
        field_.terms[1] = bz;
    }

    /// +1 if the face at the start of `quadrant` tips about its end ahead, -1 about the one behind.
    int tips(int quadrant) {
        dynamics_.set_quadrant(quadrant);
        const Pose pose = dynamics_.pose(0.0);
        const Load load = dynamics_.load(field_, 0.0, pose.height, pose, 0.0, 0.0, 0.0);
        const FaceReaction reaction = face_reaction(model_, quadrant, load, true, 0.0);
        if (reaction.behind < 0.0 && reaction.behind <= reaction.ahead) return 1;
        return reaction.ahead < 0.0 ? -1 : 0;
    }

    /// Moment about the lowest corner, N m.
    double moment(int quadrant, double angle) {
        dynamics_.set_quadrant(quadrant);
        const Pose pose = dynamics_.pose(angle);
        const Load load = dynamics_.load(field_, 0.0, pose.height, pose, 0.0, 0.0, 0.0);
        return moment_about_corner(pose, load);
    }

    /// Where turning from angle `from` in the direction `sense` ends: a quarter turn on if nothing
    /// stops it.
    double balance(int quadrant, double from, int sense) {
        const double step = sense * kQuarterTurn / kIntervals;
        double near = from, turning = sense * moment(quadrant, from);
        if (turning <= 0.0) return from;
        for (int k = 1; k <= kIntervals; ++k) {
            const double far = from + k * step;
            const double there = sense * moment(quadrant, far);
            if (there <= 0.0) {
                return find_root(Bracket{near, far, turning, there},
                                 [&](double angle) { return sense * moment(quadrant, angle); })
                    .value_or(far);
            }
            near = far;
            turning = there;
        }
        return from + sense * kQuarterTurn;
    }

private:
    const Model& model_;
    Dynamics dynamics_;
    Expansion field_ = {};
};

double tilt(const Model& model, const CoilSet& coils, double bx, double bz) {
    AtRest robot(model, coils, bx, bz);
    const int sense = robot.tips(0);
    if (sense == 0) return 0.0;
    for (int turned = 0; turned < kQuadrants; ++turned) {
        // The face that lands at the end of a quarter turn is the one the next begins with.
        const int quadrant = sense > 0 ? turned : -turned - 1;
        const double from = sense > 0 ? 0.0 : kQuarterTurn;
        const double angle = robot.balance(quadrant, from, sense);
        if (std::abs(angle - from) < kQuarterTurn) return quadrant * kQuarterTurn + angle;
        const int landed = sense * (turned + 1);
        if (robot.tips(landed) != sense) return landed * kQuarterTurn;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double static_tilt(const Model& model, double bx, double bz) {
    return tilt(model, CoilSet(), bx, bz);
}

std::vector<double> static_tilts(const Scenario& base, const std::vector<std::string>& keys,
                                 const std::vector<double>& values,
                                 const std::vector<double>& fields) {
    if (fields.size() % 2 != 0) throw std::invalid_argument("fields must have Bx and Bz");
    const ScenarioRows rows(base, keys, values);
    const std::size_t points = rows.size();
    const CoilSet coils;
    const std::size_t count = fields.size() / 2;
    std::vector<double> readings(points * count, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < points; ++i) {
        Scenario scenario;
        try {
            scenario = rows[i];
        } catch (const std::invalid_argument&) {
            continue;
        }
        const Model model = make_model(scenario, frame_of(scenario));
        const Effects& effects = scenario.effects;
        const double sign = model.frame.sign;
        for (std::size_t j = 0; j < count; ++j) {
            const double bx = sign * (fields[2 * j] + effects.ambient_field_bx);
            const double bz = fields[2 * j + 1] + effects.ambient_field_bz;
            try {
                readings[i * count + j] = tilt(model, coils, bx, bz);
            } catch (const WrenchNotFinite&) {
                continue;
            }
        }
    }
    return readings;
}

}  // namespace stickslip
