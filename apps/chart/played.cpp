#include "apps/chart/played.h"

#include <chrono>

#include "apps/chart/measure.h"
#include "apps/common/choose_view.h"
#include "apps/common/open_scene.h"
#include "engine/render/past_frame.h"
#include "engine/render/path.h"

namespace zoe::chart {
namespace {

constexpr double kFps = 24.0;
constexpr int kFirstFrame = 30;

}  // namespace

Played::Played(const Way& way) {
    Content content = open_scene("default", kFps);
    PastFrame past;
    for (int i = way.begin; i < kFrames; ++i) {
        stop_if_interrupted();
        const Tlas& tlas = advance(content, (kFirstFrame + i) / kFps, nullptr);
        const View view = ViewChoice{.camera = camera_nodes(content.scene).back()}.view(
            content.scene, float(way.width) / float(way.height));
        RenderConfig config;
        config.max_bounces = way.bounce_count;
        config.is_lit = way.is_lit;
        config.is_jittered = way.is_jittered;
        config.first_number = way.first_number + static_cast<uint32_t>(i * way.sample_count);
        Film& film = films.emplace_back(way.width, way.height);
        Guides& of_frame = guides.emplace_back();
        config.guides = &of_frame;
        of_frame.past = &past;
        const auto start = std::chrono::steady_clock::now();
        render(content.scene, tlas, view, config, way.sample_count, &film, nullptr);
        seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        of_frame.past = nullptr;  // What it holds is in the guides now.
        past.keep(tlas, view);
    }
    seconds /= kFrames - way.begin;
}

}  // namespace zoe::chart
