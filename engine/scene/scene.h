#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/bvh/build_auto.h"
#include "engine/bvh/cluster_config.h"
#include "engine/bvh/placing_config.h"
#include "engine/bvh/rebuild_config.h"
#include "engine/deform/sample.h"
#include "engine/math/affine.h"
#include "engine/scene/error.h"
#include "engine/scene/ids.h"
#include "engine/scene/image.h"
#include "engine/scene/material.h"
#include "engine/scene/mesh.h"

namespace zoe {

/// How a node can move: each class is a special case of the one after it.
enum class Motion : uint8_t { kStatic, kRigid, kDeforming, kArbitrary };
inline constexpr int kMotionCount = 4;
const char* name(Motion motion);  ///< "static", "rigid", "deforming", "arbitrary"
std::optional<Motion> motion_from_name(std::string_view name);

/// A mesh a frame: the node shows meshes[floor(time * fps)], from the start again after the last where clips loop.
struct MeshSequence {
    std::vector<MeshId> meshes;
    double fps = 24.0;
};

struct Node {
    std::string name;
    NodeId parent = kNone<NodeId>;
    Trs local;                     ///< Rest pose; unused where `matrix` is set.
    std::optional<Affine> matrix;  ///< Given as a matrix (never animated: the reader decomposes those).
    MeshId mesh = kNone<MeshId>;
    SkinId skin = kNone<SkinId>;
    CameraId camera = kNone<CameraId>;
    LightId light = kNone<LightId>;
    std::vector<float> weights;            ///< Morph weights at rest; empty: the mesh's.
    std::optional<MeshSequence> sequence;  ///< Replaces `mesh` frame by frame.
    std::optional<Motion> motion;          ///< Asked for (extras.motion, set_motion).
    bool is_shown = true;                  ///< False: not part of the chosen scene. Joints may still need it.
};

struct Skin {
    std::string name;
    std::vector<NodeId> joints;
    std::vector<Affine> joint_from_mesh;  ///< Inverse bind matrices, [joint_count].
    Skinning skinning = Skinning::kLinearBlend;
};

enum class ChannelPath : uint8_t { kTranslation, kRotation, kScale, kWeights };

struct AnimationChannel {
    NodeId node = kNone<NodeId>;
    ChannelPath path = ChannelPath::kTranslation;
    uint32_t sampler = 0;  ///< Index into Clip::samplers.
};

struct Clip {
    std::string name;
    std::vector<Sampler> samplers;
    std::vector<AnimationChannel> channels;
    double duration_s = 0.0;  ///< The last key's time over all channels.
};

struct Camera {
    std::string name;
    bool is_perspective = true;
    float yfov = 0.8f;                ///< Radians, whole angle, vertical.
    float xmag = 1.0f, ymag = 1.0f;   ///< Half width and height of an orthographic view.
    float aspect = 0.0f;              ///< Width / height; 0: the picture's.
    float znear = 0.0f, zfar = 0.0f;  ///< zfar 0: infinite. Kept, not used to clip.
    float shutter = 0.0f;             ///< Share of a frame that it is open, 0 to 1 (extras.shutter).
};

enum class LightKind : uint8_t { kDirectional, kPoint, kSpot };

/// KHR_lights_punctual. Shines along the node's -Z.
struct Light {
    std::string name;
    LightKind kind = LightKind::kPoint;
    glm::vec3 color{1.0f};                             ///< Linear.
    float intensity = 1.0f;                            ///< Candela (point, spot) or lux (directional).
    float range = 0.0f;                                ///< Metres; 0: infinite.
    float inner_cone = 0.0f, outer_cone = 0.7853982f;  ///< Radians from the axis.
};

/// Which clips play, and how.
struct Playback {
    std::vector<ClipId> clips;  ///< Where two drive the same thing, the later one wins.
    bool is_looping = true;
};

/// Where pictures are taken from, for surfaces that are subdivided as finely as their pixels show. Perspective.
struct Viewpoint {
    NodeId node = kNone<NodeId>;  ///< A camera's node, with which it moves; or none:
    glm::vec3 eye_world{0.0f};    ///< a place, in metres from the scene's origin.
    float yfov = 0.8f;            ///< Radians, whole angle, vertical.
    int height_pixels = 720;      ///< Of the picture.
    /// A node goes to a coarser level only where that is better than asked for by this share, so that it does not go back
    /// and forth. Then its level may depend on frames before, within what is asked for; at 0 it depends on the frame alone.
    float hysteresis = 0.25f;
    /// Of all surfaces with `pixels` together: one for each pixel of a large picture. While they would have more, those of
    /// the finest level go a level coarser one by one, of most triangles and then the first node first; with a warning.
    uint64_t max_triangles = uint64_t{1} << 23;
};

struct FrameState;  // engine/frame: what `advance` keeps between frames.
class TraceWatch;   // engine/scene/trace_watch.h
class TreeCache;    // engine/bvh/cache.h

/// A scene graph: nodes, what they show, and how they move. Plain arrays; ids are positions in them.
/// NodeId is the glTF node's index for scenes from files; nodes that the reader adds stand after those.
/// While rays go through its last frame in batches, functions that edit it throw std::logic_error; its end is not watched.
class Scene {
public:
    Scene() = default;
    Scene(Scene&&) = default;
    Scene& operator=(Scene&&) = default;

    std::string file;  ///< Where it came from; empty for scenes made in code.
    std::vector<Node> nodes;
    std::vector<Mesh> meshes;
    std::vector<Skin> skins;
    std::vector<Clip> clips;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Material> materials;
    std::vector<Image> images;
    Playback playback;  ///< From files: the first clip, looping.
    /// Where the world's (0, 0, 0) is, in the scene's own space: taken off every node's place in double precision. Near
    /// it, rays and hits are as exact as if nodes had been placed there, however far out they are; vertices that are far
    /// out in their own mesh stay as coarse as floats are there. Looked at by every `advance`.
    glm::dvec3 origin{0.0};
    std::optional<Viewpoint> viewpoint;  ///< Looked at by every `advance`, for surfaces with `pixels`.
    /// Where trees of static and rigid nodes are kept from run to run; null, as it is unless set: nowhere.
    std::shared_ptr<TreeCache> tree_cache;
    AutoConfig tree_build;     ///< How much building all those trees may cost, looked at when the first frame is made.
    ClusterConfig tlas_build;  ///< How the top level is built in the frames from now on that need a new one.
    PlacingConfig placing;     ///< How instances stand in it; looked at where they move.
    /// Poses of clips, at most, that the first trees of deforming nodes are built over; 1: this frame's alone. Chart `clip`.
    uint32_t clip_poses = 8;
    RebuildConfig rebuild;  ///< When trees of deforming nodes are rebuilt, and not refitted any more.

    Node& operator[](NodeId id) { return nodes.at(index(id)); }
    const Node& operator[](NodeId id) const { return nodes.at(index(id)); }
    Mesh& operator[](MeshId id) { return meshes.at(index(id)); }
    const Mesh& operator[](MeshId id) const { return meshes.at(index(id)); }

    /// Adds a node, a mesh, ... and returns its id. Convenience for scenes made in code.
    NodeId add(Node node);
    MeshId add(Mesh mesh);
    MaterialId add(Material material);

    /// Replaces a mesh's triangles; vertex and triangle count may change. Nodes that show it become arbitrary. Its skin and
    /// morph targets are dropped: what is written is what is shown. Its uvs and colours stay where the vertex count does.
    /// normals    [vertex_count] or empty.
    /// Throws     SceneError where a corner is not below the vertex count.
    void write_mesh(MeshId mesh, std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                    std::span<const glm::uvec3> corners);

    /// Moves the cage of a mesh with a surface; its topology, skin and morph targets stay. Nodes that show it become
    /// deforming.
    /// positions  [vertex_count] in place of the mesh's own.
    /// Throws     SceneError where the mesh has no surface or another vertex count.
    void write_cage(MeshId mesh, std::span<const glm::vec3> positions);

    /// Tells the engine that nodes, meshes, clips, skins or materials were changed by hand: the frame state starts anew.
    void touch();

    /// Parents before children: every node's position in `nodes`, in an order that one loop can follow.
    /// Throws     SceneError where a parent is missing or nodes form a cycle.
    std::vector<NodeId> parents_first() const;

    /// Adds a warning, or counts one that was given before.
    void warn(const std::string& text) { ++warnings_[plain_line(text)]; }
    const std::map<std::string, uint64_t>& warnings() const { return warnings_; }

    std::shared_ptr<FrameState> frame;   ///< Made by the first `advance`; opaque here.
    std::shared_ptr<TraceWatch> traces;  ///< Made with it: who is at its trees.

private:
    std::map<std::string, uint64_t> warnings_;
};

/// Checks every cross-reference, count and number of a scene.
/// Returns    the first broken invariant in words, empty when all hold.
std::string check(const Scene& scene);

}  // namespace zoe
