#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <string>

#include "engine/bvh/blas.h"
#include "engine/bvh/hash.h"

namespace zoe {

/// Trees that are kept in a folder from run to run: one file each, named by its key (see `tree_key`) and ending in .blas.
/// A file is whole or not there, and is checked before it is believed, as far as `read_tree` says; what is wrong with one,
/// or with the folder, is a warning, never a failure. When the folder would exceed its limit, the files that were not used
/// for the longest go; files with other names are left alone. Threads and processes may share a folder; several processes
/// may exceed the limit together, by a sixteenth or one tree each.
class TreeCache {
public:
    static constexpr uint64_t kDefaultMaxBytes = uint64_t{1} << 30;

    /// folder     made with the first tree that is kept.
    explicit TreeCache(std::filesystem::path folder, uint64_t max_bytes = kDefaultMaxBytes);

    /// Reads a tree.
    /// positions, corners   of the mesh that the key was made of.
    /// blas       result, to the last bit what was kept; left as it is where the folder has no such tree.
    /// Returns    true where it was read.
    /// Cost       O(file); marks the file as used.
    bool load(const Hash128& key, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, Blas* blas);

    /// Keeps a tree, in the place of one that has the same key. After a first failure to write, nothing more is tried.
    /// Returns    true where it was kept.
    bool store(const Hash128& key, const Blas& blas);

    /// What went wrong since the last call, and how many times.
    std::map<std::string, uint64_t> take_warnings();

private:
    void warn(const std::string& text);
    bool stop_storing(const std::string& reason);
    bool make_room(uint64_t byte_count);
    std::string write(const Hash128& key, const Blas& blas) const;

    const std::filesystem::path folder_;
    const uint64_t max_bytes_;
    std::atomic<bool> can_store_{true};

    std::mutex store_mutex_;  // Held by the one thread that writes.
    uint64_t allowance_ = 0;  // Bytes that may be written before the folder is looked through again.

    std::mutex warnings_mutex_;
    std::map<std::string, uint64_t> warnings_;
};

/// Meshes with fewer triangles are built faster than any file is opened: not worth a key.
inline constexpr size_t kFewestCachedTriangles = 256;

/// Whether building a tree took longer than loading it will. The load is predicted from its bytes, not measured: whether
/// the disk and memory will be warm is not known. A wrong guess costs time only.
bool is_worth_keeping(double build_ms, const Blas& blas);

/// Where a user's programs keep such things: zoetrope in $XDG_CACHE_HOME, or else in $HOME/.cache; empty where neither is an
/// absolute path.
/// Source     XDG Base Directory Specification 0.8.
std::filesystem::path default_cache_folder();

}  // namespace zoe
