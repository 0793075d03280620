#include "engine/render/path.h"

#include <algorithm>
#include <cassert>
#include <chrono>

#include "engine/math/parallel.h"
#include "engine/render/guides.h"
#include "engine/render/layers.h"
#include "engine/render/tile.h"

namespace zoe {

namespace {

constexpr int kTileWidth = 32, kTileHeight = 8;  // 256 paths: enough to fill a batch, few enough to stay in the cache

/// Kept by each thread that calls `render`, so that a frame allocates nothing once sizes have settled.
struct Workspace {
    Film film;
    Lighting lighting;
    Glow glow;
    std::vector<TileStats> stats;  // [tile_count]
};

/// Copies what the samples add to, and where they write them, the layers.
void copy_sums(const Film& film, bool has_layers, Film* copy) {
    copy->width = film.width;
    copy->height = film.height;
    copy->sum = film.sum;
    if (!has_layers) return;
    copy->depth = film.depth;
    copy->node = film.node;
    copy->primitive = film.primitive;
}

void add(const FrameStats::Kind& from, FrameStats::Kind* to) {
    to->rays += from.rays;
    to->ms += from.ms / thread_count();
}

/// Sums in order of the tiles, so that counts do not depend on threads.
void add_stats(std::span<const TileStats> tiles, double trace_ms, FrameStats* stats) {
    for (const TileStats& tile : tiles) {
        add(tile.primary, &stats->primary);
        add(tile.diffuse, &stats->diffuse);
        add(tile.shadow, &stats->shadow);
        stats->rays += tile.primary.rays + tile.diffuse.rays + tile.shadow.rays;
        stats->hits += tile.hits;
        stats->hits_hash += tile.hits_hash;
    }
    stats->trace_ms += trace_ms;
}

/// Tells whether light passes some material on show, be it from one side only.
bool lets_light_pass(const Scene& scene, const Tlas& tlas) {
    const auto does = [&](const MaterialRange& range) {
        if (range.material == kNone<MaterialId>) return true;
        const Material& material = scene.materials[index(range.material)];
        return !material.is_double_sided || material.alpha_mode != AlphaMode::kOpaque || material.transmission > 0.0f;
    };
    return std::ranges::any_of(tlas.instances, [&](const Instance& instance) {
        const auto& ranges = instance.mesh->materials;
        return ranges.empty() || std::ranges::any_of(ranges, does);
    });
}

}  // namespace

std::optional<Shade> shade_from_name(std::string_view name) {
    if (name == "path") return Shade::kPath;
    if (name == "albedo") return Shade::kAlbedo;
    if (name == "normal") return Shade::kNormal;
    if (name == "motion") return Shade::kMotion;
    if (name == "cost") return Shade::kCost;
    return std::nullopt;
}

bool render(const Scene& scene, const Tlas& tlas, const View& view, const RenderConfig& config, int sample_count, Film* film,
            FrameStats* stats) {
    assert(film != nullptr && film->width > 0 && film->height > 0 && sample_count >= 0 && config.max_bounces >= 0);
    const RayBatch batch(tlas.watch.get());
    const auto start = std::chrono::steady_clock::now();
    static thread_local Workspace workspace;
    // The layers are the first sample's, which is of one time only where there are no slices.
    const bool has_layers = !config.slice && film->sample_count == 0 && sample_count > 0;
    copy_sums(*film, has_layers, &workspace.film);
    Guides* const guides = has_layers ? config.guides : nullptr;
    Layers* const layers = has_layers ? config.layers : nullptr;
    if (guides != nullptr) guides->start(film->width, film->height);
    if (layers != nullptr) layers->start(film->width, film->height);
    gather_lights(scene, config, &workspace.lighting);
    workspace.glow.gather(scene, tlas);
    const Pass pass{.scene = scene,
                    .tlas = tlas,
                    .view = view,
                    .config = config,
                    .lighting = workspace.lighting,
                    .glow = workspace.glow,
                    .lets_light_pass = lets_light_pass(scene, tlas),
                    .guides = guides,
                    .layers = layers,
                    .first_sample = film->sample_count,
                    .sample_count = sample_count,
                    .enough = film->enough,
                    .slice = config.slice.value_or(Slice{}),
                    .has_layers = has_layers};

    const int tiles_across = (film->width + kTileWidth - 1) / kTileWidth;
    const int tiles_down = (film->height + kTileHeight - 1) / kTileHeight;
    const size_t tile_count = static_cast<size_t>(tiles_across) * static_cast<size_t>(tiles_down);
    workspace.stats.assign(tile_count, {});
    Film* const working = &workspace.film;
    TileStats* const tile_stats = workspace.stats.data();
    std::atomic<bool> is_cancelled = false;
    parallel_for(0, tile_count, 1, [&](size_t begin, size_t end) {
        static thread_local TileTracer tracer;
        for (size_t i = begin; i < end && !is_cancelled; ++i) {
            const int x = static_cast<int>(i % static_cast<size_t>(tiles_across)) * kTileWidth;
            const int y = static_cast<int>(i / static_cast<size_t>(tiles_across)) * kTileHeight;
            const Tile tile{x, y, std::min(x + kTileWidth, film->width), std::min(y + kTileHeight, film->height)};
            if (!tracer.trace(pass, tile, working, &tile_stats[i])) is_cancelled = true;
        }
    });
    if (is_cancelled) return false;

    std::swap(film->sum, working->sum);
    if (has_layers) {
        std::swap(film->depth, working->depth);
        std::swap(film->node, working->node);
        std::swap(film->primitive, working->primitive);
    }
    if (pass.slice.number + 1 == pass.slice.count) film->sample_count += sample_count;
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    if (stats != nullptr) add_stats(workspace.stats, elapsed.count(), stats);
    return true;
}

}  // namespace zoe
