#include "apps/demo/window_state.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/common/stats_json.h"
#include "apps/demo/first_view.h"
#include "apps/demo/gl_window.h"

namespace zoe {
namespace {

/// How long the timeline is for scenes in which nothing repeats.
constexpr double kOpenEndS = 10.0;

void add_clips(const Scene& scene, WindowState* state) {
    state->clips.clear();
    // Whatever no clip moves (sequences, written meshes) plays beside each of them.
    std::vector<ClipId> all;
    for (uint32_t i = 0; i < scene.clips.size(); ++i) {
        const std::string& clip_name = scene.clips[i].name;
        state->clips.push_back({clip_name.empty() ? fmt::format("clip {}", i) : one_line(clip_name), {ClipId{i}}, 0.0});
        all.push_back(ClipId{i});
    }
    if (all.size() != 1) state->clips.push_back({all.empty() ? "no clips" : "all", all, 0.0});
    const auto plays_now = [&](const WindowState::ClipChoice& choice) { return choice.clips == scene.playback.clips; };
    auto chosen = std::find_if(state->clips.begin(), state->clips.end(), plays_now);
    if (chosen == state->clips.end()) {
        chosen = state->clips.insert(state->clips.begin(), {"as the scene says", scene.playback.clips, 0.0});
    }
    state->clip = static_cast<size_t>(chosen - state->clips.begin());

    for (WindowState::ClipChoice& choice : state->clips) {
        choice.duration_s = duration_s(scene, choice.clips);
        if (choice.duration_s <= 0.0) choice.duration_s = kOpenEndS;
    }
}

}  // namespace

LiveRequest WindowState::request() const {
    LiveRequest request;
    request.time_s = time_s;
    request.clips = clips[clip].clips;
    request.is_looping = is_looping;
    request.shade = shade;
    request.grade = grade;
    request.environment = environment;
    if (camera >= 0) request.camera = cameras[camera].node;
    request.look_at = orbit.look_at();
    request.width = picture_width;
    request.height = picture_height;
    request.is_playing = is_playing;
    request.picked = picked;
    request.motions = motions;
    return request;
}

void WindowState::play(double elapsed_s) {
    if (!is_playing) return;
    const double end_s = clips[clip].duration_s;
    time_s += elapsed_s;
    if (time_s < end_s) return;
    if (is_looping) {
        time_s = std::fmod(time_s, end_s);
    } else {
        time_s = end_s;
        is_playing = false;
    }
}

void WindowState::step(int frame_count) {
    is_playing = false;
    const double frame = std::round(time_s * fps) + frame_count;
    time_s = std::clamp(frame / fps, 0.0, clips[clip].duration_s);
}

void WindowState::free_camera() {
    if (camera >= 0 && picture.width > 0) orbit = orbit_from_view(picture.view, picture.bounds);
    camera = -1;
}

void WindowState::pick(float x, float y) {
    node_history.clear();
    picked.reset();
    if (picture.width == 0 || !(x >= 0.0f && x < 1.0f && y >= 0.0f && y < 1.0f)) return;
    const auto column = static_cast<size_t>(x * float(picture.width)), row = static_cast<size_t>(y * float(picture.height));
    const NodeId node = picture.nodes[row * picture.width + column];
    if (node != kNone<NodeId>) picked = node;
}

void WindowState::force_motion(std::optional<Motion> motion) {
    std::erase_if(motions, [&](const auto& forced) { return forced.first == picked; });
    if (motion) motions.emplace_back(*picked, *motion);
}

void WindowState::note_picture() {
    if (!picture.is_new_frame) return;
    shown_s.push_back(now_s);
    while (shown_s.size() > 2 && shown_s[1] < now_s - 1.0) shown_s.pop_front();
    history.push_back(picture.stats);
    if (history.size() > kHistorySize) history.pop_front();
    if (!picture.picked || picture.picked->node != picked) return;
    const NodeReport& report = picture.picked->report;
    const double share = report.tree_cost > 0.0 ? report.ray_loss / report.tree_cost : 0.0;
    node_history.push_back({report.action, static_cast<float>(share)});
    if (node_history.size() > kHistorySize) node_history.pop_front();
}

double WindowState::frames_a_second() const {
    if (shown_s.size() < 2) return 0.0;
    const double count = static_cast<double>(shown_s.size() - 1);
    const double until_last_s = shown_s.back() - shown_s.front();
    // A frame that is late counts against the rate from when it was due.
    const double due_s = shown_s.back() + until_last_s / count;
    const double elapsed_s = until_last_s + std::max(0.0, now_s - due_s);
    return elapsed_s > 0.0 ? count / elapsed_s : 0.0;
}

WindowState first_state(Opened& opened) {
    const Options& options = opened.options;
    const Scene& scene = opened.content.scene;
    const ViewChoice choice = first_view(opened.content, options);
    const Tlas& tlas = advance(opened.content, 0.0, nullptr);

    WindowState state;
    state.scene_name = one_line(options.scene);
    const RunStats run = describe_run(options.scene, scene, tlas);
    state.node_count = run.node_count;
    state.triangle_count = run.triangle_count;
    state.is_looping = scene.playback.is_looping;
    state.fps = options.fps;
    state.shade = options.shade;
    state.grade = options.grade;
    state.environment = options.environment.get();
    add_clips(scene, &state);
    for (const NodeId node : camera_nodes(scene)) {
        const std::string camera = camera_name(scene, node);
        if (node == choice.camera) state.camera = static_cast<int>(state.cameras.size());
        state.cameras.push_back({camera.empty() ? fmt::format("camera {}", state.cameras.size()) : one_line(camera), node});
    }
    const float aspect = float(kDefaultWindowSize.width) / kDefaultWindowSize.height;
    const Aabb bounds = choice.bounds.is_empty() ? tlas.bounds() : choice.bounds;
    state.orbit = orbit_from_view(choice.view(scene, aspect), bounds);
    if (choice.look_at) state.orbit.target = choice.look_at->target;
    if (choice.look_at) state.orbit.distance = glm::distance(choice.look_at->eye, choice.look_at->target);
    state.first_orbit = state.orbit;
    return state;
}

}  // namespace zoe
