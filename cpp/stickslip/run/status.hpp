#pragma once

#include <array>
#include <string_view>

#include "stickslip/numbers/rows.hpp"
#include "stickslip/solver/stepping.hpp"

namespace stickslip {

/// How a simulation ended: its word, what happened, and what to do about it.
struct StatusRow {
    Status code;
    std::string_view name;
    const char* message;
    const char* remedy;  ///< "" where there is nothing to do
};

inline constexpr auto kStatuses = std::to_array<StatusRow>({
    {Status::ok, "ok", "the run reached its end", ""},
    {Status::step_underflow, "step_underflow", "the step fell below the resolution of time",
     "loosen solver.rtol, or look for a force that grows without bound"},
    {Status::too_many_events, "too_many_events", "contact events followed each other without end",
     "change solver.rtol, or look at friction and restitution"},
    {Status::not_finite, "not_finite", "a force or a coordinate was not a number",
     "look for extreme values in the scenario"},
    {Status::left_workspace, "left_workspace", "the robot reached the coils",
     "give fewer pulses or less field, or look at effects.surface_tilt and friction"},
    {Status::interrupted, "interrupted", "the run was stopped", ""},
    {Status::no_arkode, "no_arkode", "this build has no arkode",
     "use solver.method = \"tsit5\", or install SUNDIALS and build again"},
    {Status::too_many_steps, "too_many_steps",
     "the run had taken as many steps as solver.max_steps allows",
     "look for a value in a wrong unit, raise solver.max_steps, or simulate less time"},
    {Status::heading_lost, "heading_lost",
     "the horizontal field had been too weak to hold the robot's heading and came back "
     "from another side, so that nobody knows where the robot faces",
     "turn the field without letting it fade, or keep it stronger than an ambient field "
     "across it (drive.base, the voltages)"},
    {Status::turns_too_fast, "turns_too_fast",
     "the horizontal field turned faster than the robot can follow",
     "turn it more slowly, or make it stronger"},
});
static_assert(in_order(kStatuses));

/// Throws std::out_of_range for a status without a row.
constexpr const StatusRow& row_of(Status status) {
    return kStatuses.at(static_cast<std::size_t>(status));
}

}  // namespace stickslip
