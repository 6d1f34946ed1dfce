#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "stickslip/drive/coil.hpp"
#include "stickslip/numbers/rows.hpp"

namespace stickslip {

/// Contact mode of a state: one of a recording's, or `from_motion`, derived from the motion.
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
/// robot's own frame. By default at rest on its face, without current. Units and meanings are in
/// `kStateColumns`.
struct SimulationState {
    double x = 0.0, z = 0.0, theta = 0.0;
    double vx = 0.0, vz = 0.0, omega = 0.0;
    PerCoil current = {}, field_lag = {}, capacitor = {};
    ContactWord contact = ContactWord::from_motion;
    double contact_age = 0.0;
    double y = 0.0, vy = 0.0, heading = 0.0;
    double inner_place = 0.0, inner_velocity = 0.0;

    friend bool operator==(const SimulationState&, const SimulationState&) = default;
};

inline constexpr auto kContactWords = std::to_array<Word<ContactWord>>({
    {ContactWord::from_motion, "from_motion",
     "what lies on the surface touches, unless it moves away, and slips if it moves along"},
    {ContactWord::flight, "flight", "nothing touches"},
    {ContactWord::corner_stick, "corner_stick", "one corner touches and sticks"},
    {ContactWord::corner_slip_forward, "corner_slip_forward", "it slips to +x"},
    {ContactWord::corner_slip_backward, "corner_slip_backward", "it slips to -x"},
    {ContactWord::face_stick, "face_stick", "a face lies on the surface and sticks"},
    {ContactWord::face_slip_forward, "face_slip_forward", "it slips to +x"},
    {ContactWord::face_slip_backward, "face_slip_backward", "it slips to -x"},
});
static_assert(in_order(kContactWords));

/// A column of states in an array, and a number that a scenario may begin with.
struct StateColumn {
    std::string_view name;  ///< of the key after "initial."
    const char* unit;       ///< SI
    double low, high;       ///< allowed at the start
    const char* meaning;
    double (*get)(const SimulationState&);
    void (*set)(SimulationState&, double);
};

// A table: clang-format would give each member of a row a line of its own.
// clang-format off
#define STICKSLIP_STATE(member)                                                         \
    [](const SimulationState& s) -> double { return static_cast<double>(s.member); },   \
    [](SimulationState& s, double value) { s.member = static_cast<decltype(s.member)>(value); }
#define STICKSLIP_COIL(k, name)                                                         \
    {"current_" name, "A", -1e6, 1e6, "current of the coil " name, STICKSLIP_STATE(current[k])}
#define STICKSLIP_LAG(k, name)                                                          \
    {"field_lag_" name, "A", -1e6, 1e6,                                                 \
     "current of the field of " name " beyond that of the coil, with effects.eddy_lag", \
     STICKSLIP_STATE(field_lag[k])}
#define STICKSLIP_CAPACITOR(k, name)                                                    \
    {"capacitor_" name, "V", -1e9, 1e9, "voltage of the capacitor of " name,            \
     STICKSLIP_STATE(capacitor[k])}

inline constexpr auto kStateColumns = std::to_array<StateColumn>({
    {"x", "m", -100, 100, "position of the centre of mass along the surface", STICKSLIP_STATE(x)},
    {"z", "m", 0, 100, "height of the centre of mass; 0: the lowest corner is on the surface",
     STICKSLIP_STATE(z)},
    {"theta", "rad", -1e6, 1e6, "pitch, nose-down positive", STICKSLIP_STATE(theta)},
    {"vx", "m/s", -1000, 1000, "velocity along the surface", STICKSLIP_STATE(vx)},
    {"vz", "m/s", -1000, 1000, "velocity away from the surface", STICKSLIP_STATE(vz)},
    {"omega", "rad/s", -1e7, 1e7, "rate of the pitch", STICKSLIP_STATE(omega)},
    STICKSLIP_COIL(0, "xp"), STICKSLIP_COIL(1, "xm"), STICKSLIP_COIL(2, "yp"),
    STICKSLIP_COIL(3, "ym"), STICKSLIP_COIL(4, "clamp"),
    STICKSLIP_LAG(0, "xp"), STICKSLIP_LAG(1, "xm"), STICKSLIP_LAG(2, "yp"),
    STICKSLIP_LAG(3, "ym"), STICKSLIP_LAG(4, "clamp"),
    STICKSLIP_CAPACITOR(0, "xp"), STICKSLIP_CAPACITOR(1, "xm"), STICKSLIP_CAPACITOR(2, "yp"),
    STICKSLIP_CAPACITOR(3, "ym"), STICKSLIP_CAPACITOR(4, "clamp"),
    {"contact", "1", 0, kContactWords.size() - 1, "mode of the contact, an index",
     STICKSLIP_STATE(contact)},
    {"contact_age", "s", 0, 1e9, "time since the last touch-down", STICKSLIP_STATE(contact_age)},
    {"y", "m", -100, 100, "position of the centre of mass across the x axis", STICKSLIP_STATE(y)},
    {"vy", "m/s", -1000, 1000, "velocity across the x axis", STICKSLIP_STATE(vy)},
    {"heading", "rad", -6.3, 6.3,
     "way that the robot faces, from +x to the left; at the start it counts where the field is too "
     "weak to say", STICKSLIP_STATE(heading)},
    {"inner_place", "m", -1, 1, "place of the inner mass in the body, beside that at rest",
     STICKSLIP_STATE(inner_place)},
    {"inner_velocity", "m/s", -1000, 1000, "velocity of the inner mass in the body",
     STICKSLIP_STATE(inner_velocity)},
});

#undef STICKSLIP_CAPACITOR
#undef STICKSLIP_LAG
#undef STICKSLIP_COIL
#undef STICKSLIP_STATE
// clang-format on

inline constexpr std::size_t kContactColumn = place_of(kStateColumns, "contact");

/// Whether a column is of the coils.
inline bool is_current(std::size_t column) {
    const std::string_view unit = kStateColumns[column].unit;
    return unit == "A" || unit == "V";
}
using StateRow = std::array<double, kStateColumns.size()>;

inline StateRow row_of(const SimulationState& state) {
    StateRow row;
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = kStateColumns[k].get(state);
    return row;
}

inline SimulationState state_of(const double* row) {
    SimulationState state;
    for (std::size_t k = 0; k < kStateColumns.size(); ++k) kStateColumns[k].set(state, row[k]);
    return state;
}

}  // namespace stickslip
