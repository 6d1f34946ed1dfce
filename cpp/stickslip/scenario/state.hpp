#pragma once

#include <array>
#include <cstddef>

#include "stickslip/drive/coil.hpp"

namespace stickslip {

/// What a state says of its contact: the modes of a recording, or what the motion says.
enum class ContactWord {
    from_motion,
    flight,
    corner_stick,
    corner_slip_forward,
    corner_slip_backward,
    face_stick,
    face_slip_forward,
    face_slip_backward
};

/// Robot and coils at an instant, in the world's frame; theta, omega: nose-down positive in the
/// robot's own frame. By default at rest on its face, without current.
struct SimulationState {
    double x = 0.0;             ///< m, centre of mass
    double z = 0.0;             ///< m; 0: where the lowest corner is on the surface
    double theta = 0.0;         ///< rad
    double vx = 0.0, vz = 0.0;  ///< m/s
    double omega = 0.0;         ///< rad/s
    PerCoil current = {};       ///< A
    PerCoil field_lag = {};     ///< A, current of the field less `current` (`eddy_lag`)
    ContactWord contact = ContactWord::from_motion;
    double contact_age = 0.0;  ///< s, since the last touch-down
    double y = 0.0;            ///< m
    double vy = 0.0;           ///< m/s
    double heading = 0.0;      ///< rad, from the x axis to the way that the robot faces

    friend bool operator==(const SimulationState&, const SimulationState&) = default;
};

/// The columns of states in an array, in their order.
inline constexpr std::array<const char*, 21> kStateColumns = {"x",
                                                              "z",
                                                              "theta",
                                                              "vx",
                                                              "vz",
                                                              "omega",
                                                              "current_xp",
                                                              "current_xm",
                                                              "current_yp",
                                                              "current_ym",
                                                              "current_clamp",
                                                              "field_lag_xp",
                                                              "field_lag_xm",
                                                              "field_lag_yp",
                                                              "field_lag_ym",
                                                              "field_lag_clamp",
                                                              "contact",
                                                              "contact_age",
                                                              "y",
                                                              "vy",
                                                              "heading"};
/// Whether a column is of the coils.
inline bool is_current(std::size_t column) {
    return column >= 6 && column < 16;
}
using StateRow = std::array<double, kStateColumns.size()>;

inline StateRow row_of(const SimulationState& s) {
    return {s.x,
            s.z,
            s.theta,
            s.vx,
            s.vz,
            s.omega,
            s.current[0],
            s.current[1],
            s.current[2],
            s.current[3],
            s.current[4],
            s.field_lag[0],
            s.field_lag[1],
            s.field_lag[2],
            s.field_lag[3],
            s.field_lag[4],
            static_cast<double>(s.contact),
            s.contact_age,
            s.y,
            s.vy,
            s.heading};
}

inline SimulationState state_of(const double* row) {
    SimulationState s{
        .x = row[0], .z = row[1], .theta = row[2], .vx = row[3], .vz = row[4], .omega = row[5]};
    for (std::size_t k = 0; k < kCoilCount; ++k) {
        s.current[k] = row[6 + k];
        s.field_lag[k] = row[6 + kCoilCount + k];
    }
    s.contact = static_cast<ContactWord>(static_cast<int>(row[16]));
    s.contact_age = row[17];
    s.y = row[18];
    s.vy = row[19];
    s.heading = row[20];
    return s;
}

}  // namespace stickslip
