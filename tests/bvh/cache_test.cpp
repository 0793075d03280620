// The folder: what is kept in it, what goes, and whose files stay. What may be wrong with it: cache_trouble_test.cpp; with a
// file: tree_file_test.cpp.

#include "engine/bvh/cache.h"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "tests/bvh/cache_inputs.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

std::vector<Planted> some_trees(int count) {
    std::vector<Planted> trees;
    for (int k = 0; k < count; ++k) trees.emplace_back(random_soup(40, 1.0f, 200 + k));
    return trees;
}

void make_older(const fs::path& file, std::chrono::minutes age) {
    fs::last_write_time(file, fs::file_time_type::clock::now() - age);
}

/// Sets an environment variable, or leaves it out, for a while.
class Variable {
public:
    Variable(const char* name, const char* value) : name_(name) {
        if (const char* const was = std::getenv(name)) was_ = was;
        value ? setenv(name, value, 1) : unsetenv(name);
    }
    ~Variable() { was_ ? setenv(name_, was_->c_str(), 1) : unsetenv(name_); }

private:
    const char* name_;
    std::optional<std::string> was_;
};

TEST(TreeCache, MissingTreeIsNoWarning) {
    const TempFolder folder;
    const Planted planted(random_soup(10, 1.0f, 1));
    for (const fs::path& path : {folder.path(), folder / "not/there"}) {
        TreeCache cache(path);
        Blas loaded;
        EXPECT_FALSE(planted.load(&cache, &loaded));
        EXPECT_EQ(take_warning_count(&cache), 0u);
    }
    EXPECT_FALSE(fs::exists(folder / "not")) << "asking makes no folder";
}

TEST(TreeCache, FolderIsMadeWithTheFirstTree) {
    const TempFolder folder;
    const Planted planted(random_soup(10, 1.0f, 2));
    TreeCache cache(folder / "not/there");
    ASSERT_TRUE(cache.store(planted.key, planted.blas));
    Blas loaded;
    EXPECT_TRUE(planted.load(&cache, &loaded));
    EXPECT_TRUE(is_same(loaded, planted.blas));
    EXPECT_EQ(file_count(folder / "not/there"), 1u);
}

TEST(TreeCache, BrokenFileIsReplaced) {
    const TempFolder folder;
    const Planted planted(random_soup(10, 1.0f, 3));
    TreeCache cache(folder.path());
    folder.write(planted.file_name(), "broken");
    Blas loaded;
    EXPECT_FALSE(planted.load(&cache, &loaded));
    EXPECT_EQ(take_warning_count(&cache), 1u);
    ASSERT_TRUE(cache.store(planted.key, planted.blas));
    EXPECT_TRUE(planted.load(&cache, &loaded));
    EXPECT_EQ(take_warning_count(&cache), 0u);
}

TEST(TreeCache, TreeBeyondTheLimitIsNotKept) {
    const TempFolder folder;
    const Planted small(random_soup(10, 1.0f, 9)), large(random_soup(400, 1.0f, 10));
    TreeCache cache(folder.path(), tree_file_size(large.blas) - 1);
    EXPECT_FALSE(cache.store(large.key, large.blas));
    EXPECT_EQ(take_warning_count(&cache), 1u);
    EXPECT_TRUE(cache.store(small.key, small.blas)) << "others still are";
    EXPECT_EQ(take_warning_count(&cache), 0u);
}

TEST(TreeCache, FilesNotUsedForLongestGoFirst) {
    const TempFolder folder;
    const std::vector<Planted> trees = some_trees(8);
    uint64_t largest = 0;
    for (const Planted& tree : trees) largest = std::max(largest, tree_file_size(tree.blas));
    TreeCache cache(folder.path(), 4 * largest + largest / 2);
    for (int k = 0; k < 4; ++k) {
        ASSERT_TRUE(cache.store(trees[k].key, trees[k].blas));
        make_older(folder / trees[k].file_name(), std::chrono::minutes(100 - k));
    }
    Blas loaded;
    EXPECT_TRUE(trees[0].load(&cache, &loaded)) << "used: now the youngest";
    const auto is_kept = [&](int k) { return fs::exists(folder / trees[k].file_name()); };
    ASSERT_TRUE(cache.store(trees[4].key, trees[4].blas));
    EXPECT_TRUE(is_kept(0));
    EXPECT_FALSE(is_kept(1));
    for (int k = 5; k < 8; ++k) ASSERT_TRUE(cache.store(trees[k].key, trees[k].blas));
    EXPECT_FALSE(is_kept(2));
    EXPECT_FALSE(is_kept(3));
    EXPECT_TRUE(is_kept(7));
    EXPECT_EQ(take_warning_count(&cache), 0u);
}

TEST(TreeCache, FolderStaysWithinItsLimit) {
    const TempFolder folder;
    const std::vector<Planted> trees = some_trees(60);
    const uint64_t limit = 20 * tree_file_size(trees[0].blas);
    for (int round = 0; round < 3; ++round) {
        TreeCache cache(folder.path(), limit);  // Another run, which does not know what is there.
        for (const Planted& tree : trees) {
            ASSERT_TRUE(cache.store(tree.key, tree.blas));
            uint64_t total = 0;
            for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) total += entry.file_size();
            ASSERT_LE(total, limit);
        }
        EXPECT_GT(file_count(folder.path()), 10u) << "full, not empty";
        EXPECT_EQ(take_warning_count(&cache), 0u);
    }
}

TEST(TreeCache, FilesOfOthersStay) {
    const TempFolder folder, outside;
    const std::string key(32, 'a');
    const std::vector<std::string> names = {"notes.txt",
                                            key,
                                            key + ".blas.bak",
                                            std::string(32, 'A') + ".blas",
                                            std::string(31, 'a') + ".blas",
                                            key + "a.blas",
                                            std::string(32, 'g') + ".blas",
                                            key + ".blas.tmp",
                                            "x" + key + ".blas",
                                            key + ".blas.XXXXXX.tmp2",
                                            key + "/" + key + ".blas"};
    const fs::path precious = outside.write("precious", std::string(5000, 'p'));
    for (const std::string& name : names) {
        if (name.find('/') != std::string::npos) continue;
        make_older(folder.write(name, std::string(5000, 'x')), std::chrono::hours(1000));
    }
    const std::string linked = std::string(32, 'b') + ".blas", inner = std::string(32, 'c') + ".blas";
    fs::create_symlink(precious, folder / linked);
    fs::create_directory(folder / inner);
    const std::vector<Planted> trees = some_trees(5);
    TreeCache cache(folder.path(), tree_file_size(trees[0].blas) * 3 / 2);
    for (const Planted& tree : trees) ASSERT_TRUE(cache.store(tree.key, tree.blas));
    for (const std::string& name : names) {
        if (name.find('/') != std::string::npos) continue;
        EXPECT_EQ(read_bytes(folder / name), std::string(5000, 'x')) << name;
    }
    EXPECT_TRUE(fs::is_symlink(folder / linked));
    EXPECT_TRUE(fs::is_directory(folder / inner));
    EXPECT_EQ(read_bytes(precious), std::string(5000, 'p'));
    EXPECT_EQ(file_count(folder.path()), names.size() - 1 + 2 + 1) << "one tree is left";
    EXPECT_EQ(take_warning_count(&cache), 0u);
}

TEST(TreeCache, UnfinishedFilesGoOnceTheyAreStale) {
    const TempFolder folder;
    const std::vector<Planted> trees = some_trees(2);
    const uint64_t size = std::max(tree_file_size(trees[0].blas), tree_file_size(trees[1].blas));
    const fs::path unfinished = folder.write(std::string(32, 'd') + ".blas.a1B2c3.tmp", std::string(size, 'x'));
    {
        TreeCache cache(folder.path(), size + size / 2);
        EXPECT_FALSE(cache.store(trees[0].key, trees[0].blas)) << "another process is writing";
        EXPECT_EQ(take_warning_count(&cache), 1u);
        EXPECT_TRUE(fs::exists(unfinished));
    }
    make_older(unfinished, std::chrono::minutes(61));
    TreeCache cache(folder.path(), size + size / 2);
    EXPECT_TRUE(cache.store(trees[1].key, trees[1].blas));
    EXPECT_FALSE(fs::exists(unfinished));
}

// Two caches over a folder know nothing of each other, as two processes don't.
TEST(TreeCache, TwoWritersAndTheirReadersShareAFolder) {
    const TempFolder folder;
    const std::vector<Planted> trees = some_trees(12);
    // Room for half of them: files go while others are read.
    const uint64_t limit = 6 * tree_file_size(trees[0].blas);
    TreeCache caches[2] = {TreeCache(folder.path(), limit), TreeCache(folder.path(), limit)};
    std::atomic<int> wrong_count{0}, loaded_count{0};
    std::vector<std::thread> threads;
    for (int k = 0; k < 4; ++k) {
        threads.emplace_back([&, k] {
            TreeCache& cache = caches[k % 2];
            Rng rng(300 + k);
            for (int step = 0; step < 150; ++step) {
                const Planted& tree = trees[rng.next() % trees.size()];
                Blas loaded;
                if (tree.load(&cache, &loaded)) {
                    ++loaded_count;
                    wrong_count += !is_same(loaded, tree.blas);
                } else {
                    wrong_count += !cache.store(tree.key, tree.blas);
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong_count, 0);
    EXPECT_GT(loaded_count, 0);
    for (TreeCache& cache : caches) {
        for (const auto& [text, count] : cache.take_warnings()) ADD_FAILURE() << text << " x" << count;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
        EXPECT_EQ(entry.path().extension(), ".blas") << "a temporary file is left";
    }
}

TEST(TreeCache, OnlyTreesThatAreSlowToBuildAreWorthKeeping) {
    const Planted small(random_soup(10, 1.0f, 14)), large(random_soup(20'000, 0.1f, 15));
    EXPECT_FALSE(is_worth_keeping(0.01, small.blas));
    EXPECT_TRUE(is_worth_keeping(1.0, small.blas));
    EXPECT_FALSE(is_worth_keeping(0.5, large.blas)) << tree_file_size(large.blas) << " bytes";
    EXPECT_TRUE(is_worth_keeping(10.0, large.blas));
}

TEST(TreeCache, DefaultFolderIsTheUsers) {
    const Variable home("HOME", "/home/someone");
    const auto with_cache_home = [](const char* value) {
        const Variable cache("XDG_CACHE_HOME", value);
        return default_cache_folder();
    };
    EXPECT_EQ(with_cache_home("/some/where"), "/some/where/zoetrope");
    for (const char* const value : {static_cast<const char*>(nullptr), "", "relative"}) {
        EXPECT_EQ(with_cache_home(value), "/home/someone/.cache/zoetrope");
        for (const char* const no_home : {static_cast<const char*>(nullptr), "", "~"}) {
            const Variable none("HOME", no_home);
            EXPECT_EQ(with_cache_home(value), "");
        }
    }
}

}  // namespace
}  // namespace zoe::test
