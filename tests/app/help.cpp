#include "help.h"

#include <regex>
#include <sstream>

namespace pelage::test {
namespace {

/// Of the lines that begin with two spaces and a name: `  -o,--out TEXT REQUIRED  Picture ...`.
std::vector<Option> options_in(const std::string& help) {
  static const std::regex line(R"(^  (-\w,)?((--)?[a-z][a-z-]*) (FLOAT|INT|UINT|TEXT|FILE|FOLDER)(.*)$)");
  std::vector<Option> options;
  std::istringstream in(help);
  for (std::string text; std::getline(in, text);) {
    std::smatch m;
    if (std::regex_match(text, m, line)) {
      const bool required = m[5].str().find("REQUIRED") != std::string::npos;
      options.push_back({m[2], m[4], m[5], required, !m[3].matched});
    } else if (!options.empty()) {
      options.back().about += " " + text;
    }
  }
  return options;
}

}  // namespace

std::vector<std::string> verbs_of(const Program& program, const TemporaryFolder& folder) {
  const std::string help = run_here(program, folder, {"--help"}).out;
  std::istringstream in(help.substr(std::min(help.find("\nSubcommands:"), help.size())));
  static const std::regex line(R"(^  ([a-z][a-z-]*)( .*)?$)");
  std::vector<std::string> verbs;
  for (std::string text; std::getline(in, text);)
    if (std::smatch m; std::regex_match(text, m, line)) verbs.push_back(m[1]);
  return verbs;
}

std::vector<Option> options_of(const Program& program, const TemporaryFolder& folder, const std::string& verb) {
  return options_in(run_here(program, folder, {verb, "--help"}).out);
}

}  // namespace pelage::test
