#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/chart/csv.h"

namespace zoe::chart {

/// The page that shows charts: question, picture, finding, and the command that made each.
/// tables     as `Sweep::finish` left them, in the order of the page.
/// has_picture  [tables] Where there is none, the page says so.
std::string page(const std::vector<Table>& tables, const std::vector<bool>& has_picture);

/// Writes index.html of all charts that the folder holds, of those named.
/// names      in the order of the page.
/// Throws     std::runtime_error with the file and the reason.
void write_page(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace zoe::chart
