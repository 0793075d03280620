#include "apps/demo/live_renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/frame/classify.h"

namespace zoe {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Of light in first pictures: chart `denoise`.
constexpr int kFirstBounces = 2;
/// With more samples, what smoothing takes from a still picture is more than the noise that it takes.
constexpr int kMostSmoothedSamples = 32;
constexpr uint8_t kOutline[3] = {255, 160, 0};

/// Colours the pixels of a node that have another beside them.
void outline(NodeId node, LivePicture* picture) {
    const auto at = [&](int x, int y) { return picture->nodes[size_t{1} * y * picture->width + x]; };
    for (int y = 0; y < picture->height; ++y) {
        for (int x = 0; x < picture->width; ++x) {
            if (at(x, y) != node) continue;
            const bool is_edge = x == 0 || y == 0 || x + 1 == picture->width || y + 1 == picture->height ||
                                 at(x - 1, y) != node || at(x + 1, y) != node || at(x, y - 1) != node ||
                                 at(x, y + 1) != node;
            if (is_edge) std::copy_n(kOutline, 3, &picture->rgba[4 * (size_t{1} * y * picture->width + x)]);
        }
    }
}

/// A film without samples, for a picture whose sides are divided.
void start(const LiveRequest& request, int divisor, Film* film) {
    const int width = std::max(1, request.width / divisor), height = std::max(1, request.height / divisor);
    if (film->width == width && film->height == height) {
        film->clear();
    } else {
        *film = Film(width, height);
    }
}

ViewChoice view_choice(const LiveRequest& request) {
    ViewChoice choice;
    choice.camera = request.camera;
    choice.look_at = request.look_at;
    return choice;
}

}  // namespace

LiveRenderer::LiveRenderer(Content& content, int max_samples, std::function<void()> on_picture)
    : content_(content),
      max_samples_(max_samples),
      follows_view_(has_pixel_surfaces(content.scene)),
      on_picture_(std::move(on_picture)) {
    thread_ = std::thread([this] { loop(); });
}

LiveRenderer::~LiveRenderer() {
    {
        const std::lock_guard lock(mutex_);
        is_stopping_ = true;
        cancel_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void LiveRenderer::ask(const LiveRequest& request) {
    {
        const std::lock_guard lock(mutex_);
        if (request_ == request) return;
        request_ = request;
        // A first pass is short and is shown even so: while the mouse moves, pictures must keep coming.
        if (is_refining_) cancel_ = true;
    }
    changed_.notify_one();
}

bool LiveRenderer::take(LivePicture* picture) {
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    if (!newest_) return false;
    *picture = std::move(*newest_);
    newest_.reset();
    return true;
}

void LiveRenderer::loop() {
    try {
        work();
    } catch (...) {
        const std::lock_guard lock(mutex_);
        error_ = std::current_exception();
    }
    on_picture_();
}

void LiveRenderer::work() {
    const auto is_restart = [&](const LiveRequest& request) {
        LiveRequest same_mode = request;
        same_mode.is_playing = shown_.is_playing;  // pausing leaves the picture as it is ...
        same_mode.picked = shown_.picked;          // ... and so does a look at a node
        return !is_shown_ || same_mode != shown_;
    };
    const auto can_refine = [&](const LiveRequest& request) {
        return !request.is_playing && (divisor_ > 1 || is_first_film_ || film_.sample_count < max_samples_);
    };
    while (true) {
        LiveRequest request;
        {
            std::unique_lock lock(mutex_);
            is_refining_ = false;
            const auto has_work = [&] {
                return is_stopping_ ||
                       (request_ && request_->width > 0 && request_->height > 0 &&
                        (is_restart(*request_) || can_refine(*request_) || request_->picked != shown_.picked));
            };
            changed_.wait(lock, has_work);
            if (is_stopping_) return;
            request = *request_;
            is_refining_ = !is_restart(request);
            cancel_ = false;
        }
        const bool restarts = is_restart(request);
        if (!restarts && request.picked != shown_.picked) {  // The picture is there: no pass is waited for.
            shown_ = request;
            publish(request);
            on_picture_();
            continue;
        }
        const Clock::time_point advance_begin = Clock::now();
        if (restarts) advance_if_needed(request);
        advance_ms_ = ms_since(advance_begin);
        // A film without a sample is one whose pass was left: it is of the right size.
        const bool is_done = film_.sample_count > 0 && (divisor_ > 1 || is_first_film_);
        if (restarts || is_done) start_film(request, restarts);
        shown_ = request;
        is_shown_ = true;
        const Clock::time_point pass_begin = Clock::now();
        if (!pass(request)) continue;
        const Film* shown = &smooth(request);
        const double light_ms = ms_since(pass_begin);
        if (has_surfaces(request)) {
            if (!see_surfaces(request)) continue;
            upsampler_.light(guides_, *shown, surface_guides_, &surfaces_);
            shown = &surfaces_;
        }
        develop(request, *shown);
        publish(request);
        if (is_first_film_) note_pace(request, light_ms, ms_since(pass_begin));
        on_picture_();
    }
}

bool LiveRenderer::is_frame_shown(const LiveRequest& request) const {
    const bool is_same_time =
        request.time_s == shown_.time_s && request.clips == shown_.clips && request.is_looping == shown_.is_looping;
    const bool is_same_view = request.camera == shown_.camera && request.look_at == shown_.look_at &&
                              request.width == shown_.width && request.height == shown_.height;
    return is_shown_ && is_same_time && request.motions == shown_.motions && (is_same_view || !follows_view_);
}

void LiveRenderer::advance_if_needed(const LiveRequest& request) {
    if (tlas_) past_.keep(*tlas_, view_);
    if (request.camera != shown_.camera || request.clips != shown_.clips) denoiser_.forget();  // a cut
    if (is_frame_shown(request)) return;
    set_viewpoint(view_choice(request), {request.width, request.height}, Viewpoint{}.hysteresis, &content_.scene);
    content_.scene.playback.is_looping = request.is_looping;
    content_.scene.playback.clips = request.clips;
    if (tlas_) report_rays(content_.scene, traced_rays_);
    traced_rays_ = 0;
    frame_stats_ = {};
    if (!is_shown_ || request.motions != shown_.motions) force_motions(request);
    tlas_ = &advance(content_, request.time_s, &frame_stats_);
    is_new_frame_ = true;
}

void LiveRenderer::force_motions(const LiveRequest& request) {
    Scene& scene = content_.scene;
    for (const auto& [node, motion] : own_motions_) scene[node].motion = motion;
    if (!own_motions_.empty()) scene.touch();
    own_motions_.clear();
    for (const auto& [node, motion] : request.motions) {
        own_motions_.emplace(node, scene[node].motion);
        set_motion(scene, node, motion);
    }
}

void LiveRenderer::start_film(const LiveRequest& request, bool is_restart) {
    divisor_ = std::max(1, divisor_ / 2);
    is_first_film_ = is_restart;
    if (is_restart) {
        ++first_number_;
        const double pixel_count = double(request.width) * request.height;
        PlaySizes sizes;
        if (request.shade == Shade::kPath) {
            sizes = pace_.choose(pixel_count, advance_ms_);
        } else {
            sizes.light = sizes.surfaces = pace_.choose_unlit(pixel_count, advance_ms_);
        }
        divisor_ = sizes.light;
        surface_divisor_ = sizes.surfaces;
    }
    start(request, divisor_, &film_);
}

bool LiveRenderer::pass(const LiveRequest& request) {
    const View view = view_choice(request).view(content_.scene, float(request.width) / float(request.height));

    RenderConfig config = render_config(request);
    config.guides = &guides_;
    guides_.past = is_first_film_ ? &past_ : nullptr;
    pass_stats_ = frame_stats_;
    if (!render(content_.scene, *tlas_, view, config, 1, &film_, &pass_stats_)) return false;
    traced_rays_ += pass_stats_.rays - frame_stats_.rays;
    view_ = view;
    return true;
}

RenderConfig LiveRenderer::render_config(const LiveRequest& request) {
    RenderConfig config;
    config.shade = request.shade;
    config.environment = request.environment;
    config.cancel = &cancel_;
    if (is_first_film_) {
        config.max_bounces = kFirstBounces;
        config.is_jittered = false;
        config.first_number = first_number_;
    }
    return config;
}

/// Tells whether surfaces are shown that are finer than their light.
bool LiveRenderer::has_surfaces(const LiveRequest& request) const {
    return request.shade == Shade::kPath && surface_divisor_ < divisor_;
}

/// Traces the picture's surfaces, unless that was done for the light before this one.
/// Returns    false where it was cancelled.
bool LiveRenderer::see_surfaces(const LiveRequest& request) {
    if (!is_first_film_) return true;
    start(request, surface_divisor_, &surfaces_);
    RenderConfig config = render_config(request);
    config.guides = &surface_guides_;
    config.is_lit = false;
    const uint64_t rays = pass_stats_.rays;
    if (!render(content_.scene, *tlas_, view_, config, 1, &surfaces_, &pass_stats_)) return false;
    traced_rays_ += pass_stats_.rays - rays;
    return true;
}

void LiveRenderer::note_pace(const LiveRequest& request, double light_ms, double all_ms) {
    const double pixel_count = double(film_.width) * film_.height;
    if (request.shade != Shade::kPath) return pace_.note_surfaces(pixel_count, all_ms);
    if (!has_surfaces(request)) return pace_.note_light(pixel_count, all_ms);
    pace_.note_light(pixel_count, light_ms);
    pace_.note_surfaces(double(surfaces_.width) * surfaces_.height, all_ms - light_ms);
}

/// Makes the film to show: of first films with the frames before, of the next ones by neighbours only.
const Film& LiveRenderer::smooth(const LiveRequest& request) {
    if (!is_first_film_ || request.shade != Shade::kPath) denoiser_.forget();
    if (request.shade != Shade::kPath || film_.sample_count > kMostSmoothedSamples) return film_;
    smoothed_.width = film_.width;
    smoothed_.height = film_.height;
    smoothed_.sample_count = film_.sample_count;
    smoothed_.sum = film_.sum;
    denoiser_.filter(guides_, {}, &smoothed_);
    return smoothed_;
}

void LiveRenderer::develop(const LiveRequest& request, const Film& film) {
    picture_.width = film.width;
    picture_.height = film.height;
    picture_.light_width = film_.width;
    picture_.light_height = film_.height;
    picture_.rgba = to_rgba8(film, request.grade);
    const std::vector<uint32_t>& nodes = has_surfaces(request) ? surfaces_.node : film_.node;
    picture_.nodes.resize(nodes.size());
    std::ranges::transform(nodes, picture_.nodes.begin(), [](uint32_t node) { return NodeId{node}; });
    picture_.time_s = request.time_s;
    picture_.sample_count = film_.sample_count;
    picture_.stats = pass_stats_;
    picture_.view = view_;
    picture_.bounds = tlas_->bounds();
    picture_.is_finished = divisor_ == 1 && !is_first_film_ && film_.sample_count >= max_samples_;
}

void LiveRenderer::publish(const LiveRequest& request) {
    LivePicture picture = picture_;
    if (request.picked) {
        const NodeId node = *request.picked;
        picture.picked = {.node = node, .name = content_.scene[node].name, .report = report_node(content_.scene, node)};
        outline(node, &picture);
    }
    picture.is_new_frame = is_new_frame_;
    is_new_frame_ = false;

    const std::lock_guard lock(mutex_);
    if (newest_ && newest_->is_new_frame) picture.is_new_frame = true;  // it was never taken
    newest_ = std::move(picture);
}

}  // namespace zoe
