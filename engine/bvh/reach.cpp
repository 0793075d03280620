#include "engine/bvh/reach.h"

#include <algorithm>
#include <cmath>

#include "engine/bvh/traverse.h"

namespace zoe {

namespace {

constexpr int kCells = Reach::kCells;
constexpr float kSmallest = 1e-30f, kLargest = 1e30f;  // Numbers whose reciprocals are good.
constexpr int kMostVisits = 256;                       // Nodes and leaves that are looked into for a direction.

// Looks for the largest dot product of a direction with a corner.
class Search {
public:
    explicit Search(const Blas& blas) : blas_(blas) {}

    double farthest(const glm::dvec3& direction) {
        double most = -HUGE_VAL;
        waiting_.assign(1, {HUGE_VAL, 0});
        for (int visits = 0; !waiting_.empty(); ++visits) {
            const Waiting at = waiting_.back();
            waiting_.pop_back();
            if (!(at.most > most)) continue;
            if (visits >= kMostVisits) {
                most = at.most;
            } else if (is_leaf(at.child)) {
                most = std::max(most, farthest_corner(at.child, direction));
            } else {
                open(blas_.tree.nodes[at.child], direction, most);
            }
        }
        return most;
    }

private:
    struct Waiting {
        double most;  // No corner in it reaches farther.
        uint32_t child;
    };

    // The child that may reach farthest comes last.
    void open(const WideNode& node, const glm::dvec3& direction, double most) {
        const auto first = static_cast<std::ptrdiff_t>(waiting_.size());
        for (int slot = 0; slot < kWidth; ++slot) {
            const Aabb box = node.box(slot);
            if (box.is_empty()) continue;
            double reach = 0.0;
            for (int k = 0; k < 3; ++k) reach += std::max(direction[k] * box.lo[k], direction[k] * box.hi[k]);
            if (reach > most) waiting_.push_back({reach, node.child[slot]});
        }
        std::sort(waiting_.begin() + first, waiting_.end(),
                  [](const Waiting& a, const Waiting& b) { return a.most < b.most; });
    }

    double farthest_corner(uint32_t leaf, const glm::dvec3& direction) const {
        double most = -HUGE_VAL;
        for (uint32_t k = 0; k < block_count(leaf); ++k) {
            const TriangleBlock& block = blas_.blocks[first_block(leaf) + k];
            for (int corner = 0; corner < 9; corner += 3) {
                for (uint32_t slot = 0; slot < TriangleBlock::kSize; ++slot) {
                    const double reach = direction.x * block.corners[corner][slot] +
                                         direction.y * block.corners[corner + 1][slot] +
                                         direction.z * block.corners[corner + 2][slot];
                    if (reach > most) most = reach;  // False for NaN: no triangle.
                }
            }
        }
        return most;
    }

    const Blas& blas_;
    std::vector<Waiting> waiting_;
};

// None of what follows branches on numbers that are other ones for each instance: glm's `abs` and `[]` do.
glm::vec3 absolute(const glm::vec3& v) {
    return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}
float largest(const glm::vec3& v) {
    return std::max(v.x, std::max(v.y, v.z));
}

// Whether a ray's transform there and back keeps to kMostSpread.
bool is_gentle(const glm::mat3& there, const glm::mat3& back) {
    const glm::vec3 sums = absolute(back[0]) + absolute(back[1]) + absolute(back[2]);
    const glm::vec3 spread = absolute(there[0]) * sums.x + absolute(there[1]) * sums.y + absolute(there[2]) * sums.z;
    // False for NaN.
    return (spread.x <= kMostSpread) & (spread.y <= kMostSpread) & (spread.z <= kMostSpread);
}

// How far a scaled mesh reaches along a direction and against it.
struct Ends {
    float along, against;
};
Ends ends_of(const Reach& reach, const glm::vec3& to) {
    // Bit 0 is x > y, bit 1 x > z, bit 2 y > z.
    static constexpr uint8_t kLongest[8] = {2, 2, 2, 0, 1, 2, 1, 0};
    const glm::vec3 size = absolute(to);
    const int axis = kLongest[int(size.x > size.y) | int(size.x > size.z) << 1 | int(size.y > size.z) << 2];
    const float direction[5] = {to.x, to.y, to.z, to.x, to.y};
    const float inverse = 1.0f / direction[axis];
    const float x = 0.5f * kCells * (direction[axis + 1] * inverse + 1.0f);
    const float y = 0.5f * kCells * (direction[axis + 2] * inverse + 1.0f);
    const int i = std::min(static_cast<int>(x), kCells - 1), j = std::min(static_cast<int>(y), kCells - 1);
    const float u = x - static_cast<float>(i), v = y - static_cast<float>(j);
    // Two points of the grid stand side by side, each with its opposite.
    const float *low = reach.farthest[axis][j][i], *high = reach.farthest[axis][j + 1][i];
    float between[4];
    for (int k = 0; k < 4; ++k) between[k] = low[k] + v * (high[k] - low[k]);
    float ends[2];
    for (int k = 0; k < 2; ++k) ends[k] = std::abs(direction[axis]) * (between[k] + u * (between[k + 2] - between[k]));
    const int is_backward = direction[axis] < 0.0f;
    return {ends[is_backward], ends[1 - is_backward]};
}

}  // namespace

void measure_reach(const Blas& blas, Reach* reach) {
    Search search(blas);
    const Aabb bounds = blas.tree.bounds();
    const glm::vec3 size = 0.5f * bounds.extent();
    reach->centre = bounds.centre();
    // A flat axis is scaled as the widest one: it must not outweigh those that reach somewhere.
    const float widest = largest(size);
    for (int k = 0; k < 3; ++k) reach->scale[k] = size[k] >= kSmallest ? size[k] : widest >= kSmallest ? widest : 1.0f;
    for (int axis = 0; axis < 3; ++axis) {
        for (int row = 0; row <= kCells; ++row) {
            for (int column = 0; column <= kCells; ++column) {
                glm::dvec3 direction;
                direction[axis] = 1.0;
                direction[(axis + 1) % 3] = 2.0 * column / kCells - 1.0;
                direction[(axis + 2) % 3] = 2.0 * row / kCells - 1.0;
                direction /= glm::dvec3(reach->scale);
                float* farthest = reach->farthest[axis][row][column];
                const double shift = glm::dot(direction, glm::dvec3(reach->centre));
                farthest[0] = static_cast<float>(search.farthest(direction) - shift);
                farthest[1] = static_cast<float>(search.farthest(-direction) + shift);
            }
        }
    }
}

Aabb tight_bounds(const Reach& reach, const Affine& world_from_local, const Affine& local_from_world,
                  const Aabb& bounds_world) {
    if (!is_gentle(world_from_local.linear, local_from_world.linear)) return bounds_world;
    const glm::mat3& m = world_from_local.linear;
    // The world's axes to the scaled mesh.
    const glm::vec3 rows[3] = {reach.scale * glm::vec3(m[0].x, m[1].x, m[2].x),
                               reach.scale * glm::vec3(m[0].y, m[1].y, m[2].y),
                               reach.scale * glm::vec3(m[0].z, m[1].z, m[2].z)};
    const glm::vec3 sizes(largest(absolute(rows[0])), largest(absolute(rows[1])), largest(absolute(rows[2])));
    const float least = std::min(sizes.x, std::min(sizes.y, sizes.z));
    if (!(least >= kSmallest && largest(sizes) <= kLargest)) return bounds_world;
    const Ends x = ends_of(reach, rows[0]), y = ends_of(reach, rows[1]), z = ends_of(reach, rows[2]);
    const glm::vec3 centre = world_from_local.point(reach.centre);
    const glm::vec3 lo = centre - glm::vec3(x.against, y.against, z.against);
    const glm::vec3 hi = centre + glm::vec3(x.along, y.along, z.along);
    const float pad = kTightSlack * (std::max(largest(absolute(lo)), largest(absolute(hi))) +
                                     largest(absolute(world_from_local.translation)));
    // bounds_world where numbers overflowed: comparisons with NaN are false.
    const auto later = [&](float bound, float at) { return at - pad > bound ? at - pad : bound; };
    const auto earlier = [&](float bound, float at) { return at + pad < bound ? at + pad : bound; };
    const Aabb& all = bounds_world;
    return {{later(all.lo.x, lo.x), later(all.lo.y, lo.y), later(all.lo.z, lo.z)},
            {earlier(all.hi.x, hi.x), earlier(all.hi.y, hi.y), earlier(all.hi.z, hi.z)}};
}

}  // namespace zoe
