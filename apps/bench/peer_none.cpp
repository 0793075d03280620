// What takes Embree's place in a program that is built without it.

#include "apps/bench/peer_embree.h"
#include "apps/bench/peer_tree.h"
#include "apps/common/usage_error.h"

namespace zoe {
namespace {

[[noreturn]] void refuse() {
    throw UsageError("--peer embree: built without Embree: install libembree-dev, configure and build again");
}

}  // namespace

bool is_embree_available() {
    return false;
}

struct EmbreePeer::State {};

EmbreePeer::EmbreePeer(const EmbreeConfig&, int) {
    refuse();
}

EmbreePeer::~EmbreePeer() = default;

std::string EmbreePeer::version() {
    refuse();
}

EmbreePeer::UpdateTimes EmbreePeer::update(const Scene&, const Tlas&) {
    refuse();
}

double EmbreePeer::closest_hits(std::span<const Ray>, RayKind, std::span<Hit>) {
    refuse();
}

double EmbreePeer::any_hits(std::span<const Ray>, RayKind, std::span<uint8_t>) {
    refuse();
}

void EmbreePeer::set_rays(RayKind, EmbreeRays) {
    refuse();
}

struct PeerTree::State {};

PeerTree::PeerTree(Quality, bool, std::span<const glm::vec3>, std::span<const glm::uvec3>, int) {
    refuse();
}

PeerTree::~PeerTree() = default;
PeerTree::PeerTree(PeerTree&&) noexcept = default;
PeerTree& PeerTree::operator=(PeerTree&&) noexcept = default;

double PeerTree::rebuild() {
    refuse();
}

double PeerTree::build_ms() const {
    refuse();
}

uint64_t PeerTree::byte_count() const {
    refuse();
}

double PeerTree::closest_hits(std::span<const Ray>, EmbreeRays, std::span<Hit>) {
    refuse();
}

double PeerTree::any_hits(std::span<const Ray>, EmbreeRays, std::span<uint8_t>) {
    refuse();
}

}  // namespace zoe
