#include "apps/common/parse_command_line.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/common/usage_error.h"

namespace zoe {

bool parse_command_line(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", app.help());
        return false;
    } catch (const CLI::ParseError& error) {
        throw UsageError(fmt::format("{}; --help lists the options", error.what()));
    }
    // What reads numbers takes nothing for 0.
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() > 0 && option->results().back().empty())
            throw UsageError(fmt::format("{}: its value is empty", option->get_name()));
    }
    return true;
}

}  // namespace zoe
