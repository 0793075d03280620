// What may be wrong with a cache's folder: a warning, and no failure.

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/bvh/cache_inputs.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

/// Gives up root's right to write everywhere, for a while.
class NotRoot {
public:
    NotRoot() : was_(geteuid()) {
        if (was_ == 0) is_other_ = seteuid(65534) == 0;
    }
    ~NotRoot() {
        if (is_other_ && seteuid(was_) != 0) std::abort();
    }
    bool holds() const { return geteuid() != 0; }

private:
    uid_t was_;
    bool is_other_ = false;
};

/// No file may grow beyond a size: writing more fails, as on a full disk.
class FullDisk {
public:
    explicit FullDisk(rlim_t byte_count) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &was_);
        const rlimit limit{byte_count, was_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        setrlimit(RLIMIT_FSIZE, &was_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit was_;
    void (*handler_)(int);
};

TEST(TreeCache, FolderThatIsAFileIsAWarning) {
    const TempFolder folder;
    const Planted planted(random_soup(10, 1.0f, 4));
    const fs::path file = folder.write("file", "someone's");
    for (const fs::path& path : {file, file / "below"}) {
        TreeCache cache(path);
        Blas loaded;
        EXPECT_FALSE(planted.load(&cache, &loaded));
        EXPECT_EQ(take_warning_count(&cache), 1u);
        EXPECT_FALSE(cache.store(planted.key, planted.blas));
        EXPECT_FALSE(cache.store(planted.key, planted.blas));
        EXPECT_EQ(take_warning_count(&cache), 1u) << "tried once";
    }
    EXPECT_EQ(read_bytes(file), "someone's");
}

TEST(TreeCache, FolderThatIsReadOnlyIsRead) {
    const TempFolder folder;
    const Planted planted(random_soup(10, 1.0f, 5)), other(random_soup(10, 1.0f, 6));
    {
        TreeCache cache(folder.path());
        ASSERT_TRUE(cache.store(planted.key, planted.blas));
    }
    fs::permissions(folder / planted.file_name(), fs::perms(0444));
    fs::permissions(folder.path(), fs::perms(0555));
    {
        const NotRoot not_root;
        if (!not_root.holds()) GTEST_SKIP() << "root writes everywhere";
        TreeCache cache(folder.path());
        Blas loaded;
        EXPECT_TRUE(planted.load(&cache, &loaded));
        EXPECT_EQ(take_warning_count(&cache), 0u);
        EXPECT_FALSE(cache.store(other.key, other.blas));
        EXPECT_FALSE(cache.store(other.key, other.blas));
        EXPECT_EQ(take_warning_count(&cache), 1u);
    }
    fs::permissions(folder.path(), fs::perms(0755));
    EXPECT_EQ(file_count(folder.path()), 1u);
}

TEST(TreeCache, FileThatMayNotBeReadIsAWarning) {
    const TempFolder folder;
    const Planted planted(random_soup(10, 1.0f, 7));
    TreeCache cache(folder.path());
    ASSERT_TRUE(cache.store(planted.key, planted.blas));
    fs::permissions(folder / planted.file_name(), fs::perms(0));
    fs::permissions(folder.path(), fs::perms(0755));
    const NotRoot not_root;
    if (!not_root.holds()) GTEST_SKIP() << "root reads everything";
    Blas loaded;
    EXPECT_FALSE(planted.load(&cache, &loaded));
    EXPECT_EQ(take_warning_count(&cache), 1u);
}

TEST(TreeCache, FullDiskLeavesNothingBehind) {
    const TempFolder folder;
    const Planted planted(random_soup(40, 1.0f, 8));
    const uint64_t size = tree_file_size(planted.blas);
    for (const uint64_t space : {uint64_t{0}, uint64_t{1}, size / 2, size - 1}) {
        TreeCache cache(folder.path());
        {
            const FullDisk full(space);
            EXPECT_FALSE(cache.store(planted.key, planted.blas));
        }
        EXPECT_EQ(take_warning_count(&cache), 1u);
        EXPECT_EQ(file_count(folder.path()), 0u);
        EXPECT_FALSE(cache.store(planted.key, planted.blas)) << "tried once";
        EXPECT_EQ(take_warning_count(&cache), 0u);
    }
    TreeCache cache(folder.path());
    const FullDisk full(size);
    EXPECT_TRUE(cache.store(planted.key, planted.blas));
}

TEST(TreeCache, LinksAreNotFollowed) {
    const TempFolder folder, outside;
    const Planted planted(random_soup(10, 1.0f, 11));
    {
        TreeCache elsewhere(outside.path());
        ASSERT_TRUE(elsewhere.store(planted.key, planted.blas));
    }
    const fs::path target = outside / planted.file_name();
    const std::string before = read_bytes(target);
    fs::create_symlink(target, folder / planted.file_name());
    TreeCache cache(folder.path());
    Blas loaded;
    EXPECT_FALSE(planted.load(&cache, &loaded));
    EXPECT_EQ(take_warning_count(&cache), 1u);
    folder.write("unrelated", "");
    ASSERT_TRUE(cache.store(planted.key, planted.blas));
    EXPECT_FALSE(fs::is_symlink(folder / planted.file_name()));
    EXPECT_TRUE(planted.load(&cache, &loaded));
    EXPECT_EQ(read_bytes(target), before);
    EXPECT_EQ(fs::hard_link_count(target), 1u);
}

TEST(TreeCache, PipesAndFoldersInATreesPlaceAreWarnings) {
    const TempFolder folder;
    const Planted piped(random_soup(10, 1.0f, 12)), foldered(random_soup(10, 1.0f, 13));
    ASSERT_EQ(mkfifo((folder / piped.file_name()).c_str(), 0600), 0);
    fs::create_directories(folder / foldered.file_name() / "more");
    TreeCache cache(folder.path());
    Blas loaded;
    EXPECT_FALSE(piped.load(&cache, &loaded));
    EXPECT_FALSE(foldered.load(&cache, &loaded));
    EXPECT_EQ(take_warning_count(&cache), 2u);
    EXPECT_TRUE(cache.store(piped.key, piped.blas));
    EXPECT_FALSE(cache.store(foldered.key, foldered.blas));
    EXPECT_EQ(take_warning_count(&cache), 1u);
    EXPECT_EQ(file_count(folder.path()), 2u) << "no temporary file is left";
}

}  // namespace
}  // namespace zoe::test
