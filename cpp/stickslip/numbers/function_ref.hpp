#pragma once

#include <concepts>
#include <memory>
#include <type_traits>

namespace stickslip {

template <class Signature>
class FunctionRef;

/// A function that somebody else keeps. What takes one is compiled once, not again for each
/// function: for searches, whose functions cost far more than the call.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
public:
    template <class Function>
    requires(!std::same_as<std::remove_cvref_t<Function>, FunctionRef>)
        FunctionRef(const Function& function)
        : function_(std::addressof(function)),
          call_([](const void* kept, Arguments... arguments) -> Result {
              return (*static_cast<const Function*>(kept))(arguments...);
          }) {}

    Result operator()(Arguments... arguments) const { return call_(function_, arguments...); }

private:
    const void* function_;
    Result (*call_)(const void*, Arguments...);
};

}  // namespace stickslip
