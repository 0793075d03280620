#include "tests/support/gltf_oracle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace zoe::test {
namespace {

/// A map to the world, and how large the numbers on the way were.
struct Pose {
    AffineDouble world;
    double reach = 0.0;    ///< The lengths of all translations so far, each as the world sees it.
    double stretch = 1.0;  ///< By how much a local length can grow.

    double magnitude(const glm::dvec3& p) const { return reach + stretch * glm::length(p); }
};

Pose below(const Pose& parent, const AffineDouble& local, double local_stretch) {
    return {parent.world * local, parent.reach + parent.stretch * glm::length(local.t), parent.stretch * local_stretch};
}

Pose below(const Pose& parent, const DocumentNode& node) {
    if (node.matrix) return below(parent, *node.matrix, node.matrix->stretch());
    const glm::dvec3 size = glm::dvec3(std::abs(node.scale.x), std::abs(node.scale.y), std::abs(node.scale.z));
    return below(parent, from_trs(node.translation, node.rotation, node.scale), std::max({size.x, size.y, size.z}));
}

std::vector<Pose> world_poses(const std::vector<DocumentNode>& nodes) {
    std::vector<Pose> poses(nodes.size());
    std::vector<bool> is_done(nodes.size(), false);
    for (size_t i = 0; i < nodes.size(); ++i) {
        // Climb to the first ancestor that is done (or a root), then come down again.
        std::vector<size_t> path;
        for (int n = static_cast<int>(i); n >= 0 && !is_done[static_cast<size_t>(n)];
             n = nodes[static_cast<size_t>(n)].parent) {
            path.push_back(static_cast<size_t>(n));
            if (path.size() > nodes.size()) throw std::runtime_error("oracle: nodes form a cycle");
        }
        for (; !path.empty(); path.pop_back()) {
            const DocumentNode& node = nodes[path.back()];
            poses[path.back()] = below(node.parent >= 0 ? poses[static_cast<size_t>(node.parent)] : Pose{}, node);
            is_done[path.back()] = true;
        }
    }
    return poses;
}

struct Vertex {
    glm::dvec3 position;
    double magnitude;
};

/// The vertex in its mesh's space, morph targets added.
Vertex morph(const DocumentPrimitive& primitive, const std::vector<double>& weights, size_t v) {
    Vertex vertex{primitive.positions[v], glm::length(primitive.positions[v])};
    for (size_t i = 0; i < primitive.targets.size() && i < weights.size(); ++i) {
        if (primitive.targets[i].empty()) continue;
        const glm::dvec3 offset = weights[i] * primitive.targets[i].at(v);
        vertex.position += offset;
        vertex.magnitude += glm::length(offset);
    }
    return vertex;
}

/// The vertex in the world: the joints' images of it, blended. A vertex without weights follows the first joint.
Vertex skin(const DocumentPrimitive& primitive, const std::vector<Pose>& joints, const Vertex& vertex, size_t v) {
    const double* weights = &primitive.weights[v * primitive.influence_count];
    const uint32_t* indices = &primitive.joints[v * primitive.influence_count];
    double sum = 0.0;
    for (uint32_t k = 0; k < primitive.influence_count; ++k) sum += weights[k];
    if (sum == 0.0) {
        const Pose& first = joints.at(0);
        return {first.world.point(vertex.position), first.reach + first.stretch * vertex.magnitude};
    }
    Vertex blended{glm::dvec3(0.0), 0.0};
    for (uint32_t k = 0; k < primitive.influence_count; ++k) {
        if (weights[k] == 0.0) continue;
        const Pose& joint = joints.at(indices[k]);
        blended.position += weights[k] / sum * joint.world.point(vertex.position);
        blended.magnitude += std::abs(weights[k] / sum) * (joint.reach + joint.stretch * vertex.magnitude);
    }
    return blended;
}

/// Appends what one node (or instance) shows.
void show(const DocumentMesh& mesh, const std::vector<double>& weights, const Pose& pose, const std::vector<Pose>* joints,
          uint32_t node, std::vector<WorldTriangle>* out) {
    uint32_t triangle_count = 0;
    for (const DocumentPrimitive& primitive : mesh.primitives) {
        if (primitive.corners.empty()) continue;
        std::vector<Vertex> vertices(primitive.positions.size());
        for (size_t v = 0; v < vertices.size(); ++v) {
            const Vertex local = morph(primitive, weights, v);
            if (joints != nullptr && primitive.influence_count > 0) {
                vertices[v] = skin(primitive, *joints, local, v);
            } else {
                vertices[v] = {pose.world.point(local.position), pose.reach + pose.stretch * local.magnitude};
            }
        }
        for (const std::array<uint32_t, 3>& corners : primitive.corners) {
            const Vertex &a = vertices[corners[0]], &b = vertices[corners[1]], &c = vertices[corners[2]];
            out->push_back({a.position, b.position, c.position, node, triangle_count++,
                            std::max({a.magnitude, b.magnitude, c.magnitude})});
        }
    }
}

}  // namespace

std::vector<WorldTriangle> world_triangles(const Document& document, double time_s, const OraclePlayback& playback) {
    std::vector<DocumentNode> nodes = document.nodes;
    play(document.clips, playback, time_s, &nodes);
    const std::vector<Pose> poses = world_poses(nodes);

    std::vector<WorldTriangle> triangles;
    uint32_t extra_node = static_cast<uint32_t>(nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i) {
        const DocumentNode& node = nodes[i];
        if (node.mesh < 0) continue;
        if (!node.is_shown) {
            extra_node += static_cast<uint32_t>(node.instances.size());
            continue;
        }
        const DocumentMesh& mesh = document.meshes.at(static_cast<size_t>(node.mesh));
        const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
        if (node.has_instances) {
            for (const AffineDouble& instance : node.instances) {
                show(mesh, weights, below(poses[i], instance, instance.stretch()), nullptr, extra_node++, &triangles);
            }
        } else if (node.skin >= 0) {
            const DocumentSkin& skin = document.skins.at(static_cast<size_t>(node.skin));
            std::vector<Pose> joints;
            for (size_t j = 0; j < skin.joints.size(); ++j) {
                const AffineDouble& inverse_bind = skin.inverse_bind[j];
                joints.push_back(below(poses.at(static_cast<size_t>(skin.joints[j])), inverse_bind, inverse_bind.stretch()));
            }
            show(mesh, weights, poses[i], &joints, static_cast<uint32_t>(i), &triangles);
        } else {
            show(mesh, weights, poses[i], nullptr, static_cast<uint32_t>(i), &triangles);
        }
    }
    return triangles;
}

}  // namespace zoe::test
