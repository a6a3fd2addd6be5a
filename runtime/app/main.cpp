#include <CLI/CLI.hpp>

#include "pelage/app/verbs.h"
#include "pelage/console/program.h"

int main(int argc, char** argv) {
  CLI::App app{"Pelage renders hair from a precomputed appearance database, and shows what accuracy costs in time.",
               "pelage"};
  app.require_subcommand(1);
  pelage::app::add_groom(app);
  pelage::app::add_info(app);
  pelage::app::add_convert(app);
  pelage::app::add_cluster(app);
  pelage::app::add_render(app);
  pelage::app::add_view(app);
  pelage::app::add_simulate(app);
  pelage::app::add_shadow_error(app);
  pelage::app::add_figure(app);
  pelage::app::add_compare(app);
  pelage::app::add_tradeoff(app);
  return pelage::console::run_program(app, argc, argv);
}
