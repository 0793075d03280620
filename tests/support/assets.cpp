#include "tests/support/assets.h"

#include <algorithm>
#include <cstdlib>

namespace zoe::test {

namespace fs = std::filesystem;

std::optional<fs::path> assets_folder(const fs::path& source_folder) {
    if (const char* told = std::getenv("ZOETROPE_ASSETS"); told != nullptr && *told != '\0') {
        if (fs::is_directory(told)) return fs::path(told);
        return std::nullopt;
    }
    const fs::path folder = source_folder / ".." / "shared" / "assets";
    if (fs::is_directory(folder)) return folder;
    return std::nullopt;
}

std::vector<std::string> gltf_files(const fs::path& folder) {
    std::vector<std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path extension = entry.path().extension();
        if (entry.is_regular_file() && (extension == ".gltf" || extension == ".glb")) {
            files.push_back(entry.path().lexically_relative(folder).generic_string());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace zoe::test
