#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace zoe {

/// 128 bits that tell contents apart: no two different ones have the same, for all that happens by chance.
struct Hash128 {
    uint64_t high = 0, low = 0;

    friend bool operator==(const Hash128&, const Hash128&) = default;
};

/// Hashes pieces of memory as if they stood one after another. The same on every processor; not against forgers.
/// Cost       O(bytes), at about the speed of memory; one thread.
/// Source     Collet. XXH3 (xxHash 0.8).
Hash128 hash_bytes(std::initializer_list<std::span<const std::byte>> pieces);

/// 32 digits, lower case.
std::string to_hex(const Hash128& hash);

}  // namespace zoe
