#include "pelage/app/verbs.h"

namespace pelage::app {

void add_view(CLI::App& app) { (void)app; }

}  // namespace pelage::app
