#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// Effects that a user adds while the program runs: a force and a torque given by a function.
namespace stickslip {

/// Arguments of a user's function, in the world's frame: x along the surface, z away from it.
/// Angles are those of the robot's own frame, nose-down positive whichever way it faces, as in a
/// recording. Nothing of the measurement's own effects is in it.
struct WrenchState {
    double t;              ///< s, since the start of the run
    double x, z;           ///< m, centre of mass; z above the surface
    double theta;          ///< rad, whole turns included
    double vx, vz, omega;  ///< m/s, m/s, rad/s
    double bx, bz;         ///< T, of all coils and the ambient field at the centre of mass

    static constexpr std::size_t kSize = 9;
};

/// state: WrenchState in its order. parameters: in the order of UserEffect::parameters. wrench: to
/// be filled with the force at the centre of mass, Fx and Fz in N in the world's frame, and the
/// torque in N m, nose-down positive; what is left unwritten is not finite. It has to be a pure
/// function, as it is called for trial states too, in any order and on several threads at a time.
/// An exception that it throws ends the simulation, which throws it on.
using WrenchFunction =
    std::function<void(const double* state, const double* parameters, double* wrench)>;

struct UserParameter {
    std::string name;  ///< of the key "effects.<effect>.<name>"
    std::string unit;  ///< SI, "-" for none
    double low = 0.0, high = 0.0;
    double absent = 0.0;  ///< the value that a scenario has where none is given
    std::string meaning;
};

/// Does nothing, and its function is not called, while all its parameters have their absent values.
struct UserEffect {
    std::string name, meaning, source;
    std::vector<UserParameter> parameters;
    WrenchFunction function;

    std::string key(std::size_t parameter) const {
        return "effects." + name + "." + parameters[parameter].name;
    }
};

/// Shared by those who simulate with it: it may be unregistered meanwhile.
using UserEffectHandle = std::shared_ptr<const UserEffect>;

/// The values of an effect's parameters in a scenario.
struct UserSetting {
    UserEffectHandle effect;
    std::vector<double> values;

    bool absent() const {
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (values[i] != effect->parameters[i].absent) return false;
        }
        return true;
    }
};

/// The function of an effect gave a force or torque that is not a finite number.
class WrenchNotFinite : public std::runtime_error {
public:
    WrenchNotFinite(const std::string& name, double at)
        : std::runtime_error(name + ": not a finite number"), effect(name), time(at) {}

    std::string effect;
    double time;  ///< s, of the state for which it did
};

}  // namespace stickslip
