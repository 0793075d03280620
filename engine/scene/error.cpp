#include "engine/scene/error.h"

#include <algorithm>

namespace zoe {

std::string plain_line(std::string_view text) {
    constexpr size_t kMostBytes = 1000;
    constexpr std::string_view kCut = "...";
    std::string line(text.substr(0, std::min(text.size(), kMostBytes)));
    for (size_t k = 0; k < line.size(); ++k) {
        const unsigned char c = static_cast<unsigned char>(line[k]);
        if (c < 0x20 || c == 0x7f) line[k] = ' ';
        // U+0080 to U+009F: some of them begin a terminal's orders.
        const bool is_control = c == 0xc2 && k + 1 < line.size() && (static_cast<unsigned char>(line[k + 1]) & 0xe0) == 0x80;
        if (is_control) line[k] = line[k + 1] = ' ';
    }
    if (text.size() > kMostBytes) {
        // Not in the middle of a character.
        line.resize(kMostBytes - kCut.size());
        while (!line.empty() && (static_cast<unsigned char>(line.back()) & 0xc0) == 0x80) line.pop_back();
        if (!line.empty() && static_cast<unsigned char>(line.back()) >= 0xc0) line.pop_back();
        line += kCut;
    }
    return line;
}

}  // namespace zoe
