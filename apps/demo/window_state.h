#pragma once

#include <deque>
#include <string>
#include <vector>

#include "apps/demo/live_renderer.h"
#include "apps/demo/opened.h"
#include "apps/demo/orbit.h"

namespace zoe {

/// Kinds of pictures, as Shade counts them.
constexpr int kShadeCount = 5;

/// What the interface shows and what it lets the user choose; as it is made, without a scene. That belongs to the render
/// thread.
struct WindowState {
    struct ClipChoice {
        std::string name;
        std::vector<ClipId> clips;
        double duration_s = 0.0;
    };
    struct CameraChoice {
        std::string name;
        NodeId node = kNone<NodeId>;
    };
    static constexpr size_t kHistorySize = 180;

    std::string scene_name;
    std::vector<ClipChoice> clips{1};   ///< At least one.
    std::vector<CameraChoice> cameras;  ///< Of the file.
    std::array<uint32_t, kMotionCount> node_count{};
    uint64_t triangle_count = 0;
    double fps = 24.0;

    size_t clip = 0;
    int camera = -1;  ///< -1: the free one.
    Orbit orbit, first_orbit;
    Shade shade = Shade::kPath;
    Grade grade;
    const Environment* environment = nullptr;
    double time_s = 0.0;
    double now_s = 0.0;  ///< Of a clock that goes on beside it.
    bool is_playing = true, is_looping = true, is_help_shown = false, is_closing = false;
    int picture_width = 0, picture_height = 0;  ///< Of the place for it in the window, in the screen's pixels.

    std::optional<NodeId> picked;
    std::vector<std::pair<NodeId, Motion>> motions;  ///< Classes that nodes are forced to.
    /// What new frames did to the picked node.
    struct NodeFrame {
        TreeAction action;
        float loss;  ///< Share of a ray's work in it that a new tree would save.
    };
    std::deque<NodeFrame> node_history;
    std::string message;         ///< What was done or went wrong last; empty: nothing.
    std::string opening;         ///< The scene that comes next; empty: none.
    bool saves_picture = false;  ///< The window is to be saved once it is drawn.

    LivePicture picture;
    unsigned texture = 0;
    std::deque<FrameStats> history;  ///< Of the latest frames.
    std::deque<double> shown_s;      ///< When the new frames of the latest second came: the latest two, at least.

    LiveRequest request() const;
    /// Moves the time on, as the clip's end says.
    void play(double elapsed_s);
    /// Steps by whole frames, and pauses.
    void step(int frame_count);
    /// Makes the free camera see what is seen now.
    void free_camera();
    /// Picks what is seen at a place of the picture, both from 0 to 1; the sky: nothing.
    void pick(float x, float y);
    /// Forces the picked node's class; none: as the scene says.
    void force_motion(std::optional<Motion> motion);
    /// Takes in a picture that was just made.
    void note_picture();
    /// New frames over the latest second; over the time since the last but one where they are slower.
    double frames_a_second() const;
};

/// Makes the scene's frame at time 0, with all trees; the view is the one that was asked for.
/// Throws     UsageError for an unknown camera, and what goes wrong in the frame.
WindowState first_state(Opened& opened);

}  // namespace zoe
