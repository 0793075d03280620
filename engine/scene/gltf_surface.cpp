#include "engine/scene/gltf_surface.h"

#include <algorithm>
#include <array>

#include "engine/scene/gltf_primitive.h"
#include "engine/scene/weld.h"

namespace zoe {
namespace {

using Edge = std::array<uint32_t, 2>;

Edge edge_of(uint32_t a, uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

/// Faces of a mesh, by its vertices before they are welded.
struct Polygons {
    std::vector<uint32_t> sizes, corners;
};

/// The triangles of a primitive, joined where its encoding says that they are polygons.
void append_polygons(const Mesh& mesh, const MaterialRange& range, bool is_encoded, Polygons* polygons, Scene& scene) {
    for (uint32_t k = range.begin; k < range.end; ++k) {
        const glm::uvec3& c = mesh.corners[k];
        if (is_encoded && k > range.begin && mesh.corners[k - 1].x == c.x) {
            if (polygons->corners.back() == c.y) {
                polygons->corners.push_back(c.z);
                ++polygons->sizes.back();
                continue;
            }
            scene.warn("FB_ngon_encoding: triangles of one polygon that share no edge: taken as faces of their own");
        }
        polygons->corners.insert(polygons->corners.end(), {c.x, c.y, c.z});
        polygons->sizes.push_back(3);
    }
}

/// Adds a face, without corners that are the one before them. Faces of less than three are left out.
/// kept       gets the vertices of the mesh that the corners are.
void append_face(std::span<const uint32_t> polygon, const Welding& welding, Cage* cage, std::vector<uint32_t>* kept,
                 Scene& scene) {
    const size_t first = cage->vertices.size();
    for (size_t k = 0; k < polygon.size(); ++k) {
        const uint32_t vertex = welding.vertex_of[polygon[k]];
        if (vertex == welding.vertex_of[polygon[k == 0 ? polygon.size() - 1 : k - 1]]) continue;
        cage->vertices.push_back(vertex);
        kept->push_back(polygon[k]);
    }
    const size_t size = cage->vertices.size() - first;
    if (size >= 3) {
        cage->face_sizes.push_back(static_cast<uint32_t>(size));
        return;
    }
    cage->vertices.resize(first);
    kept->resize(first);
    scene.warn("a face of a subdivision cage whose corners are in one place: left out");
}

std::vector<Edge> edges_of(const Cage& cage) {
    std::vector<Edge> edges;
    size_t first = 0;
    for (const uint32_t size : cage.face_sizes) {
        for (uint32_t k = 0; k < size; ++k) {
            edges.push_back(edge_of(cage.vertices[first + k], cage.vertices[first + (k + 1) % size]));
        }
        first += size;
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Reads rows of numbers: vertices, then a sharpness.
class SharpnessReader {
public:
    /// shift      from vertices of the first primitive to those of the mesh, modulo 2^32.
    SharpnessReader(const GltfFile& file, const Welding& welding, uint32_t shift, std::string place)
        : file_(file), welding_(welding), shift_(shift), place_(std::move(place)) {}

    template <size_t kVertices, typename Add>
    void read(const tinygltf::Value& rows, Add&& add) const {
        if (!rows.IsArray()) file_.fail(place_, "must be an array");
        for (size_t i = 0; i < rows.ArrayLen(); ++i) {
            const std::string place = fmt::format("{}/{}", place_, i);
            const tinygltf::Value& row = rows.Get(static_cast<int>(i));
            if (!row.IsArray() || row.ArrayLen() != kVertices + 1) {
                file_.fail(place, fmt::format("must be an array of {} numbers", kVertices + 1));
            }
            std::array<uint32_t, kVertices> vertices;
            for (size_t k = 0; k < kVertices; ++k) vertices[k] = vertex(row.Get(static_cast<int>(k)), place);
            const tinygltf::Value& last = row.Get(static_cast<int>(kVertices));
            const double sharpness = last.IsNumber() ? last.GetNumberAsDouble() : -1.0;
            if (!(sharpness >= 0.0)) file_.fail(place, "its sharpness is not a number of at least 0");
            add(vertices, static_cast<float>(std::min(sharpness, 1e6)));
        }
    }

    /// What stands for a vertex that no triangle has, nor one between those that triangles have.
    static constexpr uint32_t kUnused = UINT32_MAX;

private:
    uint32_t vertex(const tinygltf::Value& value, const std::string& place) const {
        const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1.0;
        if (!(number >= 0.0 && number < 4294967295.0) || number != static_cast<uint32_t>(number)) {
            file_.fail(place, "it does not name vertices by their numbers");
        }
        const uint32_t of_mesh = static_cast<uint32_t>(number) + shift_;
        return of_mesh < welding_.vertex_of.size() ? welding_.vertex_of[of_mesh] : kUnused;
    }

    const GltfFile& file_;
    const Welding& welding_;
    uint32_t shift_;
    std::string place_;
};

/// What is to be added, modulo 2^32, to a vertex's number in the first primitive that has triangles.
uint32_t find_shift(GltfFile& file, size_t mesh_index, const Mesh& mesh, Scene& scene) {
    const std::vector<tinygltf::Primitive>& primitives = file.model.meshes[mesh_index].primitives;
    for (size_t i = 0; i < primitives.size(); ++i) {
        if (mesh.materials[i].begin == mesh.materials[i].end) continue;
        const uint64_t count = file.model.accessors[static_cast<size_t>(primitives[i].attributes.at("POSITION"))].count;
        const std::string place = fmt::format("/meshes/{}/primitives/{}", mesh_index, i);
        return mesh.corners[mesh.materials[i].begin].x - read_corners(file, primitives[i], count, place, scene)[0].x;
    }
    return 0;
}

void read_creases(GltfFile& file, size_t mesh_index, const Mesh& mesh, const Welding& welding,
                  const tinygltf::Value& subdivision, const std::string& place, Cage* cage, Scene& scene) {
    if (!subdivision.Has("creases") && !subdivision.Has("corners")) return;
    const uint32_t shift = find_shift(file, mesh_index, mesh, scene);
    if (subdivision.Has("creases")) {
        const std::vector<Edge> edges = edges_of(*cage);
        SharpnessReader(file, welding, shift, place + "/creases")
            .read<2>(subdivision.Get("creases"), [&](const Edge& ends, float sharpness) {
                const Edge edge = edge_of(ends[0], ends[1]);
                if (!std::binary_search(edges.begin(), edges.end(), edge)) {
                    scene.warn("a crease of a subdivision cage on an edge that no face has: ignored");
                    return;
                }
                cage->crease_edges.push_back(edge);
                cage->crease_sharpness.push_back(sharpness);
            });
    }
    if (subdivision.Has("corners")) {
        SharpnessReader(file, welding, shift, place + "/corners")
            .read<1>(subdivision.Get("corners"), [&](const std::array<uint32_t, 1>& vertex, float sharpness) {
                if (vertex[0] == SharpnessReader::kUnused) {
                    scene.warn("a corner of a subdivision cage at a vertex that no face has: ignored");
                    return;
                }
                cage->corner_vertices.push_back(vertex[0]);
                cage->corner_sharpness.push_back(sharpness);
            });
    }
}

void read_options(const GltfFile& file, const tinygltf::Value& subdivision, const std::string& place,
                  SubdivisionSurface* surface) {
    const auto word = [&](const char* name, const char* otherwise) {
        return subdivision.Has(name) ? subdivision.Get(name).Get<std::string>() : std::string(otherwise);
    };
    if (word("scheme", "catmull-clark") == "loop") surface->cage.scheme = SubdivisionScheme::kLoop;
    const std::string boundary = word("boundary", "edge-and-corner");
    surface->cage.boundary = boundary == "none"   ? BoundaryRule::kNone
                             : boundary == "edge" ? BoundaryRule::kEdge
                                                  : BoundaryRule::kEdgeAndCorner;
    if (subdivision.Has("level")) surface->options.level = subdivision.Get("level").GetNumberAsInt();
    if (!subdivision.Has("pixels")) return;
    surface->pixels = static_cast<float>(subdivision.Get("pixels").GetNumberAsDouble());
    if (!(surface->pixels > 0.0f)) file.fail(place + "/pixels", "it must be above 0");
}

}  // namespace

void read_surface(GltfFile& file, size_t mesh_index, Mesh& mesh, Scene& scene) {
    const tinygltf::Mesh& from = file.model.meshes[mesh_index];
    if (!from.extras.Has("subdivision")) return;
    const tinygltf::Value& subdivision = from.extras.Get("subdivision");
    const std::string place = fmt::format("/meshes/{}/extras/subdivision", mesh_index);
    if (!mesh.colors.empty()) scene.warn("vertex colours of a subdivision cage: ignored");
    SubdivisionSurface surface;
    read_options(file, subdivision, place, &surface);

    // Mirrored halves meet in 0 and -0, which are the same place.
    for (glm::vec3& p : mesh.positions) p += 0.0f;
    for (MorphTarget& target : mesh.targets) {
        for (glm::vec3& offset : target.positions) offset += 0.0f;
    }
    const Welding welding = weld(mesh);
    std::vector<MaterialRange> materials;
    std::vector<uint32_t> kept;
    uint32_t triangle_count = 0;
    for (size_t i = 0; i < from.primitives.size(); ++i) {
        const bool is_encoded =
            from.primitives[i].mode == TINYGLTF_MODE_TRIANGLES && from.primitives[i].extensions.contains("FB_ngon_encoding");
        Polygons polygons;
        append_polygons(mesh, mesh.materials[i], is_encoded, &polygons, scene);
        const uint32_t begin = triangle_count;
        size_t corner = 0;
        for (const uint32_t size : polygons.sizes) {
            const size_t face_count = surface.cage.face_sizes.size();
            append_face(std::span(polygons.corners).subspan(corner, size), welding, &surface.cage, &kept, scene);
            if (surface.cage.face_sizes.size() > face_count) triangle_count += surface.cage.face_sizes.back() - 2;
            corner += size;
        }
        materials.push_back({begin, triangle_count, mesh.materials[i].material});
    }
    if (surface.cage.face_sizes.empty()) {
        scene.warn("extras.subdivision on a mesh without faces: ignored");
        return;
    }
    for (size_t set = 0; set < kMaxUvSets; ++set) {
        if (!mesh.uvs[set].empty()) surface.cage.uvs[set] = weld_uvs(welding, mesh.uvs[set], kept);
    }
    read_creases(file, mesh_index, mesh, welding, subdivision, place, &surface.cage, scene);
    if (const std::string fault = check(surface.cage, welding.first.size(), surface.options.level); !fault.empty()) {
        file.fail(place, fault + " (vertices that are the same count as one)");
    }
    keep_welded(welding, &mesh);
    mesh.corners = split_faces(surface.cage);
    mesh.materials = std::move(materials);
    mesh.surface = std::move(surface);
}

}  // namespace zoe
