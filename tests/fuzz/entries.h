#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace zoe::test {

/// What became of an input.
struct FuzzOutcome {
    bool is_accepted = false;  ///< It loaded; else it was refused in the way that the reader promises.
    std::string broken;        ///< A promise that was not kept, in words; empty where all were.
};

using FuzzBytes = std::span<const std::byte>;
using FuzzEntry = FuzzOutcome (*)(FuzzBytes bytes);

/// The readers, each fed with any bytes: what is refused is refused with one line that names the file; what loads is a
/// sound scene, whose frames can be made and traced. Other exceptions than the documented ones are reported as broken.

/// A .glb or .gltf file, beside which stand a picture `a.png` and a buffer `a.bin` of zeros.
FuzzOutcome fuzz_gltf(FuzzBytes bytes);

/// An encoded picture.
FuzzOutcome fuzz_image(FuzzBytes bytes);

/// A mesh sequence: one byte that tells how many files there are (modulo 3, and one more); before each but the last its
/// length in 4 bytes, least first. See `join_sequence`.
FuzzOutcome fuzz_sequence(FuzzBytes bytes);
std::string join_sequence(std::span<const std::string> files);

/// A tree on disk: one byte that tells which mesh's it is taken for (see `tree_seeds`) and, by its highest bit, whether
/// its checksum is made right first; then the file.
FuzzOutcome fuzz_tree_file(FuzzBytes bytes);
inline constexpr unsigned char kSealBit = 0x80;

/// What `fuzz_tree_file` accepts: the trees of a few meshes, by every builder that is kept on disk.
std::vector<std::string> tree_seeds();

}  // namespace zoe::test
