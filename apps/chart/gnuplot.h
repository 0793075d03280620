#pragma once

#include <filesystem>
#include <string>

#include "apps/chart/chart.h"

namespace zoe::chart {

/// The chart as a program for gnuplot that holds its points and writes NAME.svg and NAME.png where it is run.
std::string gnuplot_program(const Chart& chart);

/// Runs it: writes NAME.svg and NAME.png beside the program, each whole or not at all.
/// program    NAME.gp
/// Throws     std::runtime_error where gnuplot is not installed or fails, with the program's name and what to do.
void draw(const std::filesystem::path& program);

}  // namespace zoe::chart
