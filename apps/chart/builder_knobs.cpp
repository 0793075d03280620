#include "apps/chart/builder_knobs.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_sbvh.h"
#include "engine/bvh/build_sweep.h"
#include "engine/bvh/reinsert.h"

namespace zoe::chart {
namespace {

std::vector<Aabb> boxes_of(const WorldMesh& mesh) {
    std::vector<Aabb> boxes;
    for (uint32_t k = 0; k < mesh.corners().size(); ++k) boxes.push_back(bounds(mesh.triangle(k)));
    return boxes;
}

void finish(const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
    make_blas(scratch->bvh, mesh.positions(), mesh.corners(), blas, scratch);
}

void reinserted(const SweepConfig& sweep, const ReinsertConfig& config, const WorldMesh& mesh, Blas* blas,
                BlasScratch* scratch) {
    scratch->bvh = build_sweep(boxes_of(mesh), sweep, std::move(scratch->bvh));
    reinsert(&scratch->bvh, config);
    finish(mesh, blas, scratch);
}

void build_with(const ReinsertConfig& config, const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
    reinserted({}, config, mesh, blas, scratch);
}

void build_with(const SweepConfig& config, const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
    reinserted(config, {}, mesh, blas, scratch);
}

void build_with(const SbvhConfig& config, const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
    StaticBvh split = build_sbvh(mesh.positions(), mesh.corners(), config);
    reinsert(&split.tree);
    make_blas(split, mesh.positions(), mesh.corners(), blas, scratch);
    scratch->bvh = std::move(split.tree);
}

void build_with(const BinnedConfig& config, const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
    scratch->bvh = build_binned(boxes_of(mesh), config, std::move(scratch->bvh));
    finish(mesh, blas, scratch);
}

void build_with(const CollapseConfig& config, const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
    BinnedConfig binary = blas_binned_config();
    binary.max_leaf_size = std::min(binary.max_leaf_size, static_cast<int>(config.max_leaf_blocks * config.block_size));
    scratch->bvh = build_binned(boxes_of(mesh), binary, std::move(scratch->bvh));
    collapse(scratch->bvh, config, &blas->tree, &scratch->slots, &scratch->collapse);
    fill_blocks(scratch->slots, mesh.positions(), mesh.corners(), blas);
}

/// Adds the values of one setting.
template <typename Config, typename Number>
void add(const char* panel, const char* series, const Config& base, Number Config::*setting,
         std::initializer_list<Number> values, std::vector<Knob>* knobs) {
    for (const Number value : values) {
        Config config = base;
        config.*setting = value;
        knobs->push_back({.panel = panel,
                          .series = series,
                          .value = static_cast<double>(value),
                          .is_default = value == base.*setting,
                          .build = [config](const WorldMesh& mesh, Blas* blas, BlasScratch* scratch) {
                              build_with(config, mesh, blas, scratch);
                          }});
    }
}

}  // namespace

std::vector<Knob> builder_knobs() {
    const char *const once = "Sweep and reinsertion", *const split = "Spatial splits and reinsertion",
                      *const binned = "Binned";
    // As `build_blas` has it.
    const SbvhConfig sbvh{.max_reference_growth = 1.5f, .block_size = TriangleBlock::kSize, .node_cost = 0.5f};
    std::vector<Knob> knobs;
    add(once, "rounds", ReinsertConfig{}, &ReinsertConfig::max_rounds, {1, 2, 4, 8, 16}, &knobs);
    add(once, "share of nodes", ReinsertConfig{}, &ReinsertConfig::candidate_share, {0.125f, 0.25f, 0.5f, 1.0f}, &knobs);
    add(once, "visits a search", ReinsertConfig{}, &ReinsertConfig::max_visits, {25, 50, 100, 200, 400, 800}, &knobs);
    add(once, "least gain", ReinsertConfig{}, &ReinsertConfig::min_gain, {1e-4f, 1e-3f, 1e-2f}, &knobs);
    add(once, "leaf size", SweepConfig{}, &SweepConfig::max_leaf_size, {4, 8, 16}, &knobs);
    add(once, "node cost", SweepConfig{}, &SweepConfig::node_cost, {0.5f, 1.0f, 2.0f}, &knobs);
    add(split, "references", sbvh, &SbvhConfig::max_reference_growth, {1.0f, 1.1f, 1.2f, 1.5f, 2.0f}, &knobs);
    add(split, "overlap", sbvh, &SbvhConfig::min_overlap, {1e-6f, 1e-5f, 1e-4f, 1e-3f, 1e-2f}, &knobs);
    add(split, "spatial bins", sbvh, &SbvhConfig::bin_count, {8, 16, 32, 64}, &knobs);
    add(split, "leaf size", sbvh, &SbvhConfig::max_leaf_size, {4, 8, 16}, &knobs);
    add(split, "node cost", sbvh, &SbvhConfig::node_cost, {0.25f, 0.5f, 1.0f}, &knobs);
    add(binned, "leaf size", blas_binned_config(), &BinnedConfig::max_leaf_size, {4, 8, 16}, &knobs);
    add(binned, "node cost", blas_binned_config(), &BinnedConfig::node_cost, {0.25f, 0.5f, 1.0f, 2.0f}, &knobs);
    const CollapseConfig wide{.block_size = TriangleBlock::kSize};
    add("Wide nodes of binned trees", "leaf blocks", wide, &CollapseConfig::max_leaf_blocks, {1u, 2u, 4u, 8u, 16u}, &knobs);
    add("Wide nodes of binned trees", "block cost", wide, &CollapseConfig::block_cost, {0.35f, 0.5f, 0.7f, 1.0f, 1.4f},
        &knobs);
    return knobs;
}

}  // namespace zoe::chart
