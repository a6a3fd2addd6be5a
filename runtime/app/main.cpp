#include "pelage/app/verbs.h"
#include "pelage/console/program.h"

int main(int argc, char** argv) {
  CLI::App app{"Pelage renders hair from a precomputed appearance database, and shows what accuracy costs in time.",
               "pelage"};
  app.require_subcommand(1);
#ifdef HAVE_groom
  pelage::app::add_groom(app);
#endif
#ifdef HAVE_info
  pelage::app::add_info(app);
#endif
#ifdef HAVE_cluster
  pelage::app::add_cluster(app);
#endif
  pelage::app::add_render(app);
  pelage::app::add_view(app);
  return pelage::console::run_program(app, argc, argv);
}
