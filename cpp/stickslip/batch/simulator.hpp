#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stickslip/batch/lanes.hpp"
#include "stickslip/run/run_snapshot.hpp"
#include "stickslip/scenario/scenario.hpp"

namespace stickslip {

/// Hash of all that moves the robot, initial currents included, without the initial state and the
/// record: two scenarios of one hash can exchange snapshots.
std::uint64_t fingerprint(const Scenario& scenario);

/// A run that is entered and left at any instant, alone or in a SimulatorBatch. Its scenario's
/// drive says how strong the fields are, to which the tolerance is relative, and how warm the
/// coils; it is not played.
class Simulator {
public:
    /// Begins at `scenario.initial`. Throws std::invalid_argument as `simulate` does. index,
    /// control: of a batch.
    explicit Simulator(const Scenario& scenario, std::size_t index = 0,
                       RunControl* control = nullptr);

    /// Plays `duration` s (above zero) with these voltages (V, world's frame), held, or linear from
    /// `start`, to which they jump, or without it from those of the step before. Throws
    /// std::invalid_argument, and moves nothing, for voltages that turn a robot whose scenario
    /// keeps it in one plane.
    void step(const PerCoil& voltages, double duration, bool linear,
              const PerCoil* start = nullptr);

    double time() const;  ///< s; after a step that failed, the instant at which it did
    SimulationState state() const { return run().player().world(); }
    /// How the last step ended; one that did not end well is the last.
    Status status() const { return run().status(); }
    const std::string& message() const { return failure_; }
    bool in_whole_plane() const { return run().player().in_whole_plane(); }

    /// Voltages at the end of the last step, in the world's frame, V.
    PerCoil voltages() const { return run().steps().voltages(); }

    RunSnapshot snapshot() const;
    /// Throws std::invalid_argument for a snapshot of another scenario, or of a run in the whole
    /// plane for one in one plane.
    void restore(const RunSnapshot& snapshot);

    // The parts of a step, between which a batch plays the lanes of several.

    /// Throws std::invalid_argument for voltages that turn a robot whose scenario keeps it in one
    /// plane.
    void check_step(const PerCoil& voltages) const;
    /// The five voltages are read as the step is played.
    void begin_step(const double* voltages, double duration, bool linear);
    Lane& lane() { return lane_; }
    /// Fails a run that has not come to the end of its step, with `status`.
    void give_up(Status status);
    /// Keeps why a step failed.
    void end_step();

private:
    Run& run() { return lane_.run; }
    const Run& run() const { return lane_.run; }

    Scenario scenario_;
    std::uint64_t fingerprint_;
    Lane lane_;
    std::string failure_;  // why the last step failed and what to do, else empty
};

}  // namespace stickslip
