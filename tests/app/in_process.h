// Both programs' main() called in the test's own process: `pelage` as a process takes .2 s to load.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "../data_schema/temporary.h"

namespace pelage::test {

struct Program {
  const char* name;
  int (*main)(int, char**);
};
/// In the test's name, which would hold addresses otherwise.
inline void PrintTo(const Program& program, std::ostream* out) {
  *out << program.name;
}
extern const Program kPelage, kBake;

struct ResultHere {
  int code;
  std::string out, err;
};

/// @param words  those that begin with '@' name files in the folder
ResultHere run_here(const Program& program, const TemporaryFolder& folder, std::vector<std::string> words);

}  // namespace pelage::test
