#pragma once

#include <cstdint>
#include <string>

#include "stickslip/contact/contact.hpp"
#include "stickslip/contact/heading_watch.hpp"
#include "stickslip/drive/circuit.hpp"
#include "stickslip/drive/control_steps.hpp"

namespace stickslip {

/// Where a stepped run stands between two steps: its state, time and voltages. Nothing else crosses
/// the end of a segment of voltage, so that a restored run goes on with the same bits.
struct RunSnapshot {
    std::uint64_t scenario = 0;  ///< fingerprint of all that moves the robot
    HybridState state;
    double contact_age = 0.0;  ///< s
    Circuit::Memory circuit;
    ControlSteps::Memory steps;
    HeadingWatch::State heading;
    PerCoil gain = {};          ///< of the coils that had current
    bool begun = false;         ///< whether the first segment has begun
    bool touches_down = false;  ///< whether it begins with an impact
    bool in_whole_plane = false;
    Status status = Status::ok;
    double end = 0.0;     ///< s, of a run that failed
    std::string message;  ///< why it failed, else empty

    /// Numbers of eight bytes with a checksum, for machines of the same byte order.
    std::string to_bytes() const;
    /// Throws std::invalid_argument for what is no snapshot, damaged, or of another version.
    static RunSnapshot from_bytes(const std::string& bytes);
};

}  // namespace stickslip
