#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "stickslip/readings/notes.hpp"
#include "stickslip/run/assembly.hpp"
#include "stickslip/scenario/whole_plane.hpp"

namespace stickslip {

/// A scenario, and its run if there is one, with the numbers that notes are made of; SI units.
struct NoteFacts {
    const Scenario& s;
    Summary run = {};
    bool ok = false;       ///< whether the run came to its end
    bool cut = false;      ///< whether its condition ended it
    std::size_t coil = 0;  ///< that a row is asked of
    PerCoil asked = {};    ///< V, the largest that the drive asks of each coil

    /// A number by its name: of those below, of the summary, or of a key of the scenario. Throws
    /// std::logic_error if there is none.
    double number(std::string_view name) const;

    bool sawtooth() const { return s.drive.kind() == DriveKind::sawtooth; }
    bool program() const { return s.drive.kind() == DriveKind::program; }
    bool driven() const { return s.drive.kind() != DriveKind::none; }

    double volume() const { return s.robot.length * s.robot.width * s.robot.height; }
    double density() const { return s.robot.mass / volume(); }
    double moment() const { return std::fabs(s.robot.magnetization) * volume(); }
    double inner_share() const { return s.inner.mass / s.robot.mass; }
    double weight() const { return s.robot.mass * s.gravity; }
    double resting_force() const { return weight() + s.contact.adhesion; }
    double friction_held() const { return s.contact.static_friction * resting_force(); }
    // Along the surface, and the most that holds against it.
    double slope() const { return std::fabs(s.effects.surface_tilt_angle); }
    double slope_force() const { return weight() * std::sin(slope()); }
    double slope_hold() const {
        return s.contact.static_friction * (weight() * std::cos(slope()) + s.contact.adhesion);
    }
    /// Whether the surface or a mass inside shakes the robot.
    bool shaken() const { return !s.shake.absent() || !s.inner.absent(); }
    /// Peak-to-peak of the asked field, T; infinite without a sawtooth.
    double swing() const {
        return sawtooth() ? s.drive.peak - s.drive.base : std::numeric_limits<double>::infinity();
    }
    double middle_field() const { return 0.5 * (s.drive.base + s.drive.peak); }
    double usual_base() const { return 0.2 * s.drive.peak; }  ///< as in the first example
    double pulse() const { return 1.0 / s.drive.frequency; }
    /// Pulses in the measuring window, which begins after the third; 0 for a program.
    double measured_pulses() const {
        const auto pulses = static_cast<double>(s.drive.pulses);
        return program() ? 0.0 : pulses >= 4.0 ? pulses - 3.0 : pulses;
    }
    double window_duration() const { return measuring_window(s).end - measuring_window(s).start; }

    double time_constant(std::size_t k) const {
        return s.coils[k].inductance / s.coils[k].resistance;
    }
    double time_constant() const { return time_constant(coil); }
    double capacitance() const { return s.coils[coil].capacitance; }
    double asked_voltage() const { return asked[coil]; }
    double asked_current() const { return asked[coil] / s.coils[coil].resistance; }
    double pulse_in_times() const { return 1.0 / (s.drive.frequency * time_constant()); }
    double swing_part() const { return field_swing(s.drive.frequency, time_constant()); }
    double swing_left() const { return swing_part() * swing(); }
    /// Whether the sawtooth is that of this coil.
    bool pulses_in_it() const {
        const bool in_plane = s.drive.mode == DriveMode::ipp;
        return kAllCoils[coil] == (in_plane ? in_plane_coil(drive_direction(s)) : Coil::clamp);
    }
    /// Whether a coil that is used is slower, or has a capacitor.
    bool has_slower() const {
        return any_used([this](std::size_t k) { return time_constant(k) > time_constant(); });
    }
    bool blocked() const {
        return any_used([this](std::size_t k) { return s.coils[k].capacitance > 0.0; });
    }

    /// Time from the start of the window to the end of the run, s.
    double measured() const { return run.simulated_time - measuring_window(s).start; }
    double speed() const { return std::hypot(run.mean_velocity, run.mean_velocity_y); }
    /// Velocity along the drive.
    double forward() const {
        const double heading = program() ? 0.0 : s.drive.heading;
        const double sign = !program() && s.drive.direction == Direction::minus_x ? -1.0 : 1.0;
        return sign * std::cos(heading) * run.mean_velocity +
               sign * std::sin(heading) * run.mean_velocity_y;
    }
    double rocks() const { return std::fabs(run.slip_up) + std::fabs(run.slip_down); }
    double slips() const { return rocks() + std::fabs(run.slip_flat); }
    double tilt() const { return std::max(run.theta_max, -run.theta_min); }
    double torque() const { return moment() * run.field_max; }  ///< of the field, N m
    /// Torque of weight and adhesion about the corner that a robot on a face would tip on, N m.
    double held_torque() const {
        const bool stands = std::fabs(std::sin(run.theta_max)) > std::sqrt(0.5);
        return 0.5 * (stands ? s.robot.height : s.robot.length) * resting_force();
    }
    double tipping() const { return held_torque() / torque(); }
    double roll_over() const {
        return static_cast<double>(run.events[static_cast<std::size_t>(EventKind::roll_over)]);
    }
    /// Duration of a pulse, of at most 300 Hz (chosen: the coils let none of faster pulses
    /// through), or of a program, s.
    double period() const {
        return program() ? window_duration() : 1.0 / std::min(pulse_rate(s), 300.0);
    }
    /// Distance in a period over the robot's length; a program may lead out and back.
    double step() const {
        const double way = speed() + (program() ? slips() : 0.0);
        return ok ? way * period() / s.robot.length : Summary::kNone;
    }
    double advance() const { return ok ? forward() * period() / s.robot.length : Summary::kNone; }

    /// Chosen: walks that are worth the name make steps of 1e-2 and more. Without a drive of the
    /// coils something else shakes the robot.
    bool rests() const { return driven() && step() < 1e-3; }
    bool moves() const { return driven() && step() >= 1e-3; }
    bool stuck() const { return rests() && swing() > 0.0; }
    /// On a slope that is too steep it slides; without slip at an edge it is dragged on a face. It
    /// may roll over once or twice at the start, and without a base.
    bool walks() const {
        return step() > 2e-3 && rocks() > 0.0 && run.airborne_fraction <= 0.5 &&
               (roll_over() <= 2.0 || s.drive.base == 0.0) && slope_force() <= slope_hold();
    }
    /// On its rear edge (clamp "up") a robot walks backward as a matter of course. Down a slope, or
    /// where nothing holds the edge, going back says nothing of the drive.
    bool goes_back() const {
        return advance() < -1e-3 && sawtooth() && s.drive.clamp == Clamp::down &&
               s.contact.static_friction > 0.0 && slope_force() <= slope_hold();
    }

private:
    template <class Is>
    bool any_used(Is is) const {
        std::size_t k = 0;
        while (k < kCoilCount && !(asked[k] > 0.0 && is(k))) ++k;
        return k < kCoilCount;
    }
};

/// Changes of a scenario that a note tries.
struct NoteTrial {
    std::vector<std::pair<const char*, SettingValue>> settings = {};
    double voltages = 1.0;  ///< factor on those of a program
};

/// Subject of a note: a run, a scenario (also without a run), or each of its coils.
enum class NoteOf { run, scenario, coil };

/// A kind of note. In `text`, and in what `advice` gives,
///   {KEY}                 names a setting
///   {KEY=}, {KEY=NAME}    is the setting with its value, or with a number or word of that name
///   {NAME:UNIT:DIGITS}    is a number of the facts, with 3 digits without the last part;
///                         {tried.NAME:UNIT} one of the trial
///   {set}                 are the changes of the trial
///   {coil}, {advice}      are the coil, and what `advice` gives.
struct NoteRow {
    const char* code = nullptr;
    const char* value = nullptr;       ///< name of the number concerned
    std::optional<double> above = {};  ///< which the number has to exceed
    const char* first_of =
        nullptr;  ///< of the rows with the same, the first that holds is the note
    NoteOf of = NoteOf::run;
    bool (*when)(const NoteFacts&) = nullptr;
    /// The note stands if the first pulses with one of these changes are as `then` says.
    std::vector<NoteTrial> (*trials)(const NoteFacts&) = nullptr;
    bool (*then)(const NoteFacts&) = [](const NoteFacts& f) { return f.walks(); };
    const char* text = nullptr;
    const char* (*advice)(const NoteFacts&) = nullptr;
    const char* many = nullptr;  ///< what some of many runs are; without it they are not counted

    bool holds(const NoteFacts& facts) const {
        return (!above || facts.number(value) > *above) && (when == nullptr || when(facts));
    }
};

/// All of them, the most serious first.
const std::vector<NoteRow>& note_rows();

}  // namespace stickslip
