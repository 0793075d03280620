#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/bvh/blas.h"
#include "engine/bvh/hash.h"

namespace zoe {

/// A BLAS as a file: a header, then the nodes, the levels, and which triangles stand in which block. The triangles' corners
/// are not in it: what is read back holds the mesh's own, whatever the file says, and the file has a quarter of the tree's
/// bytes. See tree_file.cpp for the layout.

/// What a tree is known by: the mesh's numbers to the last bit, the builder, its settings, and the file's version.
/// Cost       O(vertices + triangles), at about the speed of memory.
Hash128 tree_key(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder);

/// Bytes of the tree's file.
uint64_t tree_file_size(const Blas& blas);

/// Writes a tree.
/// file       a descriptor, at the file's beginning.
/// Returns    what went wrong in words, empty when nothing did.
std::string write_tree(int file, const Hash128& key, const Blas& blas);

/// Reads a tree that `write_tree` wrote, on this kind of machine, under this key. Whatever the file holds, a tree that is
/// accepted has links, levels, blocks and triangles that all exist, each triangle in at least one leaf, and in that leaf's
/// box where it stands in no other: no ray leaves it, its memory is bounded by the mesh, and hits are right. Only which
/// pieces of a triangle in several leaves these bound is believed: whoever forges that, checksum and all, makes rays miss
/// such triangles.
/// file       a descriptor of anything, at its beginning.
/// positions, corners   of the mesh that the key was made of.
/// blas       result; left as it is where something is wrong.
/// Returns    what is wrong with the file in words, empty when nothing is.
/// Cost       O(file), read straight to where rays will walk. A mapped file's pages would be small, and gone with a signal
///            where someone else cuts it short.
std::string read_tree(int file, const Hash128& key, std::span<const glm::vec3> positions,
                      std::span<const glm::uvec3> corners, Blas* blas);

}  // namespace zoe
