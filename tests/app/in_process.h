// Both programs' main() called in the test's own process: `pelage` as a process takes .2 s to load.
#pragma once

#include <string>
#include <vector>

#include "../data_schema/temporary.h"

namespace pelage::test {

struct Program {
  const char* name;
  int (*main)(int, char**);
};
extern const Program kPelage, kBake;

struct ResultHere {
  int code;
  std::string out, err;
};

/// @param words  those that begin with '@' name files in the folder
ResultHere run_here(const Program& program, const TemporaryFolder& folder, std::vector<std::string> words);

}  // namespace pelage::test
