#include "engine/scene/obj_lines.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace zoe {

namespace {

constexpr size_t kBufferSize = size_t{1} << 16;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

}  // namespace

ObjLines::ObjLines(std::istream& stream, size_t max_bytes) : stream_(stream), max_bytes_(max_bytes), buffer_(kBufferSize) {
    if (fill() && std::string_view(buffer_.data(), end_).starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
}

bool ObjLines::next(std::string* line) {
    line->clear();
    number_ = next_number_;
    bool is_any = false;
    while (append_part(line)) {
        is_any = true;
        ++next_number_;
        const bool goes_on = line->ends_with('\\') && line->find('#') == line->npos;
        if (!goes_on) break;
        line->back() = ' ';
    }
    return is_any;
}

bool ObjLines::fill() {
    at_ = 0;
    stream_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    end_ = static_cast<size_t>(stream_.gcount());
    return end_ > 0;
}

// Up to the next end of a line, or of the file.
bool ObjLines::append_part(std::string* line) {
    bool is_any = false;
    while (at_ < end_ || fill()) {
        is_any = true;
        const char *const from = buffer_.data() + at_, *const last = buffer_.data() + end_;
        const char* const to = std::find_if(from, last, [](char c) { return c == '\n' || c == '\r'; });
        if (line->size() + static_cast<size_t>(to - from) > max_bytes_) {
            throw std::length_error("a line of more than " + std::to_string(max_bytes_) + " bytes");
        }
        line->append(from, to);
        at_ += static_cast<size_t>(to - from);
        if (to == last) continue;
        const bool is_return = *to == '\r';
        ++at_;
        if (is_return && (at_ < end_ || fill()) && buffer_[at_] == '\n') ++at_;
        break;
    }
    return is_any;
}

}  // namespace zoe
