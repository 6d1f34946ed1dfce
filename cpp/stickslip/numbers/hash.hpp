#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

namespace stickslip {

/// FNV-1a.
class Hash {
public:
    void add(const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t i = 0; i < size; ++i) {
            value_ = (value_ ^ bytes[i]) * 0x100000001b3ULL;
        }
    }
    void add(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        add(&bits, sizeof bits);
    }
    void add(const std::string& text) { add(text.data(), text.size() + 1); }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace stickslip
