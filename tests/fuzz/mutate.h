#pragma once

#include <span>
#include <string>

#include "engine/math/rng.h"

namespace zoe::test {

// Changes that break files in the ways that files are broken. Each takes all that it decides from `rng`.

/// A few changes that know nothing of the format: bits, bytes, words, what is cut off, left out, repeated, or taken from
/// another file.
/// others     at least one.
void mutate_bytes(std::string& bytes, std::span<const std::string> others, Rng& rng);

/// A .glb or .gltf whose JSON has other numbers, strings, members, elements and nestings, or whose buffer has other
/// words; the lengths of its chunks are right again after it, mostly.
void mutate_gltf(std::string& file, std::span<const std::string> others, Rng& rng);

/// A PNG with changes inside its chunks, or with chunks left out, repeated or moved; checksums are right again after it,
/// mostly. Other pictures: as bytes.
void mutate_image(std::string& file, std::span<const std::string> others, Rng& rng);

/// What `fuzz_sequence` takes, one of its files changed as glTF is, or the whole as bytes.
void mutate_sequence(std::string& files, std::span<const std::string> others, Rng& rng);

/// What `fuzz_tree_file` takes, with words of the file changed.
void mutate_tree(std::string& file, std::span<const std::string> others, Rng& rng);

/// Picks one of several things.
template <typename List>
const auto& pick(const List& list, Rng& rng) {
    return list[rng.below(static_cast<uint32_t>(std::size(list)))];
}

/// A position in a text that is not empty.
inline size_t position_in(const std::string& text, Rng& rng) {
    return rng.below(static_cast<uint32_t>(text.size()));
}

}  // namespace zoe::test
