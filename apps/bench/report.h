#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/common/stats_json.h"

namespace zoe {

/// The lines above all tables: what the numbers were measured on, and what the columns are.
std::string machine_text(const std::vector<std::pair<std::string, std::string>>& machine);

/// A table for people: a line a scene, a column a stage (median ms), the ratio to the peer, and the frames' times as a
/// sparkline from 0 to the longest.
std::string stages_heading(bool has_peer);
std::string stages_line(const RunStats& run);

/// A second table: millions of rays a second by kind, and with a peer how both compare, what it was set up as, and who is
/// right where hits differ.
std::string rays_table(const std::vector<RunStats>& runs);

/// A line a scene and frame, with a heading.
std::string csv(const std::vector<RunStats>& runs);

/// Bars from 0 to the largest value, in at most `max_width` characters: the mean of neighbours where there are more.
std::string sparkline(const std::vector<double>& values, size_t max_width);

}  // namespace zoe
