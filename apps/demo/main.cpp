#include <cstdio>
#include <new>

#include <fmt/format.h>

#include "apps/common/interrupt.h"
#include "apps/common/usage_error.h"
#include "apps/common/write_file.h"
#include "apps/demo/headless.h"
#include "apps/demo/opened.h"
#include "apps/demo/window.h"

namespace {

int fail(int exit_code, const std::string& message) {
    std::fputs(fmt::format("{}: {}\n", zoe::kProgram, zoe::one_line(message)).c_str(),
               stderr);  // fmt::print throws on a full disk
    return exit_code;
}

void run(zoe::Options options) {
    zoe::set_thread_count(options.threads);
    if (options.screenshot) zoe::require_writable(*options.screenshot);
    std::string reason;
    if (!options.is_headless) {
        try {
            zoe::GlWindow window(options.size);
            return zoe::run_window(window, options);
        } catch (const zoe::NoWindow& error) {
            if (options.screenshot) throw std::runtime_error(fmt::format("--screenshot: no window: {}", error.what()));
            reason = error.what();
        }
    }
    const std::unique_ptr<zoe::Opened> opened = zoe::open(std::move(options));
    std::vector<std::string> printed;
    zoe::print_warnings(zoe::kProgram, opened->content.scene, &printed);
    if (!reason.empty()) {
        fmt::print("no window ({}): rendering into {}\n", reason, opened->options.out.folder().native());
        std::fflush(stdout);
    }
    zoe::run_headless(opened->content, opened->options);
    zoe::print_warnings(zoe::kProgram, opened->content.scene, &printed);
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
        return fail(zoe::kInterruptedCode, error.what());
    } catch (const std::bad_alloc&) {
        return fail(1, "out of memory");
    } catch (const std::exception& error) {
        return fail(1, error.what());
    }
}
