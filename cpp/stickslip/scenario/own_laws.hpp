#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/numbers/free_curve.hpp"

namespace stickslip {

struct Law;
struct Scenario;

/// A law of the user's own, the section [laws.NAME]. Its keys come in any order; `check_own_laws`
/// says what is missing or does not go together.
struct OwnLaw {
    static constexpr std::size_t kWords = 3, kNumbers = 3 + kKnots;

    std::string name;
    /// quantity, over, form: places among the words of their keys
    std::array<std::optional<std::size_t>, kWords> words;
    /// fraction, amount, scale, knots
    std::array<std::optional<double>, kNumbers> numbers;

    friend bool operator==(const OwnLaw&, const OwnLaw&) = default;
};

/// A key of a law, "laws.NAME.<name>": one of a few words, or a number.
struct LawKey {
    const char* name;
    const char* meaning;
    std::size_t place;               ///< in OwnLaw
    std::vector<std::string> words;  ///< that are allowed; none for a number
    double low = 0.0, high = 0.0;    ///< of a number
    const char* unit = "SI";         ///< "SI": that of what it is of
    bool low_allowed = true;         ///< whether `low` itself is
};
const std::vector<LawKey>& law_keys();

/// A dotted key in its parts.
struct LawPlace {
    std::string law;
    const LawKey* key;

    std::string name() const { return "laws." + law + "." + key->name; }
};
/// nullopt for a key that no law can have.
std::optional<LawPlace> find_law_key(std::string_view key);

/// Throws std::invalid_argument naming key, value and what is allowed.
void set_law(Scenario& scenario, const LawPlace& place, double value);
void set_law(Scenario& scenario, const LawPlace& place, std::string_view word);
/// The same by the index of the word.
void set_law_word(Scenario& scenario, const LawPlace& place, double index);
void remove_law(Scenario& scenario, std::string_view name);
/// The law of that name; nullptr if there is none.
const OwnLaw* find_law(const Scenario& scenario, std::string_view name);

/// Throws std::invalid_argument naming the key of a law that is missing or has no meaning beside
/// the others, with what is allowed.
void check_own_laws(const Scenario& scenario);

/// The curve of the law of that name, if it has one.
std::optional<FreeShape> curve_of_law(const Scenario& scenario, std::string_view name);

/// Own laws that are complete and not absent, in the world's frame.
std::vector<Law> own_laws(const Scenario& scenario);

}  // namespace stickslip
