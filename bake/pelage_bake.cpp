// Program `pelage-bake`: builds, merges, describes, verifies and queries HRIR databases. It links no OpenGL and no
// OpenImageIO, so that it runs on farm nodes.
#include <CLI/CLI.hpp>

#include "pelage/bake/verbs.h"
#include "pelage/console/program.h"

int main(int argc, char** argv) {
  CLI::App app{"pelage-bake precomputes how small cross-sections of hair look.", "pelage-bake"};
  pelage::add_build(app);
  pelage::add_merge(app);
  pelage::add_info(app);
  pelage::add_verify(app);
  pelage::add_query(app);
  return pelage::console::run_program(app, argc, argv);
}
