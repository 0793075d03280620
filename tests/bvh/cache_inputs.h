#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/bvh/cache.h"
#include "engine/bvh/tree_file.h"
#include "tests/bvh/inputs.h"
#include "tests/support/read_bytes.h"
#include "tests/support/same_bits.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {

/// A mesh with its tree and its key.
struct Planted {
    TestMesh mesh;
    BlasBuilder builder = BlasBuilder::kSweep;
    Blas blas;
    Hash128 key;

    explicit Planted(TestMesh planted, BlasBuilder with = BlasBuilder::kSweep) : mesh(std::move(planted)), builder(with) {
        build_blas(mesh.positions, mesh.corners, builder, &blas);
        key = tree_key(mesh.positions, mesh.corners, builder);
    }
    std::string file_name() const { return to_hex(key) + ".blas"; }
    bool load(TreeCache* cache, Blas* result) const { return cache->load(key, mesh.positions, mesh.corners, result); }
};

inline bool is_same(const Blas& a, const Blas& b) {
    return has_same_bits(a.tree.nodes, b.tree.nodes) && a.tree.level_ends == b.tree.level_ends &&
           has_same_bits(a.blocks, b.blocks) && a.triangle_count == b.triangle_count &&
           a.not_finite_count == b.not_finite_count && a.has_pieces == b.has_pieces;
}

inline size_t file_count(const std::filesystem::path& folder) {
    using Files = std::filesystem::directory_iterator;
    return static_cast<size_t>(std::distance(Files(folder), Files()));
}

/// How many warnings there were since the last call, and that each is about the folder.
inline uint64_t take_warning_count(TreeCache* cache) {
    uint64_t total = 0;
    for (const auto& [text, count] : cache->take_warnings()) total += text.starts_with("tree cache ") ? count : 1000;
    return total;
}

}  // namespace zoe::test
