#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace zoe {

/// What a file says, fit to be printed: one line of at most 1,000 bytes. Control characters become spaces, so that no file
/// breaks a line or gives a terminal orders.
std::string plain_line(std::string_view text);

/// What is wrong with a scene, as one line: `file: place: reason`. The place is a JSON pointer where there is one.
class SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
    SceneError(const std::string& file, const std::string& place, const std::string& reason)
        : std::runtime_error(plain_line(file) + (place.empty() ? "" : ": " + plain_line(place)) + ": " +
                             plain_line(reason)) {}
};

}  // namespace zoe
