#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stickslip/run/run.hpp"

namespace stickslip {

/// A hash of all that moves the robot, without the initial state, but for its currents, and without
/// the record: two scenarios of one hash can exchange snapshots.
std::uint64_t fingerprint(const Scenario& scenario);

/// A run that is entered and left at any instant. Its scenario's drive says how strong the fields
/// are, to which the tolerance is relative, and how warm the coils; it is not played.
class Simulator {
public:
    /// Begins at `scenario.initial`. Throws std::invalid_argument as `simulate` does.
    explicit Simulator(const Scenario& scenario);

    /// Plays `duration` s (above zero) with these voltages (V, world's frame), held, or linear from
    /// `start`, to which they jump, or without it from those of the step before. Throws
    /// std::invalid_argument, and moves nothing, for voltages that turn a robot whose scenario
    /// keeps it in one plane.
    void step(const PerCoil& voltages, double duration, bool linear,
              const PerCoil* start = nullptr);

    double time() const;  ///< s; after a step that failed, the instant at which it did
    SimulationState state() const { return run_.player().world(); }
    /// How the last step ended; one that did not end well is the last.
    Status status() const { return run_.status(); }
    const std::string& message() const { return failure_; }

    /// At the end of the last step, in the world's frame, V.
    PerCoil voltages() const { return run_.steps().voltages(); }

    RunSnapshot snapshot() const;
    /// Throws std::invalid_argument for a snapshot of another scenario, or of a run in the whole
    /// plane for one in one plane.
    void restore(const RunSnapshot& snapshot);

private:
    Scenario scenario_;
    std::uint64_t fingerprint_;
    Run run_;
    std::string failure_;  // why the last step failed and what to do, else empty
};

}  // namespace stickslip
