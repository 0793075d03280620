#pragma once

namespace zoe {

/// What is asked of the peer; all else is found by trying.
struct PeerOptions {
    bool is_robust = false;
    bool is_static_high = false;  ///< Static trees are built with spatial splits.
    bool is_two_level = false;    ///< Instances under a top level: all in one scene is not tried.
};

}  // namespace zoe
