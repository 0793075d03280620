#include "engine/bvh/hash.h"

#include <cinttypes>
#include <cstdio>

// The library's own code, compiled here: nothing to link, and nothing that its users see.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace zoe {

Hash128 hash_bytes(std::initializer_list<std::span<const std::byte>> pieces) {
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_128bits_reset(&state);
    for (const std::span<const std::byte> piece : pieces) XXH3_128bits_update(&state, piece.data(), piece.size());
    const XXH128_hash_t hash = XXH3_128bits_digest(&state);
    return {hash.high64, hash.low64};
}

std::string to_hex(const Hash128& hash) {
    char text[33];
    std::snprintf(text, sizeof text, "%016" PRIx64 "%016" PRIx64, hash.high, hash.low);
    return text;
}

}  // namespace zoe
