#include "pelage/console/verb.h"

#include <filesystem>
#include <memory>

namespace pelage::console {
namespace {

/// "--output", or of a positional "the input".
std::string spoken(const CLI::Option& option) {
  return (option.get_positional() ? "the " : "") + option.get_name();
}

}  // namespace

Output Verb::output_of(const Written& written, const std::string& path) {
  std::filesystem::path place = path + written.ending;
  if (!written.files.below.empty()) place /= written.files.below;
  return {spoken(*written.option), place, written.files.names, written.remedy};
}

void Verb::check_files(std::vector<NamedFile> inputs) const {
  std::vector<Output> outputs;
  for (const Written& written : outputs_)
    for (const std::string& path : written.option->results())
      if (!path.empty()) outputs.push_back(output_of(written, path));
  for (const CLI::Option* const option : inputs_)
    for (const std::string& path : option->results()) inputs.push_back({spoken(*option), path});
  check_apart(outputs, inputs);
}

void Verb::runs(std::function<void()> work) {
  callback([this, work = std::move(work)] {
    check_files();
    work();
  });
}

Verb* add_verb(CLI::App& program, const std::string& name, const std::string& description) {
  const auto verb = std::make_shared<Verb>(name, description);
  program.add_subcommand(verb);
  return verb.get();
}

}  // namespace pelage::console
