#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "apps/bench/ray_kind.h"
#include "engine/frame/frame.h"

namespace zoe {

/// A ray for which the engine and the peer found different hits.
struct Disagreement {
    int frame = 0;
    RayKind kind = RayKind::kPrimary;
    uint64_t ray_index = 0;  ///< In the batch of its kind.
    Ray ray;
    /// A miss is `Hit{}`. Of shadow rays only whether there is a hit is known: node and primitive are none, t is 0 for a
    /// hit.
    Hit ours, peers;
};

/// Disagreements of a scene or a tree that are judged, as brute force takes a few ms each; and how many of them between two
/// reports of progress.
inline constexpr size_t kMaxJudged = 20'000, kJudgedAtOnce = 500;

/// Who is right about a ray. kEither: both answers lie within what rounding to float may do, or hit surfaces that lie in
/// each other.
enum class Verdict : uint8_t { kOurs, kPeers, kEither, kNeither };
inline constexpr size_t kVerdictCount = 4;
const char* name(Verdict verdict);  ///< "ours", "peers", "either", "neither"

/// Judges rays of one frame by brute force over all triangles that it shows, in double precision: by the oracle that the
/// tests use, which shares no intersection, transform or tree code with the engine.
///
/// Truth is what both programs were given: the frame's vertices and matrices, floats and taken as exact. What rounding may
/// do is counted from there. A matrix that shears makes a ray that is taken into local space lose more than the oracle
/// allows: that is an error, not an excuse. An answer that is not one (a NaN, a hit outside of the ray) is wrong.
///
/// tlas       the frame that the rays belong to; `advance` has not been called since.
/// Returns    [disagreement_count]
/// Cost       a few hundred rays against a million triangles take seconds: O(triangles / 32) time a ray, and more where it
///            passes near; in parallel over rays. Triangles are placed in blocks of 100 MB, however large the scene.
std::vector<Verdict> judge(const Tlas& tlas, std::span<const Disagreement> disagreements);

/// A line of the file of disagreements: frame, ray, both answers, and the verdict in words.
std::string describe(const Disagreement& disagreement, Verdict verdict);

}  // namespace zoe
