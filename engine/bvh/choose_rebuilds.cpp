#include "engine/bvh/choose_rebuilds.h"

#include <algorithm>

#include "engine/bvh/blas.h"

namespace zoe {

namespace {

constexpr size_t kLookedAt = 128;  // Blocks of a large tree, that stand for all.

// New trees of one mesh differ by as much from pose to pose, and those that are built in a frame from those that took
// longer: a tree that seems to cost so much more than it did may be as good as any.
constexpr double kSame = 1.1;

constexpr double kJump = 2.0;  // What the cost beside a new tree's is multiplied by in one refit, where the mesh jumps.

// Jumps, one as long after the other as that after the one before it, from which on more are expected to come: one alone may
// be that of a pose which comes back.
constexpr uint32_t kRegular = 2;

// Whether a tree has lost what its rebuild costs, and as much more as it has to while that is dear beside all other work.
bool is_due(double share, double build_work, const TreeWatch& watch) {
    if (!(watch.lost_work > 0.0)) return false;
    const double by_jump = watch.lost_work - watch.frame_loss + watch.coming_work;  // Until the next one.
    const double since_build = watch.needed_work + watch.lost_work;
    const bool is_held = watch.coming_work > 0.0 && by_jump >= build_work;
    const double spare = watch.regular_jumps >= kRegular ? watch.spare_work : 0.0;
    if (is_held && build_work <= since_build + spare) return true;
    if (watch.lost_work < build_work) return false;
    const bool is_cheap = build_work <= share * since_build;
    return is_cheap || watch.frame_loss >= build_work || watch.lost_work >= build_work + watch.needed_work;
}

// Half areas of the boxes around a block's triangles. NaN, where there is none that can be hit, adds nothing.
double sum_areas(const TriangleBlock& block) {
    constexpr uint32_t kSize = TriangleBlock::kSize;
    double extents[3][kSize];
    for (int axis = 0; axis < 3; ++axis) {
        const float *const a = block.corners[axis], *const b = block.corners[axis + 3], *const c = block.corners[axis + 6];
        for (uint32_t slot = 0; slot < kSize; ++slot) {
            const float lo = std::min(std::min(a[slot], b[slot]), c[slot]);
            const float hi = std::max(std::max(a[slot], b[slot]), c[slot]);
            extents[axis][slot] = double(hi) - lo;
        }
    }
    double sum = 0.0;
    for (uint32_t slot = 0; slot < kSize; ++slot) {
        const double x = extents[0][slot], y = extents[1][slot], z = extents[2][slot];
        const double area = x * y + y * z + z * x;
        sum += area >= 0.0 ? area : 0.0;
    }
    return sum;
}

}  // namespace

TreeReading read_tree(const Blas& blas) {
    const double root_area = blas.tree.bounds().half_area();
    if (!(root_area > 0.0)) return {};
    const size_t stride = std::max<size_t>(1, blas.blocks.size() / kLookedAt);
    double area = 0.0;
    for (size_t k = 0; k < blas.blocks.size(); k += stride) area += sum_areas(blas.blocks[k]);
    return {blas.tree.summed_cost(), static_cast<double>(stride) * area / root_area};
}

void note_build(const TreeReading& built, uint32_t triangle_count, TreeWatch* watch) {
    // Hindsight has lost `least` or rebuilt, too; what a first build takes, nobody chose.
    const double least = std::min(watch->lost_work, watch->build_work);
    const double done = watch->needed_work + (watch->lost_work - watch->frame_loss) + watch->build_work;
    const double spare = watch->spare_work + 2.0 * (watch->needed_work + least) - done;
    *watch = {.triangle_count = triangle_count,
              .built = built,
              .new_cost = built.cost,
              .held = watch->held,
              .since_jump = watch->since_jump,
              .regular_jumps = watch->regular_jumps,
              .build_work = watch->build_work,
              .spare_work = std::max(0.0, spare),
              .open_work = watch->build_work - least,
              .open_loss = watch->ray_loss};
}

void note_refit(const TreeReading& refitted, TreeWatch* watch) {
    const TreeReading& built = watch->built;
    if (refitted.cost != built.cost) watch->open_work = 0.0;
    const bool is_smaller = refitted.triangle_area < built.triangle_area;
    const double of_root = std::min(built.cost, 1.0), of_rest = built.cost - of_root;
    const double new_cost = of_root + (is_smaller ? of_rest * refitted.triangle_area / built.triangle_area : of_rest);
    const double loss = refitted.cost - new_cost;
    watch->ray_loss = refitted.cost > kSame * new_cost ? loss : 0.0;
    watch->new_cost = std::min(refitted.cost, new_cost);
    const double growth = watch->new_cost > 0.0 ? refitted.cost / watch->new_cost : 1.0;
    if (growth > kJump * watch->growth) {
        const uint64_t held = watch->since_jump > 0 ? watch->since_jump - 1 : 0;
        watch->regular_jumps = watch->since_jump > 0 && held == watch->held ? watch->regular_jumps + 1 : 0;
        watch->held = held;
        watch->since_jump = 1;
    }
    watch->growth = growth;
}

void add_loss(double rays, double build_work, TreeWatch* watch) {
    const double lost_in_hindsight = std::min(watch->open_work, rays * watch->open_loss);
    watch->open_work -= lost_in_hindsight;
    watch->spare_work += 2.0 * lost_in_hindsight;
    watch->build_work = build_work;
    watch->frame_loss = rays * watch->ray_loss;
    watch->lost_work += watch->frame_loss;
    watch->needed_work += rays * watch->new_cost;
    const uint64_t gone = watch->since_jump > 0 ? watch->since_jump++ - 1 : 0;
    watch->coming_work = watch->held > gone ? static_cast<double>(watch->held - gone) * watch->frame_loss : 0.0;
}

void choose_rebuilds(const RebuildConfig& config, std::span<const TreeWatch* const> watches, std::vector<uint32_t>* chosen) {
    chosen->clear();
    const auto build_work = [&](uint32_t k) { return config.triangle_work * watches[k]->triangle_count; };
    double budget = 0.0;
    for (uint32_t k = 0; k < watches.size(); ++k) {
        budget += config.most_share * build_work(k);
        if (is_due(config.share, build_work(k), *watches[k])) chosen->push_back(k);
    }
    const auto is_worse = [&](uint32_t a, uint32_t b) {
        const double left = watches[a]->lost_work * watches[b]->triangle_count;
        const double right = watches[b]->lost_work * watches[a]->triangle_count;
        return left != right ? left > right : a < b;
    };
    std::sort(chosen->begin(), chosen->end(), is_worse);
    size_t count = 0;
    double spent = 0.0;
    for (const uint32_t k : *chosen) {
        if (watches[k]->frame_loss < build_work(k)) {
            if (count > 0 && spent + build_work(k) > budget) continue;
            spent += build_work(k);
        }
        (*chosen)[count++] = k;
    }
    chosen->resize(count);
}

}  // namespace zoe
