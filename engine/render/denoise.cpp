#include "engine/render/denoise.h"

#include <cassert>
#include <limits>
#include <utility>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kRowGrain = 4;

void start(size_t count, DenoiseLight* light) {
    for (std::vector<float>* plane : {&light->red, &light->green, &light->blue, &light->variance})
        plane->assign(count, 0.0f);
}

void start(size_t count, DenoiseShape* shape) {
    for (std::vector<float>* plane : {&shape->x, &shape->y, &shape->z, &shape->slope}) plane->assign(count, 0.0f);
    shape->depth.assign(count, std::numeric_limits<float>::infinity());
    shape->node.assign(count, 0xffffffffu);
}

void start(size_t count, DenoiseMoments* moments) {
    for (std::vector<float>* plane : {&moments->mean, &moments->square, &moments->frames}) plane->assign(count, 0.0f);
}

}  // namespace

void DenoiseFrame::resize(size_t width, size_t height) {
    grid = {width, height};
    const size_t count = grid.count();
    assert(count < size_t{1} << 31 && height < 1 << 16 && width < 1 << 16);
    for (DenoiseLight* some : {&sample, &light, &past_light}) start(count, some);
    for (DenoiseShape* some : {&shape, &past_shape}) start(count, some);
    for (DenoiseMoments* some : {&moments, &past_moments}) start(count, some);
    for (std::vector<float>* plane : {&brightness, &known}) plane->assign(count, 0.0f);
}

void Denoiser::filter(const Guides& guides, const DenoiseConfig& config, Film* film) {
    assert(film->sample_count > 0 && film->width == guides.width && film->height == guides.height);
    assert(config.most_frames >= 1 && config.rounds >= 1 && config.rounds <= 16);
    const size_t width = static_cast<size_t>(film->width), height = static_cast<size_t>(film->height);
    if (frame_.grid.width != width || frame_.grid.height != height) {
        frame_.resize(width, height);
        start(frame_.grid.count(), &smoothed_);
        is_first_ = true;
    }
    frame_.has_past = !is_first_;
    const auto on_rows = [&](auto&& pass) { parallel_for(0, height, kRowGrain, pass); };
    const auto sample_count = static_cast<float>(film->sample_count);
    glm::vec4* const sums = film->sum.data();
    on_rows([&](size_t begin, size_t end) { take_in_rows(guides, sums, 1.0f / sample_count, &frame_, begin, end); });
    on_rows(
        [&](size_t begin, size_t end) { follow_rows(guides, static_cast<float>(config.most_frames), &frame_, begin, end); });
    // The mean is handed on as it is: what is smoothed would be smoothed again in every frame. The sample is done with.
    const DenoiseLight* from = &frame_.light;
    DenoiseLight *to = &smoothed_, *other = &frame_.sample;
    for (int round = 0; round < config.rounds; ++round) {
        on_rows([&](size_t begin, size_t end) {
            smooth_rows(frame_.grid, frame_.shape, *from, size_t{1} << round, config.strength, to, begin, end);
        });
        from = to;
        std::swap(to, other);
    }
    on_rows([&](size_t begin, size_t end) { put_out_rows(frame_.grid, guides, *from, sample_count, sums, begin, end); });
    std::swap(frame_.light, frame_.past_light);
    std::swap(frame_.shape, frame_.past_shape);
    std::swap(frame_.moments, frame_.past_moments);
    is_first_ = false;
}

}  // namespace zoe
