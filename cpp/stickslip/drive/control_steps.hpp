#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stickslip/drive/voltage_program.hpp"

namespace stickslip {

/// The voltages of a run that is stepped from outside, as the segments that the coils get.
class ControlSteps {
public:
    /// hold_period: s, of the digital-to-analogue converter; zero: none. limit: V, of the
    /// amplifiers; zero: none. latency: s, by which the coils get their voltages late, none before
    /// the first. turned: whether the robot faces -x.
    ControlSteps(double hold_period, double limit, double latency, bool turned)
        : hold_(hold_period), limit_(limit), latency_(latency), turned_(turned) {
        if (latency > 0.0) memory_.late.push_back({0.0, latency, {}, {}});
    }

    /// The next `count` steps of `duration` s: rows of five voltages in the world's frame (V),
    /// which have to live until they are played. Held, or linear from the voltages before.
    void give(const double* voltages, std::size_t count, double duration, bool linear);

    /// Sets the voltages before the next step, in the world's frame, V.
    void jump(const PerCoil& voltages) {
        memory_.last = turned_ ? stickslip::turned(voltages) : voltages;
    }

    /// Writes the next segment, in the robot's frame, and returns true; false where all is played.
    bool next(VoltageSegment& segment);

    /// Whether the segment that `next` wrote last is the last of its step.
    bool ends_step() const { return given_until_ == time(); }

    double time() const { return memory_.origin + steps_since() * memory_.duration; }  ///< s
    /// State carried from step to step.
    struct Memory {
        double origin = 0.0;    ///< s, from where on all steps had one duration
        double duration = 0.0;  ///< s
        std::int64_t steps = 0;
        PerCoil last = {};                 ///< V, at the end of the last step
        std::vector<VoltageSegment> late;  ///< on their way to the coils, with a latency
        SampleHold::Memory hold;
    };
    Memory memory() const {
        Memory result = memory_;
        result.hold = hold_.memory();
        return result;
    }
    /// Voltages at the end of the last step, in the world's frame, V.
    PerCoil voltages() const { return turned_ ? stickslip::turned(memory_.last) : memory_.last; }
    /// Goes on from a memory between two steps; the rest of a failed step is not played.
    void restore(const Memory& memory) {
        memory_ = memory;
        hold_.restore(memory.hold, time());
        asked_.clear();
        left_ = 0;
        given_until_ = time();
    }

private:
    double steps_since() const { return static_cast<double>(memory_.steps); }
    bool next_asked(VoltageSegment& segment);
    bool begin_next();
    void begin_step(const double* row);

    SampleHold hold_;
    double limit_, latency_;
    bool turned_;
    Memory memory_;  // but for `hold`
    const double* rows_ = nullptr;
    std::size_t left_ = 0;
    bool linear_ = false;
    std::vector<VoltageSegment> asked_;  // of the step that is played, the next one last
    double given_until_ = 0.0;           // s
};

}  // namespace stickslip
