#include "apps/common/numbered_path.h"

#include <fmt/format.h>

#include "apps/common/parse.h"
#include "apps/common/usage_error.h"

namespace zoe {

NumberedPath::NumberedPath(const std::string& pattern) {
    const size_t slash = pattern.rfind('/');
    const size_t name_begin = slash == std::string::npos ? 0 : slash + 1;
    folder_ = slash == std::string::npos ? "." : slash == 0 ? "/" : pattern.substr(0, slash);
    const auto fail = [&](const char* reason) { throw UsageError(fmt::format("--out {}: {}", pattern, reason)); };
    if (name_begin == pattern.size()) fail("names a folder; give a file, such as out/frame_%04d.png");
    if (folder_.native().find('%') != std::string::npos) fail("the number belongs in the file's name, not its folder's");

    for (size_t i = name_begin; i < pattern.size(); ++i) {
        std::string& text = has_number_ ? after_ : before_;
        if (pattern[i] != '%') {
            text += pattern[i];
            continue;
        }
        if (i + 1 < pattern.size() && pattern[i + 1] == '%') {
            text += '%';
            ++i;
            continue;
        }
        // %, an optional 0, an optional width, d
        const size_t digits_end = pattern.find_first_not_of("0123456789", i + 1);
        if (digits_end == std::string::npos || pattern[digits_end] != 'd') fail("the number is written as %d, %4d or %04d");
        if (has_number_) fail("only one %d is allowed");
        const std::string digits = pattern.substr(i + 1, digits_end - i - 1);
        const std::optional<int> width = digits.empty() ? 0 : parse_count(digits, 20);
        if (!width) fail("the number's width is at most 20");
        has_number_ = true;
        width_ = *width;
        fill_ = digits.starts_with('0') ? '0' : ' ';
        i = digits_end;
    }
}

std::string NumberedPath::extension() const {
    return std::filesystem::path(before_ + after_).extension();
}

std::filesystem::path NumberedPath::operator()(int number) const {
    if (!has_number_) return folder_ / before_;
    const std::string digits = fill_ == '0' ? fmt::format("{:0{}d}", number, width_) : fmt::format("{:{}d}", number, width_);
    return folder_ / (before_ + digits + after_);
}

}  // namespace zoe
