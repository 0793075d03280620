#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/common/choose_view.h"
#include "apps/demo/pace.h"
#include "engine/frame/node_report.h"
#include "engine/render/denoise.h"
#include "engine/render/past_frame.h"
#include "engine/render/path.h"
#include "engine/render/upsample.h"

namespace zoe {

/// What the interface wants to see.
struct LiveRequest {
    double time_s = 0.0;
    std::vector<ClipId> clips;
    bool is_looping = true;
    Shade shade = Shade::kPath;
    Grade grade;
    const Environment* environment = nullptr;  ///< As RenderConfig's.
    std::optional<NodeId> camera;              ///< Else `look_at`.
    ViewChoice::LookAt look_at;
    int width = 0, height = 0;                       ///< Of the picture on the screen.
    std::optional<NodeId> picked;                    ///< Outlined and reported.
    std::vector<std::pair<NodeId, Motion>> motions;  ///< Classes that nodes are forced to.
    bool is_playing = false;  ///< The next request has another time: one pass at a size that keeps up.

    friend bool operator==(const LiveRequest&, const LiveRequest&) = default;
};

/// A node that the user has chosen.
struct PickedNode {
    NodeId node = kNone<NodeId>;
    std::string name;
    NodeReport report;
};

/// What the render thread has to show.
struct LivePicture {
    int width = 0, height = 0;
    int light_width = 0, light_height = 0;  ///< Of the picture that lights it: its own, or a smaller one's.
    std::vector<uint8_t> rgba;              ///< [height * width * 4], top row first.
    std::vector<NodeId> nodes;              ///< [height * width] what is seen; kNone<NodeId>: the sky.
    std::optional<PickedNode> picked;
    double time_s = 0.0;
    int sample_count = 0;
    bool is_new_frame = false;  ///< The scene was advanced for it.
    FrameStats stats;           ///< Of the frame's `advance` and of this picture's last pass.
    View view;
    Aabb bounds;
    bool is_finished = false;  ///< Nothing more will be done to it.
};

/// Renders on its own thread, so that the interface never waits. A new frame or edit is first shown by one sample a pixel at
/// a size that keeps up with 24 frames a second, smoothed with the frames before, which lights the surfaces of a finer
/// picture; then, while nothing changes, light of finer and finer ones up to full size, and from then on samples accumulate.
/// What has few of them is smoothed, too.
class LiveRenderer {
public:
    /// content     Its scene belongs to the thread until this ends.
    /// on_picture  Called on the render thread whenever `take` has something new.
    LiveRenderer(Content& content, int max_samples, std::function<void()> on_picture);
    ~LiveRenderer();
    LiveRenderer(const LiveRenderer&) = delete;
    LiveRenderer& operator=(const LiveRenderer&) = delete;

    /// Asks for a picture; work on an older request is left when this one differs.
    void ask(const LiveRequest& request);

    /// Moves the newest picture, if there is one that was not taken before.
    /// Throws     what the render thread has thrown.
    bool take(LivePicture* picture);

private:
    void loop();
    void work();
    void advance_if_needed(const LiveRequest& request);
    bool is_frame_shown(const LiveRequest& request) const;
    void start_film(const LiveRequest& request, bool is_restart);
    bool pass(const LiveRequest& request);
    const Film& smooth(const LiveRequest& request);
    RenderConfig render_config(const LiveRequest& request);
    bool has_surfaces(const LiveRequest& request) const;
    bool see_surfaces(const LiveRequest& request);
    void note_pace(const LiveRequest& request, double light_ms, double all_ms);
    void develop(const LiveRequest& request, const Film& film);
    void publish(const LiveRequest& request);
    void force_motions(const LiveRequest& request);

    // Shared, guarded by the mutex but for the two atomics.
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<LiveRequest> request_;
    std::optional<LivePicture> newest_;
    std::exception_ptr error_;
    bool is_stopping_ = false;
    bool is_refining_ = false;         ///< A pass is running that may be left at any time.
    std::atomic<bool> cancel_{false};  ///< Leave the running pass.

    // The render thread's own.
    Content& content_;
    const int max_samples_;
    const bool follows_view_;  ///< What the scene shows depends on where it is seen from.
    std::function<void()> on_picture_;
    LiveRequest shown_;  ///< What the film holds.
    bool is_shown_ = false;
    const Tlas* tlas_ = nullptr;
    std::map<NodeId, std::optional<Motion>> own_motions_;  ///< What forced nodes had before.
    FrameStats frame_stats_;                               ///< Of the last `advance`.
    FrameStats pass_stats_;                                ///< That, and of the last pass.
    uint64_t traced_rays_ = 0;                             ///< Since then.
    bool is_new_frame_ = false;
    Film film_, smoothed_;
    Film surfaces_;  ///< Seen at the last restart, where they were to be finer than the light; lit by whatever is there.
    bool is_first_film_ = false;  ///< Since the last change: few bounces, and soon another.
    View view_;                   ///< Of the last pass.
    int divisor_ = 1;             ///< The film's sides are the picture's, divided by this ...
    int surface_divisor_ = 1;     ///< ... and those of the surfaces by this.
    Pace pace_;
    double advance_ms_ = 0.0;    ///< What the last frame took before its pixels.
    uint32_t first_number_ = 0;  ///< Of the frame's random numbers.
    PastFrame past_;
    Guides guides_, surface_guides_;
    Denoiser denoiser_;
    Upsampler upsampler_;
    LivePicture picture_;  ///< The latest, but for what is picked in it.
    std::thread thread_;   ///< Last: it uses all of the above.
};

}  // namespace zoe
