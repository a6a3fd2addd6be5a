// The verbs of program `pelage-bake`: each adds its subcommand, options and callback. One file per verb. Results are
// numbers or JSON on stdout.
#pragma once

namespace CLI {
class App;
}

namespace pelage {

void add_build(CLI::App& app);
void add_merge(CLI::App& app);
void add_info(CLI::App& app);
void add_verify(CLI::App& app);
void add_query(CLI::App& app);

}  // namespace pelage
