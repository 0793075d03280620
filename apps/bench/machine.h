#pragma once

#include <string>
#include <utility>
#include <vector>

namespace zoe {

/// What numbers were measured on and by: processor, cores, threads, compiler, flags, vector instructions, version, commit.
std::vector<std::pair<std::string, std::string>> describe_machine();

}  // namespace zoe
