#pragma once

#include <filesystem>
#include <string>

namespace zoe {

/// File names from a pattern such as out/frame_%04d.png: one printf integer field (%d, %4d, %04d) in the file's name,
/// or none. A percent sign itself is %%.
class NumberedPath {
public:
    /// Throws     UsageError for any other field, two fields, or a field in the folder's name.
    explicit NumberedPath(const std::string& pattern);

    bool has_number() const { return has_number_; }
    const std::filesystem::path& folder() const { return folder_; }  ///< "." where the pattern names none.
    std::string extension() const;                                   ///< With its dot.
    std::filesystem::path operator()(int number) const;

private:
    std::filesystem::path folder_;
    std::string before_, after_;  ///< Of the file's name.
    bool has_number_ = false;
    char fill_ = ' ';
    int width_ = 0;
};

}  // namespace zoe
