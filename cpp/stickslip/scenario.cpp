#include "stickslip/scenario.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace stickslip {
namespace {

// Pulses after which the motion counts as steady, section VII.
constexpr std::int64_t kSettlingPulses = 3;

// Of a recording, at some 170 bytes each.
constexpr double kMostSamples = 1e7;

[[noreturn]] void refuse(const char* key, double value, const std::string& allowed) {
    std::ostringstream text;
    text << key << " = " << value << ": allowed is " << allowed;
    throw std::invalid_argument(text.str());
}

std::string with_value(const char* text, double value) {
    std::ostringstream result;
    result << text << " (" << value << ")";
    return result.str();
}

double pulsing_time(const Drive& drive) {
    return static_cast<double>(drive.pulses) / drive.frequency;
}

}  // namespace

void check(const Scenario& s) {
    if (s.contact.kinetic_friction > s.contact.static_friction) {
        refuse("contact.kinetic_friction", s.contact.kinetic_friction,
               with_value("at most contact.static_friction", s.contact.static_friction));
    }
    if (s.contact.restitution + s.effects.restitution_coefficient > 1.0) {
        refuse("effects.restitution.coefficient", s.effects.restitution_coefficient,
               "at most 1 together with contact.restitution");
    }
    if (s.drive.mode == DriveMode::program) {
        if (s.program.blocks().empty()) {
            throw std::invalid_argument("drive.mode = \"program\": needs drive.file or a waveform");
        }
    } else {
        const double period = 1.0 / s.drive.frequency;
        if (s.drive.peak < s.drive.base) {
            refuse("drive.peak", s.drive.peak, with_value("at least drive.base", s.drive.base));
        }
        if (s.drive.edge_time >= period) {
            refuse("drive.edge_time", s.drive.edge_time,
                   with_value("less than one period, 1/drive.frequency", period));
        }
    }
    if (s.record.kind == RecordKind::uniform && s.record.rate * duration(s) > kMostSamples) {
        refuse("record.rate", s.record.rate,
               with_value("at most 1e7 samples in all, here a rate up to",
                          kMostSamples / duration(s)));
    }
}

double duration(const Scenario& scenario) {
    const Drive& drive = scenario.drive;
    if (drive.mode == DriveMode::program) return scenario.program.duration();
    return drive.ramp + pulsing_time(drive) + drive.ramp_down;
}

double frame_sign(const Scenario& scenario) {
    return scenario.drive.direction == Direction::plus_x ? 1.0 : -1.0;
}

Model make_model(const Scenario& s) {
    const RobotParameters& robot = s.robot;
    Model model;
    model.shape = Rectangle(robot.length, robot.height);
    model.mass = robot.mass;
    model.inertia = robot.mass * (robot.length * robot.length + robot.height * robot.height) / 12.0;
    model.moment = robot.magnetization * robot.length * robot.width * robot.height;
    model.misalignment = s.effects.misalignment_angle;
    const double tilt = frame_sign(s) * s.effects.surface_tilt_angle;
    model.gravity_x = s.gravity * std::sin(tilt);
    model.gravity_z = -s.gravity * std::cos(tilt);
    model.linear_drag = s.drag.linear;
    model.angle_drag = s.effects.angle_drag_strength;
    model.rotational_drag = s.effects.rotational_drag_coefficient;
    model.quadratic_drag = s.drag.rotational;
    model.friction = {s.contact.static_friction, s.contact.kinetic_friction,
                      s.effects.stribeck_friction_velocity};
    model.adhesion = {s.contact.adhesion, s.contact.adhesion_range};
    model.restitution = s.contact.restitution + s.effects.restitution_coefficient;
    return model;
}

Circuit make_circuit(const Scenario& s) {
    return Circuit(s.coil.resistance, s.coil.inductance, s.effects.eddy_lag_time);
}

VoltageProgram make_program(const Scenario& s) {
    if (s.drive.mode == DriveMode::program) {
        return s.drive.direction == Direction::plus_x ? s.program : turned(s.program);
    }
    const CoilSet coils(s.coil.geometry);
    return sawtooth_program(s.drive, s.coil.resistance / coils.centre_field_per_ampere());
}

Window measuring_window(const Scenario& s) {
    const Drive& drive = s.drive;
    if (drive.mode == DriveMode::program) return {0.0, s.program.duration()};
    const std::int64_t first = drive.pulses > kSettlingPulses ? kSettlingPulses : 0;
    return {drive.ramp + static_cast<double>(first) / drive.frequency,
            drive.ramp + pulsing_time(drive)};
}

}  // namespace stickslip
