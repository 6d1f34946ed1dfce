#include "stickslip/drive/sawtooth.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

namespace stickslip {

SurfaceDirection surface_direction(double angle) {
    if (angle == 0.0) return {1.0, 0.0};  // asked for several times a run
    constexpr double kQuarter = 0.5 * std::numbers::pi;
    const double quarters = std::round(angle / kQuarter);
    const double rest = angle - quarters * kQuarter;
    const double cosine = std::cos(rest), sine = std::sin(rest);
    switch (static_cast<int>(std::fmod(quarters, 4.0)) & 3) {
        case 0:
            return {cosine, sine};
        case 1:
            return {0.0 - sine, cosine};  // never -0
        case 2:
            return {-cosine, 0.0 - sine};
        default:
            return {sine, -cosine};
    }
}

VoltageProgram sawtooth_program(const Drive& drive, const SurfaceDirection& towards,
                                const PerCoil& volts_per_tesla) {
    if (drive.kind() != DriveKind::sawtooth) {
        throw std::invalid_argument("this drive has no sawtooth");
    }
    const double sign = drive.clamp == Clamp::down ? -1.0 : 1.0;
    const bool in_plane_pulses = drive.mode == DriveMode::ipp;
    // `pulsing` is the field of the coil that plays the sawtooth, whichever it is.
    const auto voltages = [&](double pulsing, double holding) {
        PerCoil volts = {};
        const double in_plane = in_plane_pulses ? pulsing : holding;
        const auto add = [&](Coil plus, Coil minus, double part) {
            if (part == 0.0) return;
            const auto ahead = static_cast<std::size_t>(part > 0.0 ? plus : minus);
            const auto behind = static_cast<std::size_t>(part > 0.0 ? minus : plus);
            const double of_one = drive.coils == DriveCoils::pairs ? 0.5 * part : part;
            volts[ahead] = volts_per_tesla[ahead] * (of_one * in_plane);
            if (drive.coils == DriveCoils::pairs) {
                volts[behind] = volts_per_tesla[behind] * (of_one * in_plane);
            }
        };
        add(Coil::xp, Coil::xm, towards.x);
        add(Coil::yp, Coil::ym, towards.y);
        volts[kClampCoil] =
            volts_per_tesla[kClampCoil] * sign * (in_plane_pulses ? holding : pulsing);
        return volts;
    };
    const PerCoil off = {};
    const PerCoil bottom = voltages(drive.base, drive.hold);
    const PerCoil top = voltages(drive.peak, drive.hold);
    const double period = 1.0 / drive.frequency;

    std::vector<VoltageBlock> blocks;
    if (drive.ramp > 0.0) blocks.push_back({{{0.0, off}, {drive.ramp, bottom}}, 1});
    VoltageBlock pulse;
    pulse.repeats = drive.pulses;
    if (drive.edge == Edge::rise) {
        pulse.points = {{0.0, bottom}, {drive.edge_time, top}, {period, bottom}};
    } else {
        pulse.points = {{0.0, bottom}, {period - drive.edge_time, top}, {period, bottom}};
    }
    blocks.push_back(std::move(pulse));
    if (drive.ramp_down > 0.0) {
        PerCoil down = {};
        down[kClampCoil] = bottom[kClampCoil];
        blocks.push_back({{{0.0, bottom}, {drive.ramp_down, down}}, 1});
    }
    return VoltageProgram(std::move(blocks));
}

Coil in_plane_coil(const SurfaceDirection& towards) {
    if (std::abs(towards.x) >= std::abs(towards.y)) return towards.x > 0.0 ? Coil::xp : Coil::xm;
    return towards.y > 0.0 ? Coil::yp : Coil::ym;
}

VoltageProgram turned(const VoltageProgram& program) {
    std::vector<VoltageBlock> blocks = program.blocks();
    for (VoltageBlock& block : blocks) {
        for (VoltagePoint& point : block.points) point.voltage = turned(point.voltage);
    }
    return VoltageProgram(std::move(blocks));
}

}  // namespace stickslip
