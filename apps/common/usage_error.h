#pragma once

#include <stdexcept>

namespace zoe {

/// What is wrong with a command line, as one line. Programs end with exit code 2 for it.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace zoe
