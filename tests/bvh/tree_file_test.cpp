// What is in a tree's file: round trips, and files that are broken or lie.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "tests/bvh/cache_inputs.h"

namespace zoe::test {
namespace {

constexpr size_t kHeaderSize = 72, kChecksumOffset = 56, kCountsOffset = 24;

/// Gives a forged file the checksum that it should have.
void seal(std::string* file) {
    std::fill_n(file->begin() + kChecksumOffset, 16, '\0');
    const Hash128 hash = hash_bytes({std::as_bytes(std::span(*file))});
    std::memcpy(file->data() + kChecksumOffset, &hash, sizeof hash);
}

/// A file of the cache, to be broken and read again.
class TreeFile : public testing::Test {
protected:
    explicit TreeFile() {
        EXPECT_TRUE(cache.store(planted.key, planted.blas));
        whole = read_bytes(folder / planted.file_name());
        EXPECT_EQ(whole.size(), tree_file_size(planted.blas));
    }
    bool loads(const std::string& file) {
        folder.write(planted.file_name(), file);
        return planted.load(&cache, &loaded);
    }
    void expect_refused(const std::string& file) {
        loaded = {};
        loaded.triangle_count = 77;
        EXPECT_FALSE(loads(file));
        EXPECT_EQ(take_warning_count(&cache), 1u);
        EXPECT_EQ(loaded.triangle_count, 77u) << "the result was touched";
        EXPECT_TRUE(loaded.tree.nodes.empty());
    }

    const TempFolder folder;
    TreeCache cache{folder.path()};
    const Planted planted{random_soup(30, 2.0f, 91)};
    std::string whole;
    Blas loaded;
};

TEST(TreeKey, TellsInputsApart) {
    const TestMesh mesh = random_soup(20, 1.0f, 5);
    std::set<std::string> keys;
    size_t count = 0;
    const auto add = [&](const TestMesh& m, BlasBuilder builder) {
        keys.insert(to_hex(tree_key(m.positions, m.corners, builder)));
        ++count;
    };
    add(mesh, BlasBuilder::kSweep);
    add(mesh, BlasBuilder::kBinned);
    for (size_t k = 0; k < mesh.positions.size(); ++k) {
        TestMesh other = mesh;
        other.positions[k].y = std::bit_cast<float>(std::bit_cast<uint32_t>(other.positions[k].y) ^ 1u);
        add(other, BlasBuilder::kSweep);
    }
    for (size_t k = 0; k < mesh.corners.size(); ++k) {
        TestMesh other = mesh;
        std::swap(other.corners[k].x, other.corners[k].y);
        add(other, BlasBuilder::kSweep);
    }
    // The same bytes, divided in another way.
    TestMesh moved = mesh;
    moved.corners.insert(moved.corners.begin(), std::bit_cast<glm::uvec3>(moved.positions.back()));
    moved.positions.pop_back();
    add(moved, BlasBuilder::kSweep);
    add({"empty", {}, {}}, BlasBuilder::kSweep);
    EXPECT_EQ(keys.size(), count);
    EXPECT_EQ(tree_key(mesh.positions, mesh.corners, BlasBuilder::kSweep),
              tree_key(TestMesh(mesh).positions, mesh.corners, BlasBuilder::kSweep));
}

TEST(TreeKey, HashIsTheSameHoweverTheBytesAreDivided) {
    const std::string text = "a text that is longer than the hash's inner blocks " + std::string(5000, 'x');
    const auto bytes = std::as_bytes(std::span(text));
    for (const size_t at : {size_t{0}, size_t{1}, size_t{17}, size_t{1024}, text.size()}) {
        EXPECT_EQ(hash_bytes({bytes.first(at), bytes.subspan(at)}), hash_bytes({bytes})) << at;
    }
    EXPECT_EQ(to_hex({0x0123456789abcdefu, 0xfu}), "0123456789abcdef000000000000000f");
    EXPECT_EQ(to_hex(hash_bytes({})), "99aa06d3014798d86001c324468d497f") << "XXH3 of nothing, as its authors give it";
}

TEST(TreeFileRoundTrip, IsBitForBit) {
    std::vector<TestMesh> meshes = nasty_meshes();
    meshes.push_back(random_soup(20'000, 0.1f, 92));
    for (TestMesh& mesh : meshes) {
        for (const BlasBuilder builder : {BlasBuilder::kSweep, BlasBuilder::kBinned, BlasBuilder::kSbvh}) {
            SCOPED_TRACE(mesh.name);
            const TempFolder folder;
            TreeCache cache(folder.path());
            const Planted planted(mesh, builder);
            ASSERT_TRUE(cache.store(planted.key, planted.blas));
            EXPECT_EQ(std::filesystem::file_size(folder / planted.file_name()), tree_file_size(planted.blas));
            Blas loaded;
            loaded.triangle_count = 77;
            ASSERT_TRUE(planted.load(&cache, &loaded));
            EXPECT_TRUE(is_same(loaded, planted.blas));
            EXPECT_EQ(validate(loaded, mesh.positions, mesh.corners), "");
            EXPECT_EQ(take_warning_count(&cache), 0u);
        }
    }
}

TEST_F(TreeFile, CutShortIsRefused) {
    for (size_t size = 0; size < whole.size(); ++size) {
        SCOPED_TRACE(size);
        expect_refused(whole.substr(0, size));
    }
    EXPECT_TRUE(loads(whole));
    EXPECT_TRUE(is_same(loaded, planted.blas));
}

TEST_F(TreeFile, TooLongIsRefused) {
    expect_refused(whole + '\0');
    expect_refused(whole + whole);
}

TEST_F(TreeFile, EveryFlippedByteIsRefused) {
    for (size_t k = 0; k < whole.size(); ++k) {
        for (const unsigned mask : {1u << k % 8, 0xffu}) {
            SCOPED_TRACE(k);
            std::string file = whole;
            file[k] = static_cast<char>(static_cast<unsigned char>(file[k]) ^ mask);
            expect_refused(file);
        }
    }
}

TEST_F(TreeFile, GarbageIsRefused) {
    Rng rng(93);
    for (const size_t size : {size_t{1}, kHeaderSize - 1, kHeaderSize, kHeaderSize + 1, whole.size(), size_t{100'000}}) {
        std::string file(size, '\0');
        expect_refused(file);
        for (char& c : file) c = static_cast<char>(rng.next());
        expect_refused(file);
    }
}

TEST_F(TreeFile, AnotherMeshesTreeIsRefused) {
    const Planted other(random_soup(30, 2.0f, 94));
    ASSERT_TRUE(cache.store(other.key, other.blas));
    expect_refused(read_bytes(folder / other.file_name()));
}

TEST_F(TreeFile, CountsThatLieAreRefusedAndAllocateNothing) {
    for (size_t word = 0; word < 4; ++word) {
        for (const uint32_t count : {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
            SCOPED_TRACE(word);
            SCOPED_TRACE(count);
            std::string file = whole;
            std::memcpy(file.data() + kCountsOffset + 4 * word, &count, sizeof count);
            if (file == whole) continue;
            seal(&file);
            expect_refused(file);
        }
    }
}

// Small whole numbers, so that no processor or compiler rounds in another way. A file under a key is believed to be what
// the builder would make.
TEST(TreeFileVersion, IsRaisedWhenABuilderChangesItsTrees) {
    // The large one is built in parts, by all threads.
    const auto steps = [](int count) {
        TestMesh mesh{"steps", {}, {}};
        for (int k = 0; k < count; ++k) {
            const glm::vec3 corner(k % 17, k % 1000 * (k % 1000) % 23, k / 17);
            mesh.add(corner, corner + glm::vec3(1 + k % 3, 0, 0), corner + glm::vec3(0, k % 2, 2));
        }
        return mesh;
    };
    const TestMesh small = steps(300), large = steps(60'000);
    const auto hash_of = [](const TestMesh& mesh, BlasBuilder builder) {
        const TempFolder folder;
        TreeCache cache(folder.path());
        const Planted planted(mesh, builder);
        EXPECT_TRUE(cache.store(planted.key, planted.blas));
        const std::string file = read_bytes(folder / planted.file_name());
        return to_hex(hash_bytes({std::as_bytes(std::span(file)).subspan(kHeaderSize)}));
    };
    const char* const what = "another tree than before: raise kVersion in tree_file.cpp, and put the new hash here";
    EXPECT_EQ(hash_of(small, BlasBuilder::kBinned), "1c8b88a503b5c322fe2b6b3bac88c44c") << what;
    EXPECT_EQ(hash_of(small, BlasBuilder::kSweep), "e3ebf75c0888b55a640d3e5abc934b35") << what;
    EXPECT_EQ(hash_of(small, BlasBuilder::kReinserted), "524f2f17919d38d3ba20787b93b0e70f") << what;
    EXPECT_EQ(hash_of(small, BlasBuilder::kSbvh), "8f96a3a958b947a03338bff68b988fec") << what;
    EXPECT_EQ(hash_of(large, BlasBuilder::kBinned), "44354669b39e81b1dec24b04ac359242") << what;
    EXPECT_EQ(hash_of(large, BlasBuilder::kSweep), "f4e2c9313d686ce36599278e41a2861c") << what;
    EXPECT_EQ(hash_of(large, BlasBuilder::kReinserted), "6bbd4f66db96f3f1a693de0c726432fe") << what;
    EXPECT_EQ(hash_of(large, BlasBuilder::kSbvh), "0fd09889faca1462056f0b0294ee6f67") << what;
}

// The checksum is right, and what it guards is not: whatever is accepted, rays stay inside.
TEST_F(TreeFile, ForgedTreesAreRefusedOrHarmless) {
    const uint64_t seed = 95;
    Rng rng(seed);
    const std::vector<Ray> rays = rays_at(planted.mesh, 200, seed);
    std::vector<BlasHit> expected;
    for (const Ray& ray : rays) expected.push_back(brute_force(planted.mesh, ray));
    const size_t word_count = (whole.size() - kHeaderSize) / 4;
    int refused_count = 0;
    constexpr int kTries = 4000;
    for (int k = 0; k < kTries; ++k) {
        SCOPED_TRACE("seed " + std::to_string(seed) + " try " + std::to_string(k));
        std::string file = whole;
        const size_t change_count = 1 + rng.next() % 3;
        for (size_t change = 0; change < change_count; ++change) {
            const size_t at = kHeaderSize + 4 * (rng.next() % word_count);
            const uint32_t likely[] = {0u, 1u, 2u, 30u, 31u, 0x7f800000u, 0x7fc00000u, kLeafBit, kEmptyChild};
            uint32_t word = static_cast<uint32_t>(rng.next());
            if (rng.next() % 2 == 0) word = likely[rng.next() % std::size(likely)];
            if (rng.next() % 4 == 0) std::memcpy(&word, whole.data() + kHeaderSize + 4 * (rng.next() % word_count), 4);
            std::memcpy(file.data() + at, &word, sizeof word);
        }
        seal(&file);
        if (!loads(file)) {
            ++refused_count;
            continue;
        }
        for (size_t r = 0; r < rays.size(); ++r) {
            const BlasHit hit = closest_hit(loaded, rays[r]);
            const bool is_any = any_hit(loaded, rays[r]);
            EXPECT_TRUE(hit.primitive == kEmptyChild || hit.primitive < planted.mesh.corners.size());
            if (loaded.has_pieces) continue;  // Pieces are believed.
            ASSERT_TRUE(is_same(hit, expected[r])) << to_string(hit) << ", expected " << to_string(expected[r]);
            ASSERT_EQ(is_any, expected[r].primitive != kEmptyChild);
        }
    }
    EXPECT_GT(refused_count, kTries / 10);
    EXPECT_LT(refused_count, kTries);
    EXPECT_EQ(take_warning_count(&cache), static_cast<uint64_t>(refused_count));
}

TEST_F(TreeFile, LeavesThatDoNotHoldTheirTrianglesAreRefused) {
    WideNode node;
    std::memcpy(&node, whole.data() + kHeaderSize, sizeof node);
    const auto slot = static_cast<int>(
        std::ranges::find_if(node.child, [](uint32_t c) { return c != kEmptyChild && is_leaf(c); }) - node.child);
    ASSERT_LT(slot, kWidth);
    ASSERT_NE(node.child[slot], kEmptyChild);
    const Aabb box = node.box(slot);
    const auto forged = [&](const Aabb& smaller) {
        WideNode changed = node;
        changed.set_box(slot, smaller);
        std::string file = whole;
        std::memcpy(file.data() + kHeaderSize, &changed, sizeof changed);
        seal(&file);
        return file;
    };
    ASSERT_TRUE(loads(forged(box)));
    EXPECT_TRUE(loads(forged({box.lo - 1.0f, box.hi + 1.0f}))) << "large boxes cost time only";
    for (int axis = 0; axis < 3; ++axis) {
        for (const float way : {-1.0f, 1.0f}) {
            Aabb smaller = box;
            float& plane = (way > 0.0f ? smaller.lo : smaller.hi)[axis];
            plane = std::nextafter(plane, way * std::numeric_limits<float>::infinity());
            expect_refused(forged(smaller));
            plane = NAN;
            expect_refused(forged(smaller));
        }
    }
}

// A slot without a child whose box a ray would enter: NaN planes do not limit it.
TEST(TreeFileSlots, WithoutAChildHoldNothingToTheBit) {
    const TestMesh mesh = random_soup(300, 0.1f, 96);
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSbvh, &blas);
    ASSERT_EQ(validate(blas.tree, blas.blocks.size()), "");
    for (const float plane : {NAN, 0.0f}) {
        WideBvh forged = blas.tree;
        bool is_forged = false;
        for (WideNode& node : forged.nodes) {
            for (int slot = 0; slot < kWidth && !is_forged; ++slot) {
                if (node.child[slot] != kEmptyChild) continue;
                for (int row = 0; row < 6; ++row) node.planes[row][slot] = row % 2 ? std::nextafter(plane, -1.0f) : plane;
                is_forged = true;
            }
        }
        ASSERT_TRUE(is_forged);
        EXPECT_NE(validate(forged, blas.blocks.size()), "") << plane;
    }
}

}  // namespace
}  // namespace zoe::test
