#include "engine/deform/subdivide.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <stdexcept>

#include <glm/vec4.hpp>

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "engine/deform/subdivide_limit.h"

namespace zoe {

namespace {

namespace osd = OpenSubdiv;
using Level = osd::Far::TopologyLevel;
using Refiner = osd::Far::TopologyRefiner;
using Table = osd::Far::StencilTableReal<double>;
using subdivide_detail::View;

osd::Sdc::Options scheme_options(const Cage& cage) {
    using Sdc = osd::Sdc::Options;
    constexpr Sdc::VtxBoundaryInterpolation kBoundary[] = {Sdc::VTX_BOUNDARY_NONE, Sdc::VTX_BOUNDARY_EDGE_ONLY,
                                                           Sdc::VTX_BOUNDARY_EDGE_AND_CORNER};
    constexpr Sdc::FVarLinearInterpolation kUv[] = {Sdc::FVAR_LINEAR_NONE, Sdc::FVAR_LINEAR_CORNERS_ONLY,
                                                    Sdc::FVAR_LINEAR_BOUNDARIES, Sdc::FVAR_LINEAR_ALL};
    Sdc options;
    options.SetVtxBoundaryInterpolation(kBoundary[static_cast<int>(cage.boundary)]);
    options.SetFVarLinearInterpolation(kUv[static_cast<int>(cage.uv_rule)]);
    return options;
}

/// The sets of texture coordinates that a cage has; each is a channel of OpenSubdiv's, in this order.
std::vector<size_t> list_uv_sets(const Cage& cage) {
    std::vector<size_t> sets;
    for (size_t set = 0; set < kMaxUvSets; ++set) {
        if (!cage.uvs[set].corners.empty()) sets.push_back(set);
    }
    return sets;
}

std::vector<glm::vec2> refine_uvs(const CageUvs& cage, int channel, const Refiner& refiner, bool is_limit) {
    struct Uv {
        glm::vec2 value;
        void Clear() { value = glm::vec2(0.0f); }
        void AddWithWeight(const Uv& other, float weight) { value += weight * other.value; }
    };
    std::vector<Uv> source(cage.values.size()), made;
    for (size_t k = 0; k < source.size(); ++k) source[k].value = cage.values[k];
    const osd::Far::PrimvarRefinerReal<float> primvars(refiner);
    const auto resize_for = [&](int level) { made.resize(refiner.GetLevel(level).GetNumFVarValues(channel)); };
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        resize_for(level);
        primvars.InterpolateFaceVarying(level, source, made, channel);
        source.swap(made);
    }
    if (is_limit) {
        resize_for(refiner.GetMaxLevel());
        primvars.LimitFaceVarying(source, made, channel);
        source.swap(made);
    }
    std::vector<glm::vec2> uvs(source.size());
    for (size_t k = 0; k < uvs.size(); ++k) uvs[k] = source[k].value;
    return uvs;
}

std::unique_ptr<const Table> make_table(const Refiner& refiner) {
    using Factory = osd::Far::StencilTableFactoryReal<double>;
    Factory::Options options;
    options.generateOffsets = true;
    options.generateIntermediateLevels = false;
    options.maxLevel = refiner.GetMaxLevel();
    return std::unique_ptr<const Table>(Factory::Create(refiner, options));
}

/// By face of the last level, the face of the cage.
std::vector<uint32_t> find_cage_faces(const Refiner& refiner) {
    std::vector<uint32_t> faces(refiner.GetLevel(0).GetNumFaces()), children;
    for (uint32_t f = 0; f < faces.size(); ++f) faces[f] = f;
    for (int l = 1; l <= refiner.GetMaxLevel(); ++l) {
        const Level& level = refiner.GetLevel(l);
        children.resize(level.GetNumFaces());
        for (int f = 0; f < level.GetNumFaces(); ++f) children[f] = faces[level.GetFaceParentFace(f)];
        faces.swap(children);
    }
    return faces;
}

/// The indices of a corner's texture coordinates, one a channel.
using UvIndices = std::array<int, kMaxUvSets>;

/// Copies of the last level's vertices: one for each smooth sector with its texture coordinates, found by chains.
class Copies {
public:
    explicit Copies(int vertex_count) : first_(vertex_count, kNone) {}

    /// The copy of a vertex with this sector and these texture coordinates; made if new.
    uint32_t find(const View& view, int sector, const UvIndices& uvs) {
        uint32_t* link = &first_[view.vertex];
        while (*link != kNone) {
            Copy& copy = copies_[*link];
            if (copy.sector == sector && copy.uvs == uvs) return *link;
            link = &copy.next;
        }
        *link = static_cast<uint32_t>(copies_.size());
        const uint32_t made = *link;
        copies_.push_back({view, sector, kNone, uvs});
        return made;
    }

    /// Lists the copies in order of their vertices.
    /// Returns    by copy, its place in the list.
    std::vector<uint32_t> list(std::vector<View>* views, std::vector<UvIndices>* uvs) const {
        std::vector<uint32_t> places(copies_.size());
        for (const uint32_t first : first_) {
            for (uint32_t k = first; k != kNone; k = copies_[k].next) {
                places[k] = static_cast<uint32_t>(views->size());
                views->push_back(copies_[k].view);
                uvs->push_back(copies_[k].uvs);
            }
        }
        return places;
    }

private:
    static constexpr uint32_t kNone = UINT32_MAX;
    struct Copy {
        View view;
        int sector;
        uint32_t next;
        UvIndices uvs;
    };
    std::vector<uint32_t> first_;
    std::vector<Copy> copies_;
};

int place_in_ring(const Level& level, int vertex, int face) {
    const osd::Far::ConstIndexArray ring = level.GetVertexFaces(vertex);
    return static_cast<int>(std::find(ring.begin(), ring.end(), face) - ring.begin());
}

}  // namespace

std::unique_ptr<Refiner> subdivide_detail::make_refiner(const Cage& cage, size_t vertex_count, int level) {
    const std::vector<int> sizes(cage.face_sizes.begin(), cage.face_sizes.end());
    const std::vector<int> vertices(cage.vertices.begin(), cage.vertices.end());
    const std::vector<int> corners(cage.corner_vertices.begin(), cage.corner_vertices.end());
    std::vector<int> creases;
    for (const auto& [a, b] : cage.crease_edges) creases.insert(creases.end(), {static_cast<int>(a), static_cast<int>(b)});
    const auto clamped = [](std::vector<float> sharpness) {
        for (float& s : sharpness) s = std::min(s, osd::Sdc::Crease::SHARPNESS_INFINITE);
        return sharpness;
    };
    const std::vector<float> crease_sharpness = clamped(cage.crease_sharpness);
    const std::vector<float> corner_sharpness = clamped(cage.corner_sharpness);

    std::vector<std::vector<int>> uv_corners;
    std::vector<osd::Far::TopologyDescriptor::FVarChannel> uv_channels;
    for (const size_t set : list_uv_sets(cage)) {
        uv_corners.emplace_back(cage.uvs[set].corners.begin(), cage.uvs[set].corners.end());
        uv_channels.emplace_back();
        uv_channels.back().numValues = static_cast<int>(cage.uvs[set].values.size());
        uv_channels.back().valueIndices = uv_corners.back().data();
    }
    osd::Far::TopologyDescriptor mesh;
    mesh.numVertices = static_cast<int>(vertex_count);
    mesh.numFaces = static_cast<int>(sizes.size());
    mesh.numVertsPerFace = sizes.data();
    mesh.vertIndicesPerFace = vertices.data();
    mesh.numCreases = static_cast<int>(crease_sharpness.size());
    mesh.creaseVertexIndexPairs = creases.data();
    mesh.creaseWeights = crease_sharpness.data();
    mesh.numCorners = static_cast<int>(corners.size());
    mesh.cornerVertexIndices = corners.data();
    mesh.cornerWeights = corner_sharpness.data();
    mesh.numFVarChannels = static_cast<int>(uv_channels.size());
    mesh.fvarChannels = uv_channels.data();

    using Factory = osd::Far::TopologyRefinerFactory<osd::Far::TopologyDescriptor>;
    const bool is_loop = cage.scheme == SubdivisionScheme::kLoop;
    const Factory::Options options(is_loop ? osd::Sdc::SCHEME_LOOP : osd::Sdc::SCHEME_CATMARK, scheme_options(cage));
    std::unique_ptr<Refiner> refiner(Factory::Create(mesh, options));
    if (!refiner) throw std::runtime_error("OpenSubdiv refuses the subdivision cage");
    if (level == 0) return refiner;
    Refiner::UniformOptions uniform(level);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    return refiner;
}

Subdivision make_subdivision(const Cage& cage, size_t vertex_count, const SubdivisionOptions& options) {
    assert(check(cage, vertex_count, options.level).empty());
    const std::unique_ptr<Refiner> refiner = subdivide_detail::make_refiner(cage, vertex_count, options.level);
    const Level& level = refiner->GetLevel(options.level);
    const std::vector<uint32_t> cage_faces = find_cage_faces(*refiner);
    const std::vector<size_t> uv_sets = list_uv_sets(cage);
    const int channel_count = static_cast<int>(uv_sets.size());

    Subdivision result;
    Copies copies(level.GetNumVertices());
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        if (level.IsFaceHole(f)) continue;
        const osd::Far::ConstIndexArray vertices = level.GetFaceVertices(f);
        glm::uvec4 corners(0u);
        for (int k = 0; k < vertices.size(); ++k) {
            const View view = {vertices[k], place_in_ring(level, vertices[k], f)};
            const int sector = options.normals ? subdivide_detail::find_sector(level, view.vertex, view.face).first : 0;
            UvIndices uvs{};
            for (int channel = 0; channel < channel_count; ++channel) uvs[channel] = level.GetFaceFVarValues(f, channel)[k];
            corners[k] = copies.find(view, sector, uvs);
        }
        result.corners.emplace_back(corners[0], corners[1], corners[2]);
        if (vertices.size() == 4) result.corners.emplace_back(corners[0], corners[2], corners[3]);
        result.cage_faces.resize(result.corners.size(), cage_faces[f]);
    }

    std::vector<View> views;
    std::vector<UvIndices> uv_indices;
    const std::vector<uint32_t> places = copies.list(&views, &uv_indices);
    for (glm::uvec3& triangle : result.corners) triangle = {places[triangle[0]], places[triangle[1]], places[triangle[2]]};
    for (int channel = 0; channel < channel_count; ++channel) {
        const size_t set = uv_sets[channel];
        const std::vector<glm::vec2> uvs = refine_uvs(cage.uvs[set], channel, *refiner, options.limit_positions);
        result.uvs[set].reserve(views.size());
        for (const UvIndices& indices : uv_indices) result.uvs[set].push_back(uvs[indices[channel]]);
    }
    result.stencils =
        subdivide_detail::compose_stencils(*refiner, *make_table(*refiner), views, options.limit_positions, options.normals);
    return result;
}

}  // namespace zoe
