#include <cstdio>
#include <memory>
#include <new>

#include <fmt/format.h>

#include "apps/common/interrupt.h"
#include "apps/common/open_scene.h"
#include "apps/common/usage_error.h"
#include "apps/common/write_file.h"
#include "apps/demo/choose_sky.h"
#include "apps/demo/headless.h"
#include "apps/demo/options.h"
#include "apps/demo/window.h"

namespace {

constexpr const char* kProgram = "zoetrope-demo";

int fail(int exit_code, const std::string& message) {
    std::fputs(fmt::format("{}: {}\n", kProgram, zoe::one_line(message)).c_str(),
               stderr);  // fmt::print throws on a full disk
    return exit_code;
}

zoe::Content open(const zoe::Options& options) {
    zoe::Content content = zoe::open_scene(options.scene, options.fps, options.level);
    content.scene.playback.is_looping = options.is_looping;
    content.scene.tree_build.budget_s = options.build_budget_s;
    if (!options.cache.empty()) content.scene.tree_cache = std::make_shared<zoe::TreeCache>(options.cache);
    if (options.clip) zoe::choose_clips(content.scene, *options.clip);
    return content;
}

/// Shows a scene, then those that are dropped on the window.
void run_windows(zoe::GlWindow& window, zoe::Content& content, zoe::Options options) {
    std::string message;
    while (true) {
        const std::string dropped = zoe::run_window(window, content, options, message);
        if (dropped.empty()) return;
        zoe::Options next = options;
        next.scene = dropped;
        next.clip.reset();  // These were said of the first scene.
        next.camera.reset();
        next.eye = next.target = next.origin = std::nullopt;
        next.fov_degrees.reset();
        next.begins_at_eye = false;
        next.level.reset();
        try {
            zoe::Content other = open(next);
            next.environment = zoe::choose_sky(next, other.scene);
            zoe::advance(other, 0.0, nullptr);  // What it cannot show is found out before the last scene is gone.
            content = std::move(other);
            content.scene.touch();
            options = next;
            message.clear();
            std::vector<std::string> printed;
            zoe::print_warnings(kProgram, content.scene, &printed);
        } catch (const zoe::Interrupted&) {
            throw;
        } catch (const std::runtime_error& error) {
            message = zoe::one_line(error.what());
            fail(1, message);
        }
    }
}

void run(zoe::Options options) {
    zoe::set_thread_count(options.threads);
    if (options.screenshot) zoe::require_writable(*options.screenshot);
    zoe::Content content = open(options);
    options.environment = zoe::choose_sky(options, content.scene);
    std::vector<std::string> printed;
    zoe::print_warnings(kProgram, content.scene, &printed);

    bool is_headless = options.is_headless;
    if (!is_headless) {
        try {
            zoe::GlWindow window(zoe::first_window_size(options));
            run_windows(window, content, options);
        } catch (const zoe::NoWindow& error) {
            if (options.screenshot) throw std::runtime_error(fmt::format("--screenshot: no window: {}", error.what()));
            fmt::print("no window ({}): rendering into {}\n", error.what(), options.out.folder().native());
            std::fflush(stdout);
            is_headless = true;
        }
    }
    if (is_headless) zoe::run_headless(content, options);
    zoe::print_warnings(kProgram, content.scene, &printed);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::optional<zoe::Options> options = zoe::parse_options(argc, argv);
        if (!options) return 0;
        run(*options);
        return 0;
    } catch (const zoe::UsageError& error) {
        return fail(2, error.what());
    } catch (const zoe::Interrupted& error) {
        return fail(130, error.what());
    } catch (const std::bad_alloc&) {
        return fail(1, "out of memory");
    } catch (const std::exception& error) {
        return fail(1, error.what());
    }
}
