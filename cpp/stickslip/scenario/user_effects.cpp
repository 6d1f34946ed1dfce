#include "stickslip/scenario/user_effects.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "stickslip/scenario/parameters.hpp"

namespace stickslip {
namespace {

struct Registry {
    std::mutex mutex;
    std::vector<UserEffectHandle> effects;
    std::size_t changes = 0;
};

Registry& registry() {
    static Registry instance;
    return instance;
}

auto find_in(std::vector<UserEffectHandle>& effects, std::string_view name) {
    return std::find_if(effects.begin(), effects.end(),
                        [name](const UserEffectHandle& each) { return each->name == name; });
}

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
    throw std::invalid_argument("effect " + what + ": " + why);
}

void check(const UserEffect& effect) {
    constexpr const char* kWord = "allowed is a word of letters, digits and _";
    if (!is_word(effect.name)) refuse("\"" + effect.name + "\"", kWord);
    for (const EffectDescription& each : effects()) {
        if (effect.name == each.name) refuse(effect.name, "the model has one of this name itself");
    }
    if (effect.parameters.empty()) {
        refuse(effect.name, "needs a parameter, whose default makes it absent");
    }
    if (!effect.function) refuse(effect.name, "needs a function");
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
        const UserParameter& p = effect.parameters[i];
        const std::string what = effect.name + ", parameter \"" + p.name + "\"";
        if (!is_word(p.name)) refuse(what, kWord);
        for (std::size_t j = 0; j < i; ++j) {
            if (effect.parameters[j].name == p.name) refuse(what, "is given twice");
        }
        const bool finite = std::isfinite(p.low) && std::isfinite(p.high) && p.low < p.high;
        if (!finite) refuse(what, "its range needs finite ends, the low below the high");
        if (!(p.absent >= p.low && p.absent <= p.high)) {
            refuse(what, "its default is outside its range");
        }
    }
}

}  // namespace

bool is_word(std::string_view text) {
    // Not std::isalpha, which depends on the locale: the word is a key of a file.
    const auto letter = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    };
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    return !text.empty() && !digit(text.front()) &&
           std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || digit(c); });
}

void register_user_effect(UserEffect effect) {
    check(effect);
    auto handle = std::make_shared<const UserEffect>(std::move(effect));
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    ++all.changes;
    const auto found = find_in(all.effects, handle->name);
    // The replaced effect is destroyed after the lock: that may wait for others to be freed.
    if (found == all.effects.end()) {
        all.effects.push_back(std::move(handle));
    } else {
        found->swap(handle);
    }
}

void unregister_user_effect(std::string_view name) {
    // Destroyed after the lock, which may wait for others to be freed.
    UserEffectHandle gone;
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    const auto found = find_in(all.effects, name);
    if (found == all.effects.end()) refuse(std::string(name), "is not registered");
    ++all.changes;
    gone = std::move(*found);
    all.effects.erase(found);
}

std::vector<UserEffectHandle> user_effects() {
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    return all.effects;
}

std::size_t registrations() {
    Registry& all = registry();
    const std::lock_guard lock(all.mutex);
    return all.changes;
}

std::optional<UserKey> find_user_key(std::string_view key) {
    for (const UserEffectHandle& effect : user_effects()) {
        for (std::size_t i = 0; i < effect->parameters.size(); ++i) {
            if (effect->key(i) == key) return UserKey{effect, i};
        }
    }
    return std::nullopt;
}

}  // namespace stickslip
