#include "stickslip/drive.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

namespace stickslip {
namespace {

constexpr auto kInPlane = static_cast<std::size_t>(Coil::xp);
constexpr auto kClampCoil = static_cast<std::size_t>(Coil::clamp);

}  // namespace

VoltageProgram sawtooth_program(const Drive& drive, const PerCoil& volts_per_tesla) {
    if (drive.mode == DriveMode::program) {
        throw std::invalid_argument("a voltage program has no sawtooth");
    }
    const double sign = drive.clamp == Clamp::down ? -1.0 : 1.0;
    const bool in_plane_pulses = drive.mode == DriveMode::ipp;
    // `pulsing` is the field of the coil that plays the sawtooth, whichever it is.
    const auto voltages = [&](double pulsing, double holding) {
        PerCoil volts = {};
        volts[kInPlane] = volts_per_tesla[kInPlane] * (in_plane_pulses ? pulsing : holding);
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
        PerCoil down = bottom;
        down[kInPlane] = 0.0;
        blocks.push_back({{{0.0, bottom}, {drive.ramp_down, down}}, 1});
    }
    return VoltageProgram(std::move(blocks));
}

Coil in_plane_coil(Direction direction) {
    return direction == Direction::plus_x ? Coil::xp : Coil::xm;
}

VoltageProgram turned(const VoltageProgram& program) {
    std::vector<VoltageBlock> blocks = program.blocks();
    for (VoltageBlock& block : blocks) {
        for (VoltagePoint& point : block.points) {
            point.voltage = turned(point.voltage);
        }
    }
    return VoltageProgram(std::move(blocks));
}

}  // namespace stickslip
