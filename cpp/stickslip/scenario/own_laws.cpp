#include "stickslip/scenario/own_laws.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stickslip/numbers/number_text.hpp"
#include "stickslip/scenario/named_laws.hpp"
#include "stickslip/scenario/parameters.hpp"

namespace stickslip {
namespace {

enum Word : std::size_t { kQuantity, kOver, kForm };
enum Number : std::size_t { kFraction, kAmount, kScale, kKnot };

constexpr double kMost = 1e9;
constexpr double kShortest = 1e-9;  // s, of a scale in time: steps are as short

struct QuantityWord {
    const char* word;
    Quantity quantity;
    double most;  // of an amount, as of the key of the constant
};
constexpr QuantityWord kQuantityWords[] = {
    {"friction", Quantity::friction, 100.0},
    {"sliding_friction", Quantity::sliding_friction, 100.0},
    {"adhesion", Quantity::adhesion, 1.0},
    {"drag", Quantity::drag, 1e3},
    {"rotational_drag", Quantity::rotational_drag, 1.0},
    {"fluid", Quantity::fluid, 0.0},
};

struct ArgumentWord {
    const char* word;
    Argument argument;
};
constexpr ArgumentWord kArgumentWords[] = {
    {"way", Argument::slip_sign}, {"slip_speed", Argument::slip_speed},
    {"place", Argument::place},   {"tilt", Argument::tilt},
    {"load", Argument::load},     {"time", Argument::time},
    {"age", Argument::age},       {"speed", Argument::speed},
    {"rate", Argument::rate},
};

struct FormWord {
    const char* word;
    Form form;
    Argument of_tilt = Argument::tilt;  // what it takes of the tilt
};
constexpr FormWord kFormWords[] = {
    {"line", Form::line},
    {"square", Form::square},
    {"sine_squared", Form::square, Argument::sine},
    {"cosine_squared", Form::square, Argument::cosine},
    {"gaussian", Form::gaussian},
    {"exponential", Form::exponential},
    {"logarithm", Form::logarithm},
    {"saturation", Form::saturation},
    {"wave", Form::wave},
    {"curve", Form::curve},
};

template <class Rows>
std::vector<std::string> words_of(const Rows& rows) {
    std::vector<std::string> words;
    for (const auto& row : rows) words.emplace_back(row.word);
    return words;
}

const QuantityWord& quantity_of(const OwnLaw& law) {
    return kQuantityWords[*law.words[kQuantity]];
}
const ArgumentWord& argument_of(const OwnLaw& law) {
    return kArgumentWords[*law.words[kOver]];
}
const FormWord& form_of(const OwnLaw& law) {
    return kFormWords[*law.words[kForm]];
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "\"" : ", \"") + word + "\"";
    return text;
}

std::string key_of(const OwnLaw& law, const char* key) {
    return "laws." + law.name + "." + key;
}
std::string given(const OwnLaw& law, Word word) {
    const LawKey& key = law_keys()[word];
    return key_of(law, key.name) + " = \"" + key.words[*law.words[word]] + "\"";
}
std::string given(const OwnLaw& law, Number number) {
    return key_of(law, law_keys()[OwnLaw::kWords + number].name) + " = " +
           digits(*law.numbers[number]);
}
[[noreturn]] void refuse(const std::string& what, const std::string& allowed) {
    throw std::invalid_argument(what + ": allowed is " + allowed);
}

bool has_scale(const OwnLaw& law) {
    return argument_of(law).argument != Argument::slip_sign &&
           form_of(law).of_tilt == Argument::tilt;
}

// Laws of the way and of the load stand apart.
Quantity quantity_over(Quantity quantity, Argument over) {
    if (quantity != Quantity::friction) return quantity;
    if (over == Argument::slip_sign) return Quantity::directional_friction;
    return over == Argument::load ? Quantity::friction_by_load : quantity;
}

// Which arguments a quantity may have, and why no others.
void check_argument(const OwnLaw& law) {
    const Quantity quantity = quantity_of(law).quantity;
    const auto fits = [&](Argument over) {
        return has_argument(quantity_over(quantity, over), over);
    };
    if (fits(argument_of(law).argument)) return;
    std::vector<std::string> words;
    for (const ArgumentWord& row : kArgumentWords) {
        if (fits(row.argument)) words.emplace_back(row.word);
    }
    const char* reason = quantity == Quantity::sliding_friction
                             ? "over all else static friction changes too (\"friction\")"
                         : quantity == Quantity::friction
                             ? "a contact that sticks has no slip speed"
                             : "it has no slip and no load";
    refuse(given(law, kOver) + " with quantity = \"" + quantity_of(law).word + "\"",
           listed(words) + ", as " + reason);
}

void check_words(const OwnLaw& law) {
    for (const Word word : {kQuantity, kOver, kForm}) {
        const LawKey& key = law_keys()[word];
        if (!law.words[word])
            refuse(key_of(law, key.name) + " is missing", "one of " + listed(key.words));
    }
    check_argument(law);
    const Argument over = argument_of(law).argument;
    const std::string what = given(law, kForm) + " over \"" + argument_of(law).word + "\"";
    if (form_of(law).of_tilt != Argument::tilt && over != Argument::tilt) {
        refuse(what, "over = \"tilt\"");
    }
    if (over == Argument::slip_sign && form_of(law).form != Form::line) {
        refuse(what, "\"line\", as there are two ways");
    }
    if (over == Argument::load && !is_bounded(form_of(law).form)) {
        refuse(what,
               "\"gaussian\", \"exponential\", \"saturation\" or \"curve\", as the load of an "
               "impact has no bound");
    }
}

void check_numbers(const OwnLaw& law) {
    const bool has_fraction = law.numbers[kFraction].has_value();
    if (has_fraction && law.numbers[kAmount]) {
        refuse(given(law, kAmount) + " beside fraction = " + digits(*law.numbers[kFraction]),
               "one of fraction and amount");
    }
    if (!has_fraction && !law.numbers[kAmount]) {
        refuse("laws." + law.name + ": fraction or amount is missing", "one of them");
    }
    if (!has_fraction && quantity_of(law).quantity == Quantity::fluid) {
        refuse(given(law, kAmount) + " of quantity = \"fluid\"",
               "a fraction, as force and torque have two units");
    }
    if (has_scale(law) && !law.numbers[kScale]) {
        refuse(key_of(law, "scale") + " is missing", "a number above 0");
    }
    if (!has_scale(law) && law.numbers[kScale]) {
        refuse(given(law, kScale), "no scale over the way or with a squared sine or cosine");
    }
    const Argument over = argument_of(law).argument;
    const bool counts_time = over == Argument::time || over == Argument::age;
    if (counts_time && *law.numbers[kScale] < kShortest) {
        refuse(given(law, kScale), "at least " + digits(kShortest) + " s");
    }
    const double most = quantity_of(law).most;
    if (law.numbers[kAmount] && std::abs(*law.numbers[kAmount]) > most) {
        refuse(given(law, kAmount), "from " + digits(-most) + " to " + digits(most));
    }
    const bool has_knots = std::any_of(law.numbers.begin() + kKnot, law.numbers.end(),
                                       [](const auto& each) { return each.has_value(); });
    const bool is_curve = form_of(law).form == Form::curve;
    if (has_knots && !is_curve) {
        refuse(key_of(law, "knots") + " with " + given(law, kForm), "form = \"curve\"");
    }
    if (is_curve && !has_knots) refuse(key_of(law, "knots") + " are missing", "five numbers");
}

std::optional<double> size_of(const OwnLaw& law) {
    return law.numbers[kFraction] ? law.numbers[kFraction] : law.numbers[kAmount];
}

bool is_complete(const OwnLaw& law) {
    const bool has_words = std::all_of(law.words.begin(), law.words.end(),
                                       [](const auto& each) { return each.has_value(); });
    return has_words && size_of(law);
}

bool is_absent(const OwnLaw& law) {
    const bool is_flat = std::all_of(law.numbers.begin() + kKnot, law.numbers.end(),
                                     [](const auto& each) { return each.value_or(0.0) == 0.0; });
    return *size_of(law) == 0.0 || (form_of(law).form == Form::curve && is_flat);
}

Law made(const OwnLaw& own) {
    const FormWord& form = form_of(own);
    const Argument over = argument_of(own).argument;
    Law law;
    law.kind.quantity = quantity_over(quantity_of(own).quantity, over);
    law.kind.acts = own.numbers[kFraction] ? Acts::multiplies : Acts::adds;
    law.kind.argument = over == Argument::tilt ? form.of_tilt : over;
    law.kind.form = form.form;
    law.amplitude = *size_of(own);
    law.scale = own.numbers[kScale].value_or(1.0);
    law.stated = law.amplitude;
    law.key = key_of(own, own.numbers[kFraction] ? "fraction" : "amount");
    if (form.form == Form::curve) {
        const bool both_ways = over == Argument::tilt || over == Argument::place;
        law.curve.reach = over == Argument::slip_speed ? FreeReach::anchored
                          : both_ways                  ? FreeReach::both_ways
                                                       : FreeReach::from_zero;
        law.curve.span = law.scale;
        for (std::size_t i = 0; i < kKnots; ++i) {
            law.curve.knots[i] = own.numbers[kKnot + i].value_or(0.0);
        }
    }
    return law;
}

void check_name(const OwnLaw& law) {
    const auto is_this = [&](const std::string& name) { return name == law.name; };
    bool is_effect = false;
    for (const EffectDescription& each : effects()) is_effect |= is_this(each.name);
    for (const UserEffectHandle& each : user_effects()) is_effect |= is_this(each->name);
    if (!is_effect) return;
    refuse("laws." + law.name + ": there is an effect of this name", "another name");
}

// A quantity below zero would drive what it is to brake, and kinetic friction above the static one
// has no meaning.
void check_signs(const Scenario& s) {
    const LawSet all(all_laws(s, {}));
    for (const OwnLaw& own : s.laws) {
        if (is_absent(own)) continue;
        const Law law = made(own);
        const Quantity quantity = law.kind.quantity;
        if (law.kind.acts == Acts::multiplies) {
            if (std::isfinite(law.lowest()) && 1.0 + law.lowest() < 0.0) {
                refuse(given(own, kFraction),
                       "one that leaves 1 + fraction * form at least 0 everywhere");
            }
        } else if (law.lowest() < 0.0) {
            const bool is_friction = quantity <= Quantity::friction_by_load;
            const double base = is_friction                      ? s.contact.kinetic_friction
                                : quantity == Quantity::adhesion ? s.contact.adhesion
                                : quantity == Quantity::drag
                                    ? s.drag.linear
                                    : s.effects.rotational_drag_coefficient;
            const double least = is_friction ? all.lowest(Quantity::sliding_friction,
                                                          Quantity::friction_by_load, base)
                                             : all.lowest(quantity, quantity, base);
            if (least < 0.0) {
                refuse(given(own, kAmount),
                       std::string("one that leaves ") + quantity_of(own).word + ", " +
                           digits(base) +
                           " without laws, at least 0 everywhere; a fraction ends there by itself");
            }
        }
        if (quantity != Quantity::sliding_friction) continue;
        double still = s.contact.kinetic_friction;
        for (const Law& each : all.laws()) {
            if (each.kind.quantity != quantity) continue;
            const bool adds = each.kind.acts == Acts::adds;
            still = adds ? still + each.at_zero() : still * std::max(1.0 + each.at_zero(), 0.0);
        }
        if (still > s.contact.static_friction * (1.0 + 1e-12)) {
            refuse(given(own, law.kind.acts == Acts::multiplies ? kFraction : kAmount),
                   "one with which kinetic friction at slip speed 0, " + digits(still) +
                       ", is not above static friction, " + digits(s.contact.static_friction));
        }
    }
}

template <class Laws>
auto place_of(Laws& laws, std::string_view name) {
    return std::lower_bound(
        laws.begin(), laws.end(), name,
        [](const OwnLaw& law, std::string_view word) { return law.name < word; });
}

OwnLaw& law_of(Scenario& scenario, const std::string& name) {
    auto place = place_of(scenario.laws, name);
    if (place == scenario.laws.end() || place->name != name) {
        place = scenario.laws.insert(place, OwnLaw{name, {}, {}});
    }
    return *place;
}

}  // namespace

const std::vector<LawKey>& law_keys() {
    constexpr double kLow = -kMost;
    static const std::vector<LawKey> table = {
        {"quantity", "what the law changes", kQuantity, words_of(kQuantityWords)},
        {"over", "the argument, on which it depends", kOver, words_of(kArgumentWords)},
        {"form", "f, the shape over u = argument / scale", kForm, words_of(kFormWords)},
        {"fraction",
         "a in: the quantity times max(0, 1 + a f(u))",
         kFraction,
         {},
         kLow,
         kMost,
         "-"},
        {"amount",
         "a in: the quantity plus a f(u), in the quantity's unit",
         kAmount,
         {},
         kLow,
         kMost},
        {"scale",
         "of the argument, in its unit; of a curve, the argument of its last knot",
         kScale,
         {},
         0.0,
         kMost,
         "SI",
         false},
        {"knot_1", "the curve at its first knot", kKnot, {}, kLow, kMost, "-"},
        {"knot_2", "the curve at its second knot", kKnot + 1, {}, kLow, kMost, "-"},
        {"knot_3", "the curve at its third knot", kKnot + 2, {}, kLow, kMost, "-"},
        {"knot_4", "the curve at its fourth knot", kKnot + 3, {}, kLow, kMost, "-"},
        {"knot_5", "the curve at its last knot and beyond", kKnot + 4, {}, kLow, kMost, "-"},
    };
    return table;
}

std::optional<LawPlace> find_law_key(std::string_view key) {
    constexpr std::string_view kSection = "laws.";
    if (!key.starts_with(kSection)) return std::nullopt;
    key.remove_prefix(kSection.size());
    const std::size_t dot = std::min(key.find('.'), key.size());
    const std::string_view name = key.substr(0, dot),
                           last = key.substr(std::min(dot + 1, key.size()));
    if (!is_word(name)) return std::nullopt;
    for (const LawKey& row : law_keys()) {
        if (last == row.name) return LawPlace{std::string(name), &row};
    }
    return std::nullopt;
}

void set_law(Scenario& scenario, const LawPlace& place, double value) {
    const LawKey& key = *place.key;
    const bool above = key.low_allowed ? value >= key.low : value > key.low;
    if (!key.words.empty())
        refuse(place.name() + " = " + digits(value), "one of " + listed(key.words));
    if (!(above && value <= key.high)) {
        refuse(place.name() + " = " + digits(value),
               std::string("a number ") + (key.low_allowed ? "from " : "above ") + digits(key.low) +
                   " to " + digits(key.high));
    }
    law_of(scenario, place.law).numbers[key.place] = value;
}

void set_law(Scenario& scenario, const LawPlace& place, std::string_view word) {
    const LawKey& key = *place.key;
    const std::string what = place.name() + " = \"" + std::string(word) + "\"";
    if (key.words.empty()) refuse(what, "a number");
    const auto found = std::find(key.words.begin(), key.words.end(), word);
    if (found == key.words.end()) refuse(what, "one of " + listed(key.words));
    const auto index = static_cast<std::size_t>(found - key.words.begin());
    law_of(scenario, place.law).words[key.place] = index;
}

void set_law_word(Scenario& scenario, const LawPlace& place, double index) {
    if (!(index >= 0.0 && index < static_cast<double>(place.key->words.size()))) {
        throw std::invalid_argument(place.name() + ": there is no word with this index");
    }
    law_of(scenario, place.law).words[place.key->place] = static_cast<std::size_t>(index);
}

void remove_law(Scenario& scenario, std::string_view name) {
    std::erase_if(scenario.laws, [&](const OwnLaw& law) { return law.name == name; });
}

const OwnLaw* find_law(const Scenario& scenario, std::string_view name) {
    const auto place = place_of(scenario.laws, name);
    return place != scenario.laws.end() && place->name == name ? &*place : nullptr;
}

void check_own_laws(const Scenario& scenario) {
    for (const OwnLaw& law : scenario.laws) {
        check_name(law);
        check_words(law);
        check_numbers(law);
    }
    if (!scenario.laws.empty()) check_signs(scenario);
}

std::optional<FreeShape> curve_of_law(const Scenario& scenario, std::string_view name) {
    const OwnLaw* law = find_law(scenario, name);
    if (law == nullptr || !is_complete(*law) || form_of(*law).form != Form::curve) {
        return std::nullopt;
    }
    return made(*law).curve;
}

std::vector<Law> own_laws(const Scenario& scenario) {
    std::vector<Law> result;
    for (const OwnLaw& law : scenario.laws) {
        if (is_complete(law) && !is_absent(law)) result.push_back(made(law));
    }
    return result;
}

}  // namespace stickslip
