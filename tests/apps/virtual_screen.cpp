#include "tests/apps/virtual_screen.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "tests/support/read_bytes.h"

namespace zoe::test {
namespace {

bool runs(const std::vector<std::string>& command) {
    try {
        run_program(command, "/");
        return true;
    } catch (const std::runtime_error&) {
        return false;
    }
}

}  // namespace

bool is_near(uint32_t a, uint32_t b) {
    const auto differs = [=](int shift) { return std::abs(int(a >> shift & 255) - int(b >> shift & 255)) > 3; };
    return !differs(0) && !differs(8) && !differs(16);
}

Screenful Screenful::part(int x_begin, int y_begin, int x_end, int y_end) const {
    Screenful result{x_end - x_begin, y_end - y_begin, {}};
    for (int y = y_begin; y < y_end; ++y) {
        for (int x = x_begin; x < x_end; ++x) result.pixels.push_back(at(x, y));
    }
    return result;
}

int Screenful::count(uint32_t color) const {
    return static_cast<int>(std::ranges::count_if(pixels, [=](uint32_t pixel) { return is_near(pixel, color); }));
}

int Screenful::color_count() const {
    return static_cast<int>(std::set<uint32_t>(pixels.begin(), pixels.end()).size());
}

bool VirtualScreen::is_there() {
    return runs({"Xvfb", "-help"}) && runs({"xdotool", "-v"});
}

VirtualScreen::VirtualScreen(int width, int height, bool repeats_keys) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height) + "x24";
    const std::string repeats = repeats_keys ? "r" : "-r";
    const std::vector<std::string> command = {"Xvfb",  "-displayfd", "1",           "-screen",  "0",
                                              size,    "-nolisten",  "tcp",         "-noreset", "-nocursor",
                                              repeats, "-fbdir",     folder_.path()};
    server_ = std::make_unique<RunningProgram>(command, folder_.path());
    // It prints its number when it is ready.
    if (!wait_until([&] { return server_->out().find('\n') != std::string::npos; }))
        throw std::runtime_error("Xvfb does not start: " + server_->err());
    display_ = ":" + server_->out().substr(0, server_->out().find('\n'));
}

VirtualScreen::~VirtualScreen() {
    server_->send(SIGTERM);  // so that it takes its lock away
    server_->wait();
}

std::vector<std::string> VirtualScreen::environment() const {
    return {"DISPLAY=" + display_, "WAYLAND_DISPLAY", "XAUTHORITY"};
}

Screenful VirtualScreen::read() const {
    // An X window dump: numbers with the high byte first, a table of colours, then the pixels.
    const std::string bytes = read_bytes(folder_ / "Xvfb_screen0");
    const auto number = [&](size_t k) {
        uint32_t value = 0;
        for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes.at(4 * k + i));
        return value;
    };
    constexpr size_t kHeaderSize = 0, kWidth = 4, kHeight = 5, kRowSize = 12, kColorCount = 19, kColorSize = 12;
    Screenful screen;
    screen.width = static_cast<int>(number(kWidth));
    screen.height = static_cast<int>(number(kHeight));
    const size_t begin = number(kHeaderSize) + kColorSize * number(kColorCount);
    for (int y = 0; y < screen.height; ++y) {
        for (int x = 0; x < screen.width; ++x) {
            const size_t at = begin + number(kRowSize) * static_cast<size_t>(y) + 4 * static_cast<size_t>(x);
            const auto byte = [&](size_t k) { return uint32_t{static_cast<uint8_t>(bytes.at(at + k))}; };
            screen.pixels.push_back(byte(2) << 16 | byte(1) << 8 | byte(0));
        }
    }
    return screen;
}

void VirtualScreen::send(std::vector<std::string> commands) const {
    commands.insert(commands.begin(), "xdotool");
    const Outcome outcome = run_program(commands, folder_.path(), environment());
    if (outcome.exit_code != 0) throw std::runtime_error("xdotool: " + outcome.err);
}

}  // namespace zoe::test
