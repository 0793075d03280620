#pragma once

#include <stdexcept>
#include <string>

namespace zoe {

/// What is wrong with a scene, as one line: `file: place: reason`. The place is a JSON pointer where there is one.
class SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
    SceneError(const std::string& file, const std::string& place, const std::string& reason)
        : std::runtime_error(file + (place.empty() ? "" : ": " + place) + ": " + reason) {}
};

}  // namespace zoe
