#pragma once

#include <glm/vec3.hpp>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/render/film.h"
#include "engine/render/guides.h"
#include "engine/render/past_frame.h"
#include "engine/render/path.h"

namespace zoe::test {

inline constexpr uint32_t kNoNode = 0xffffffffu;

struct Size {
    int width, height;
};

/// What radiance is divided by to have light.
inline glm::dvec3 divisor(const glm::vec3& albedo) {
    return 0.04 + 0.96 * glm::dvec3(albedo);
}

/// Where a pixel's centre lies between those of another picture.
inline double place(int i, int count, int from_count) {
    return (i + 0.5) * from_count / count - 0.5;
}

/// The default scene, seen by the camera that swings.
class Frames {
public:
    Frames() {
        for (uint32_t i = 0; i < content_.scene.nodes.size(); ++i) {
            if (content_.scene.nodes[i].name == "swing") camera_ = NodeId{i};
        }
    }
    void advance_to(double time_s) {
        if (tlas_ != nullptr) past_.keep(*tlas_, view_);
        tlas_ = &advance(content_.scene, time_s);
        view_ = view_from_camera(content_.scene, camera_, 16.0f / 9.0f);
    }
    Film sample(const Size& size, bool is_lit, Guides* seen, int sample_count = 1, uint32_t first_number = 0,
                FrameStats* stats = nullptr) const {
        RenderConfig config;
        config.is_jittered = false;
        config.is_lit = is_lit;
        config.max_bounces = 2;
        config.first_number = first_number;
        config.guides = seen;
        if (seen != nullptr) seen->past = &past_;
        Film film(size.width, size.height);
        render(content_.scene, *tlas_, view_, config, sample_count, &film, stats);
        return film;
    }

private:
    Content content_ = make_content("default");
    NodeId camera_ = kNone<NodeId>;
    const Tlas* tlas_ = nullptr;
    View view_;
    PastFrame past_;
};

}  // namespace zoe::test
