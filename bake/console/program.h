// What both programs share: options, exit codes, interruption. DESIGN section 10.
#pragma once

#include <cstdint>
#include <string>

namespace CLI {
class App;
}

namespace pelage::console {

/// Exit codes of both programs.
enum ExitCode { ok = 0, failure = 1, usage = 2, threshold = 3, bad_input = 4, no_opengl = 5, interrupted = 130 };

/// Options that every verb has; set before a verb's callback runs.
struct CommonOptions {
  int jobs = 0;                    // -j: threads; 0: one per core
  std::string progress = "auto";   // --progress auto|always|never
  std::string log_level = "info";  // --log-level trace|debug|info|warn|error|off
  bool json = false;               // --json: results on stdout as JSON
};

/// The options as given on the command line of this process.
const CommonOptions& common() noexcept;

/// Adds the common options to a verb. Call at the end of each add_<verb>().
void add_common_options(CLI::App& verb);

/// Parses, sets up log (spdlog, stderr), thread count (oneTBB) and Ctrl-C, runs the chosen verb's callback, and turns
/// exceptions into one-line messages on stderr and exit codes; so too SIGBUS, which comes when a mapped database is cut
/// off by somebody else while it is read. main() is `return run_program(app, argc, argv);`.
int run_program(CLI::App& app, int argc, char** argv);

/// Ctrl-C was pressed (SIGINT or SIGTERM).
bool is_interrupted() noexcept;
/// @throws Interrupted after Ctrl-C
void throw_if_interrupted();
/// A verb's way to end with a code other than 0 without an error: e.g. threshold.
void set_exit_code(int code) noexcept;

}  // namespace pelage::console
