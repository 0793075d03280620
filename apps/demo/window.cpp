#include "apps/demo/window.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/common/interrupt.h"
#include "apps/common/write_file.h"
#include "apps/demo/window_panels.h"
#include "apps/demo/window_state.h"

namespace zoe {
namespace {

constexpr int kDefaultMaxSamples = 1024;

/// The first name of its kind that is free in the current folder.
std::filesystem::path free_name() {
    for (int k = 0;; ++k) {
        const std::filesystem::path file = fmt::format("zoetrope_{:04}.png", k);
        if (!std::filesystem::exists(file)) return file;
    }
}

void end_frame(GlWindow& window, WindowState& state) {
    if (!std::exchange(state.saves_picture, false)) return window.end_frame("");
    const std::filesystem::path file = free_name();
    try {
        window.end_frame(file);
        state.message = fmt::format("saved {}", file.native());
    } catch (const std::runtime_error& error) {
        state.message = one_line(error.what());
    }
}

template <typename T>
bool is_running(const std::future<T>& task) {
    return task.valid() && task.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

/// A scene, and the thread that renders it.
class Shown {
public:
    explicit Shown(std::unique_ptr<Opened> opened) : opened_(std::move(opened)) {
        print();
        catch_interrupts();
        renderer_.emplace(opened_->content, opened_->options.spp.value_or(kDefaultMaxSamples), &GlWindow::wake);
    }
    /// Waits for the frame that is being made.
    ~Shown() {
        renderer_.reset();
        print();
    }
    Shown(const Shown&) = delete;
    Shown& operator=(const Shown&) = delete;

    LiveRenderer& renderer() { return *renderer_; }

private:
    void print() { print_warnings(kProgram, opened_->content.scene, &printed_); }

    std::unique_ptr<Opened> opened_;
    std::vector<std::string> printed_;  // warnings
    std::optional<LiveRenderer> renderer_;
};

/// What the window shows, and what is being opened to be shown next.
class Viewer {
public:
    Viewer(GlWindow& window, const Options& options) : window_(window), options_(options) { begin_opening(options); }

    bool is_closing() const { return window_.is_closing() || state_.is_closing; }

    /// One frame of the interface.
    void step() {
        if (std::string dropped = window_.take_dropped(); !dropped.empty()) dropped_ = std::move(dropped);
        if (opening_.valid() && !is_running(opening_) && !is_running(ending_)) show_opened();
        if (!opening_.valid() && !dropped_.empty()) begin_opening(options_for(options_, std::exchange(dropped_, {})));
        window_.begin_frame(shown_ && state_.is_playing ? 1.0 / 60.0 : 0.1);
        const double now_s = window_.seconds();
        const double elapsed_s = now_s - std::exchange(state_.now_s, now_s);
        if (shown_) state_.play(std::min(elapsed_s, 0.25));  // after a stall, the animation goes on from where it was
        if (shown_ && shown_->renderer().take(&state_.picture)) {
            window_.set_texture(state_.picture.width, state_.picture.height, state_.picture.rgba.data());
            state_.note_picture();
        }
        draw_panels(state_, window_.take_keys());
        if (shown_) shown_->renderer().ask(state_.request());

        const bool takes_screenshot =
            options_.screenshot && state_.picture.width > 0 && now_s - begin_s_ >= options_.screenshot_after_s;
        if (!takes_screenshot) return end_frame(window_, state_);
        window_.end_frame(*options_.screenshot);
        window_.close();
    }

    /// Takes the window away, then waits for what runs beside it. A scene that is still being opened is not waited for:
    /// the program ends here.
    void close() {
        window_.hide();
        shown_.reset();
        if (ending_.valid()) ending_.wait();
        if (!is_running(opening_)) return;
        if (is_interrupted()) std::fputs(fmt::format("{}: interrupted\n", kProgram).c_str(), stderr);
        std::fflush(stdout);  // Not what the thread that opens may be reading.
        std::_Exit(is_interrupted() ? kInterruptedCode : 0);
    }

private:
    void begin_opening(Options options) {
        state_.opening = one_line(options.scene);
        opening_ = std::async(std::launch::async, [options = std::move(options)] {
            std::unique_ptr<Opened> opened = open(options);
            WindowState state = first_state(*opened);
            return std::pair(std::move(opened), std::move(state));
        });
    }

    /// What cannot be shown leaves the scene that is there as it is.
    void show_opened() {
        state_.opening.clear();
        try {
            auto [opened, state] = opening_.get();
            std::unique_ptr<Shown> last = std::exchange(shown_, std::make_unique<Shown>(std::move(opened)));
            if (last) ending_ = std::async(std::launch::async, [last = std::move(last)]() mutable { last.reset(); });
            state.is_help_shown = state_.is_help_shown;
            state_ = std::move(state);
        } catch (const std::runtime_error& error) {
            if (!shown_) throw;
            return refuse(error.what());
        } catch (const std::bad_alloc&) {
            if (!shown_) throw;
            return refuse("out of memory");
        }
        begin_s_ = state_.now_s = window_.seconds();
        state_.texture = window_.texture();
        window_.set_title("Zoetrope: " + state_.scene_name);
    }

    void refuse(const std::string& reason) {
        state_.message = one_line(reason);
        std::fputs(fmt::format("{}: {}\n", kProgram, state_.message).c_str(), stderr);
    }

    GlWindow& window_;
    const Options& options_;
    WindowState state_;
    std::unique_ptr<Shown> shown_;
    std::future<void> ending_;  // of what was shown before: the window does not wait for its last frame
    double begin_s_ = 0.0;      // when it was first shown
    std::string dropped_;       // to be opened; of several, the latest
    std::future<std::pair<std::unique_ptr<Opened>, WindowState>> opening_;
};

}  // namespace

void run_window(GlWindow& window, const Options& options) {
    window.set_title("Zoetrope: " + one_line(options.scene));
    Viewer viewer(window, options);
    while (!viewer.is_closing() && !is_interrupted()) viewer.step();
    viewer.close();
    if (is_interrupted()) throw Interrupted("interrupted");
}

}  // namespace zoe
