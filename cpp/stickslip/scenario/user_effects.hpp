#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "stickslip/body/user_effect.hpp"

namespace stickslip {

/// Makes an effect known to all of this process, in place of one of the same name. Throws
/// std::invalid_argument, naming the effect, for a name that is the model's own or not a word, no
/// parameter, or a range that does not hold its absent value.
void register_user_effect(UserEffect effect);

/// Whether a name can be part of a key: letters, digits and _, no digit first.
bool is_word(std::string_view text);

/// Throws std::invalid_argument if there is none of that name.
void unregister_user_effect(std::string_view name);

/// All registered effects, in the order of registration.
std::vector<UserEffectHandle> user_effects();

/// Number of changes of the registered effects so far.
std::size_t registrations();

/// One parameter of a registered effect.
struct UserKey {
    UserEffectHandle effect;
    std::size_t parameter = 0;
};
std::optional<UserKey> find_user_key(std::string_view key);

}  // namespace stickslip
