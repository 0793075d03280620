#include "engine/frame/open_instances.h"

#include <algorithm>
#include <cstring>
#include <tuple>

namespace zoe {

namespace {

// The largest is opened first; of equal ones the first.
bool is_later(const OpenedPart& a, const OpenedPart& b) {
    const auto key = [](const OpenedPart& p) { return std::tuple(-p.box.half_area(), p.part.instance, p.part.start); };
    return key(a) > key(b);
}

// Children that may be hit.
template <typename Found>
void for_each_child(const WideNode& node, Found&& found) {
    for (int slot = 0; slot < kWidth; ++slot) {
        if (node.child[slot] == kEmptyChild) continue;
        const Aabb box = node.box(slot);
        if (!box.is_empty()) found(node.child[slot], box);
    }
}

bool is_same(const std::vector<OpenedPart>& a, const std::vector<OpenedPart>& b) {
    static_assert(sizeof(OpenedPart) == 2 * sizeof(uint32_t) + sizeof(Aabb), "no gaps between numbers");
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(OpenedPart)) == 0);
}

// Fills scratch->parts with what stands for the instances that are opened.
void choose(const PlacingConfig& config, const std::vector<uint32_t>& instances, const Tlas& tlas, OpeningScratch* scratch) {
    std::vector<OpenedPart>&open = scratch->open, &parts = scratch->parts;
    const double least_area = double(config.least_share) * tlas.bounds_world.half_area();
    const auto put = [&](const OpenedPart& part) {
        if (is_leaf(part.part.start) || part.box.half_area() < least_area) {
            if (part.part.start != 0) parts.push_back(part);
            return;
        }
        open.push_back(part);
        std::push_heap(open.begin(), open.end(), is_later);
    };
    for (const uint32_t instance : instances) put({{instance, 0}, tlas.instances[instance].bounds_world});
    for (uint32_t more = 0; !open.empty();) {
        const OpenedPart largest = open.front();
        const WideNode& node = tlas.instances[largest.part.instance].blas->tree.nodes[largest.part.start];
        uint32_t count = 0;
        for_each_child(node, [&](uint32_t, const Aabb&) { ++count; });
        more += count - 1;
        if (more > config.most_parts) break;
        std::pop_heap(open.begin(), open.end(), is_later);
        open.pop_back();
        for_each_child(node, [&](uint32_t child, const Aabb& box) { put({{largest.part.instance, child}, box}); });
    }
    for (const OpenedPart& part : open) {
        if (part.part.start != 0) parts.push_back(part);
    }
    // Parts of an instance side by side.
    std::sort(parts.begin(), parts.end(), [](const OpenedPart& a, const OpenedPart& b) {
        return std::tie(a.part.instance, a.part.start) < std::tie(b.part.instance, b.part.start);
    });
}

}  // namespace

bool open_instances(const PlacingConfig& config, const std::vector<uint32_t>& instances, Tlas* tlas,
                    OpeningScratch* scratch) {
    scratch->last.swap(scratch->parts);
    scratch->open.clear();
    scratch->parts.clear();
    // A single one is traced without a top level.
    if (config.most_parts > 0 && tlas->instances.size() > 1) choose(config, instances, *tlas, scratch);
    uint32_t last_instance = kNoInstance;
    for (const auto& [part, box] : scratch->parts) {
        if (part.instance != last_instance) {
            tlas->parts[part.instance] = part;
            tlas->boxes[part.instance] = box;
        } else {
            tlas->parts.push_back(part);
            tlas->boxes.push_back(box);
        }
        last_instance = part.instance;
    }
    return !is_same(scratch->parts, scratch->last);
}

}  // namespace zoe
