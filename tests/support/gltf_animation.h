#pragma once

#include <cstddef>
#include <vector>

#include "tests/support/gltf_document.h"

namespace zoe::test {

/// Which clips play, and how.
struct OraclePlayback {
    std::vector<size_t> clips{0};  ///< Where two drive the same thing, the later one wins; missing clips play nothing.
    bool is_looping = true;
};

/// The time within a clip: `time_s` mod its duration where it loops.
double clip_time_s(const DocumentClip& clip, double time_s, bool is_looping);

/// A channel's value, by the formulas of the glTF 2.0 specification, appendix C. Before the first key its value, after
/// the last the last's; of equal key times the later key holds from that time on. Rotations have length 1.
std::vector<double> sample_channel(const DocumentChannel& channel, double time_s);

/// Moves nodes (and their morph weights) to where the clips put them.
void play(const std::vector<DocumentClip>& clips, const OraclePlayback& playback, double time_s,
          std::vector<DocumentNode>* nodes);

}  // namespace zoe::test
