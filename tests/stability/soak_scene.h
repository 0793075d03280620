#pragma once

#include <cstdint>
#include <vector>

#include "engine/frame/frame.h"
#include "engine/math/rng.h"

namespace zoe::test {

/// A scene that a user edits at random, in every way that there is: nodes come, go, are hidden, scaled to zero, hung
/// elsewhere and show other meshes; skins and channels change what they move; meshes are written with other triangles;
/// classes are asked for, and where the content forbids them refused; so are edits that would break the scene.
class SoakScene {
public:
    explicit SoakScene(uint64_t seed);

    /// One edit, or none.
    void edit();
    /// Only what needs no `touch`: writes meshes and moves the world's origin. What is done follows from `step`.
    void write(uint64_t step);
    /// The same nodes, meshes and settings as at the beginning.
    void restore();

    Scene scene;

private:
    NodeId some_node() { return NodeId{rng_.below(static_cast<uint32_t>(scene.nodes.size()))}; }
    void add_node();
    void remove_node();
    void change_node();
    void retarget();
    void ask_for_class();
    void replace_mesh();
    void break_scene();
    void change_settings();

    Rng rng_;
    std::vector<Node> first_nodes_;
    std::vector<Mesh> first_meshes_;
    std::vector<Skin> first_skins_;
    std::vector<Clip> first_clips_;
};

/// The same scene, never played.
Scene copy_of(const Scene& scene);

}  // namespace zoe::test
