// What `--help` of both programs says, read back: their verbs and the options of each.
#pragma once

#include <string>
#include <vector>

#include "in_process.h"

namespace pelage::test {

struct Option {
  std::string name;   // "--size"; of a positional "input"
  std::string kind;   // "FLOAT", "INT", "UINT", "TEXT", "FILE", "FOLDER"
  std::string about;  // from the kind to the next option
  bool required = false, positional = false;
};

/// The verbs that `program --help` lists.
std::vector<std::string> verbs_of(const Program& program, const TemporaryFolder& folder);
/// The options of a verb that take a value.
std::vector<Option> options_of(const Program& program, const TemporaryFolder& folder, const std::string& verb);

}  // namespace pelage::test
