#include "engine/bvh/tree_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

// Raise it when the layout changes, or what a builder makes of the same settings.
constexpr uint32_t kVersion = 2;
constexpr char kMagic[8] = {'Z', 'O', 'E', 'T', 'R', 'E', 'E', '\n'};
constexpr uint32_t kByteOrder = 0x01020304;

// The file: this, WideNode[node_count], uint32_t level_ends[level_count], uint32_t primitive[block_count * block_size].
struct Header {
    char magic[8];
    uint32_t byte_order, version, node_bytes, block_size;
    uint32_t triangle_count, node_count, level_count, block_count;
    Hash128 key;
    Hash128 checksum;  // Of the whole file, with zeros here.
};
static_assert(sizeof(Header) == 72 && std::is_trivially_copyable_v<Header> && std::is_trivially_copyable_v<WideNode>);

// Spatial splits put a triangle into several leaves; no builder makes more than so many blocks a triangle. A bound on what
// a file may make its reader allocate.
constexpr uint64_t kMaxBlocksATriangle = 4;

constexpr size_t kNodeGrain = 256;

// A row of a block in a register, on any processor.
using Float4 = float __attribute__((vector_size(sizeof(float) * TriangleBlock::kSize)));
using Int4 = int32_t __attribute__((vector_size(sizeof(float) * TriangleBlock::kSize)));

Header header_of(const Blas& blas, const Hash128& key) {
    Header header{};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.byte_order = kByteOrder;
    header.version = kVersion;
    header.node_bytes = sizeof(WideNode);
    header.block_size = TriangleBlock::kSize;
    header.triangle_count = blas.triangle_count;
    header.node_count = static_cast<uint32_t>(blas.tree.nodes.size());
    header.level_count = static_cast<uint32_t>(blas.tree.level_ends.size());
    header.block_count = static_cast<uint32_t>(blas.blocks.size());
    header.key = key;
    return header;
}

uint64_t file_size(const Header& header) {
    return sizeof(Header) + uint64_t{header.node_count} * sizeof(WideNode) +
           uint64_t{header.level_count} * sizeof(uint32_t) +
           uint64_t{header.block_count} * TriangleBlock::kSize * sizeof(uint32_t);
}

// Every block holds a triangle, every node a child that holds a block.
bool are_counts_possible(const Header& header) {
    return header.block_count <= kMaxBlocksATriangle * header.triangle_count && header.node_count <= header.block_count &&
           header.level_count <= header.node_count;
}

// What the file holds beside the header.
struct Body {
    std::span<const WideNode> nodes;
    std::span<const uint32_t> level_ends, primitives;
};

Hash128 checksum(Header header, const Body& body) {
    header.checksum = {};
    return hash_bytes({std::as_bytes(std::span(&header, 1)), std::as_bytes(body.nodes), std::as_bytes(body.level_ends),
                       std::as_bytes(body.primitives)});
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

std::string write_all(int file, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return reason(errno);
        if (written == 0) return "nothing can be written";
        bytes = bytes.subspan(static_cast<size_t>(written));
    }
    return "";
}

std::string read_all(int file, std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = read(file, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return reason(errno);
        if (count == 0) return "is cut short";
        bytes = bytes.subspan(static_cast<size_t>(count));
    }
    return "";
}

std::string find_fault(const Header& header, const Hash128& key, size_t triangle_count, uint64_t size) {
    if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) return "is not a tree";
    if (header.byte_order != kByteOrder) return "was written by another kind of machine";
    if (header.version != kVersion || header.node_bytes != sizeof(WideNode) || header.block_size != TriangleBlock::kSize) {
        return "was written by another version";
    }
    if (header.key != key || header.triangle_count != triangle_count) return "is another mesh's tree";
    if (!are_counts_possible(header)) return "has counts that no tree has";
    if (size != file_size(header)) return size < file_size(header) ? "is cut short" : "is too long";
    return "";
}

// leaf_counts    result: [triangle_count] how many slots hold a triangle; 2 stands for more, too.
std::string find_fault(const WideBvh& tree, std::span<const uint32_t> primitives, std::span<uint8_t> leaf_counts) {
    if (const std::string problem = validate(tree, primitives.size() / TriangleBlock::kSize); !problem.empty()) {
        return "holds no valid tree (" + problem + ")";
    }
    size_t seen_count = 0;
    for (const uint32_t primitive : primitives) {
        if (primitive == kEmptyChild) continue;
        if (primitive >= leaf_counts.size()) return "holds no valid tree (a triangle out of range)";
        seen_count += leaf_counts[primitive] == 0;
        leaf_counts[primitive] = std::min(leaf_counts[primitive] + 1, 2);
    }
    return seen_count == leaf_counts.size() ? "" : "holds no valid tree (a triangle is in no leaf)";
}

// Whether a triangle that stands in one leaf only reaches out of it. A corner that is NaN does not.
bool reaches_out(const TriangleBlock& block, const Aabb& leaf, std::span<const uint8_t> leaf_counts) {
    Int4 is_outside{};
    for (int row = 0; row < 9; ++row) {
        Float4 x;
        std::memcpy(&x, block.corners[row], sizeof x);
        is_outside |= (x < leaf.lo[row % 3]) | (x > leaf.hi[row % 3]);
    }
    for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
        if (is_outside[slot] != 0 && leaf_counts[block.primitive[slot]] == 1) return true;
    }
    return false;
}

// Of boxes that are smaller than what is in them, rays would miss that.
std::string find_fault(const Blas& blas, std::span<const uint8_t> leaf_counts) {
    std::atomic<bool> is_faulty{false};
    parallel_for(0, blas.tree.nodes.size(), kNodeGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const WideNode& node = blas.tree.nodes[k];
            for (int slot = 0; slot < kWidth; ++slot) {
                const uint32_t child = node.child[slot];
                if (child == kEmptyChild || !is_leaf(child)) continue;
                const Aabb leaf = node.box(slot);
                if (!(leaf.lo == leaf.lo && leaf.hi == leaf.hi)) is_faulty = true;  // NaN: bounds nothing.
                for (uint32_t block = 0; block < block_count(child); ++block) {
                    if (reaches_out(blas.blocks[first_block(child) + block], leaf, leaf_counts)) is_faulty = true;
                }
            }
        }
    });
    return is_faulty ? "holds no valid tree (a triangle reaches out of its leaf)" : "";
}

}  // namespace

Hash128 tree_key(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasBuilder builder) {
    const std::string how = settings(builder);
    const uint64_t sizes[] = {kVersion, how.size(), positions.size(), corners.size()};
    return hash_bytes(
        {std::as_bytes(std::span(sizes)), std::as_bytes(std::span(how)), std::as_bytes(positions), std::as_bytes(corners)});
}

uint64_t tree_file_size(const Blas& blas) {
    return file_size(header_of(blas, {}));
}

std::string write_tree(int file, const Hash128& key, const Blas& blas) {
    std::vector<uint32_t> primitives;
    primitives.reserve(blas.blocks.size() * TriangleBlock::kSize);
    for (const TriangleBlock& block : blas.blocks) {
        primitives.insert(primitives.end(), std::begin(block.primitive), std::end(block.primitive));
    }
    const Body body{blas.tree.nodes, blas.tree.level_ends, primitives};
    Header header = header_of(blas, key);
    if (!are_counts_possible(header)) return "the tree holds its triangles too many times";
    header.checksum = checksum(header, body);
    for (const std::span<const std::byte> bytes : {std::as_bytes(std::span(&header, 1)), std::as_bytes(body.nodes),
                                                   std::as_bytes(body.level_ends), std::as_bytes(body.primitives)}) {
        if (const std::string problem = write_all(file, bytes); !problem.empty()) return problem;
    }
    return "";
}

std::string read_tree(int file, const Hash128& key, std::span<const glm::vec3> positions,
                      std::span<const glm::uvec3> corners, Blas* blas) {
    struct stat status;
    if (fstat(file, &status) != 0) return reason(errno);
    if (!S_ISREG(status.st_mode)) return "is not a file";
    Header header;
    if (const std::string problem = read_all(file, std::as_writable_bytes(std::span(&header, 1))); !problem.empty()) {
        return problem;
    }
    if (const std::string fault = find_fault(header, key, corners.size(), static_cast<uint64_t>(status.st_size));
        !fault.empty()) {
        return fault;
    }

    Blas made;
    made.tree.nodes.resize(header.node_count);
    made.tree.level_ends.resize(header.level_count);
    std::vector<uint32_t> primitives(size_t{header.block_count} * TriangleBlock::kSize);
    for (const std::span<std::byte> bytes :
         {std::as_writable_bytes(std::span(made.tree.nodes)), std::as_writable_bytes(std::span(made.tree.level_ends)),
          std::as_writable_bytes(std::span(primitives))}) {
        if (const std::string problem = read_all(file, bytes); !problem.empty()) return problem;
    }
    if (header.checksum != checksum(header, {made.tree.nodes, made.tree.level_ends, primitives})) {
        return "is damaged: its checksum is wrong";
    }
    std::vector<uint8_t> leaf_counts(corners.size());
    if (const std::string fault = find_fault(made.tree, primitives, leaf_counts); !fault.empty()) return fault;

    fill_blocks(primitives, positions, corners, &made);
    if (const std::string fault = find_fault(made, leaf_counts); !fault.empty()) return fault;
    *blas = std::move(made);
    return "";
}

}  // namespace zoe
