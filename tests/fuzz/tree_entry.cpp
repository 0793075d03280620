#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "engine/bvh/blas.h"
#include "engine/bvh/hash.h"
#include "engine/bvh/traverse.h"
#include "engine/bvh/tree_file.h"
#include "engine/math/rng.h"
#include "tests/fuzz/entries.h"
#include "tests/fuzz/files.h"

namespace zoe::test {
namespace {

constexpr size_t kChecksumOffset = 56, kHeaderSize = 72;
constexpr BlasBuilder kKeptBuilders[] = {BlasBuilder::kSweep, BlasBuilder::kReinserted, BlasBuilder::kSbvh};

/// A mesh, its tree, and rays with what they hit.
struct Known {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> corners;
    Hash128 key;
    std::string file;
    std::vector<Ray> rays;
    std::vector<BlasHit> hits;
};

BlasHit closest_hit(const Blas& blas, const Ray& ray) {
    BlasHit hit;
    hit.t = ray.t_max;
    return zoe::closest_hit(blas, RayFrame(ray), 0.0f, ray.t_min, &hit, nullptr) ? hit : BlasHit{};
}

/// A descriptor of a file in memory.
int memory_file() {
    static const int descriptor = memfd_create("tree", MFD_CLOEXEC);
    return descriptor;
}

Known make_known(int triangle_count, float size, BlasBuilder builder, uint64_t seed) {
    Known known;
    Rng rng(seed);
    const auto random = [&](float most) {
        return glm::vec3(rng.uniform(-most, most), rng.uniform(-most, most), rng.uniform(-most, most));
    };
    for (int k = 0; k < triangle_count; ++k) {
        const glm::vec3 place = random(2.0f);
        const uint32_t first = static_cast<uint32_t>(known.positions.size());
        for (int corner = 0; corner < 3; ++corner) known.positions.push_back(place + random(size));
        known.corners.push_back({first, first + 1, first + 2});
    }
    Blas blas;
    build_blas(known.positions, known.corners, builder, &blas);
    known.key = tree_key(known.positions, known.corners, builder);
    for (int k = 0; k < 16; ++k) {
        const glm::vec3 origin = random(4.0f);
        known.rays.push_back({origin, random(1.5f) - origin});
        known.hits.push_back(closest_hit(blas, known.rays.back()));
    }
    const int file = memory_file();
    if (ftruncate(file, 0) != 0 || lseek(file, 0, SEEK_SET) != 0) return known;
    if (!write_tree(file, known.key, blas).empty()) return known;
    known.file.resize(tree_file_size(blas));
    if (pread(file, known.file.data(), known.file.size(), 0) != static_cast<ssize_t>(known.file.size())) known.file.clear();
    return known;
}

const std::vector<Known>& known_trees() {
    static const std::vector<Known> known = [] {
        std::vector<Known> made;
        for (const BlasBuilder builder : kKeptBuilders) {
            made.push_back(make_known(1, 1.0f, builder, 31));
            made.push_back(make_known(40, 0.4f, builder, 32));
            made.push_back(make_known(120, 2.0f, builder, 33));  // Large triangles: spatial splits.
        }
        return made;
    }();
    return known;
}

bool is_same_hit(const BlasHit& a, const BlasHit& b) {
    return a.primitive == b.primitive && (a.primitive == kEmptyChild || (a.t == b.t && a.u == b.u && a.v == b.v));
}

std::string fault_of(const Blas& blas, const Known& known) {
    for (size_t k = 0; k < known.rays.size(); ++k) {
        const BlasHit hit = closest_hit(blas, known.rays[k]);
        const bool is_any = any_hit(blas, RayFrame(known.rays[k]), 0.0f, known.rays[k].t_min, known.rays[k].t_max, nullptr);
        if (hit.primitive != kEmptyChild && hit.primitive >= known.corners.size()) {
            return fmt::format("a hit of triangle {} of {}", hit.primitive, known.corners.size());
        }
        if (blas.has_pieces) continue;  // Which pieces bound a triangle is believed: rays may miss it, and nothing else.
        if (!is_same_hit(hit, known.hits[k])) {
            return fmt::format("ray {} hits triangle {} at {}, not {} at {}", k, hit.primitive, hit.t,
                               known.hits[k].primitive, known.hits[k].t);
        }
        if (is_any != (known.hits[k].primitive != kEmptyChild)) return fmt::format("ray {}: any_hit is wrong", k);
    }
    return "";
}

void seal(std::string* file) {
    if (file->size() < kHeaderSize) return;
    std::fill_n(file->begin() + kChecksumOffset, 16, '\0');
    const Hash128 hash = hash_bytes({as_bytes(*file)});
    std::memcpy(file->data() + kChecksumOffset, &hash, sizeof hash);
}

}  // namespace

FuzzOutcome fuzz_tree_file(FuzzBytes bytes) {
    if (bytes.empty()) return {};
    const unsigned char how = std::to_integer<unsigned char>(bytes[0]);
    const Known& known = known_trees()[how % kSealBit % known_trees().size()];
    std::string text(reinterpret_cast<const char*>(bytes.data()) + 1, bytes.size() - 1);
    if ((how & kSealBit) != 0) seal(&text);
    const int file = memory_file();
    if (ftruncate(file, 0) != 0 || pwrite(file, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
        lseek(file, 0, SEEK_SET) != 0) {
        return {false, "the file in memory cannot be written"};
    }
    FuzzOutcome outcome;
    Blas blas;
    try {
        outcome.is_accepted = read_tree(file, known.key, known.positions, known.corners, &blas).empty();
        if (outcome.is_accepted) outcome.broken = fault_of(blas, known);
        if (!outcome.is_accepted && !blas.tree.nodes.empty()) outcome.broken = "refused, and yet the result was touched";
    } catch (const std::exception& exception) {
        outcome.broken = std::string("an exception: ") + exception.what();
    }
    return outcome;
}

std::vector<std::string> tree_seeds() {
    std::vector<std::string> seeds;
    for (size_t k = 0; k < known_trees().size(); ++k) {
        seeds.push_back(std::string(1, static_cast<char>(k)) + known_trees()[k].file);
    }
    return seeds;
}

}  // namespace zoe::test
