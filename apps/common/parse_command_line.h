#pragma once

namespace CLI {
class App;
}

namespace zoe {

/// Reads the command line into what the app's options are bound to. Asked for help, it prints that.
/// Returns    false where help was printed: the program is done.
/// Throws     UsageError with one line; also where an option's value is empty.
bool parse_command_line(CLI::App& app, int argc, char** argv);

}  // namespace zoe
