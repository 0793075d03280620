#pragma once

#include <string>
#include <vector>

namespace zoe::test {

/// Small files to begin from, each of which loads: one or more a feature of the format.
std::vector<std::string> gltf_seeds();
std::vector<std::string> image_seeds();
std::vector<std::string> sequence_seeds();

}  // namespace zoe::test
