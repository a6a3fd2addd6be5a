// The verbs of program `pelage`: each adds its subcommand, options and callback. One file per verb.
#pragma once

namespace CLI {
class App;
}

namespace pelage::app {

void add_groom(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_cluster(CLI::App& app);
void add_render(CLI::App& app);
void add_view(CLI::App& app);
void add_simulate(CLI::App& app);
void add_shadow_error(CLI::App& app);
void add_figure(CLI::App& app);
void add_compare(CLI::App& app);
void add_tradeoff(CLI::App& app);

}  // namespace pelage::app
