// A verb of a program: its options, and which of them name files. What it reads and writes is checked before its work
// begins, so that a verb whose files are declared here cannot destroy its own input.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pelage/data_schema/output_file.h"

namespace pelage::console {

/// More about a file that a verb writes.
struct OutputFile {
  std::vector<std::string> beside;  // endings of further files, which are written or deleted beside it
  std::string remedy = "name another file";
};
/// Files that a verb writes into a folder.
struct FilesInFolder {
  std::string names;  // as Output::names
  std::string below;  // in this folder of the folder; empty: in the folder itself
};

class Verb : public CLI::App {
 public:
  Verb(const std::string& name, const std::string& description) : CLI::App(description, name) {}

  /// An option, or positional, that names a file to read, or several. Words that stand for no file do no harm.
  template <class Path>
  CLI::Option* add_input(const std::string& names, Path& path, const std::string& description) {
    inputs_.push_back(add_option(names, path, description)->type_name("FILE"));
    return inputs_.back();
  }
  /// A file to write.
  template <class Path>
  CLI::Option* add_output(const std::string& names, Path& path, const std::string& description,
                          const OutputFile& file = {}) {
    CLI::Option* const option = add_option(names, path, description)->type_name("FILE");
    outputs_.push_back({option, "", {}, file.remedy});
    for (const std::string& ending : file.beside) outputs_.push_back({option, ending, {}, file.remedy});
    return option;
  }
  /// A folder to write files into.
  template <class Path>
  CLI::Option* add_output_folder(const std::string& names, Path& path, const std::string& description,
                                 const std::vector<FilesInFolder>& files) {
    CLI::Option* const option = add_option(names, path, description)->type_name("FOLDER");
    for (const FilesInFolder& each : files) outputs_.push_back({option, "", each, "name another folder"});
    return option;
  }

  /// What the verb does once its options are read and its files are checked.
  void runs(std::function<void()> work);
  /// For inputs that show later, such as the files that a scene file names; before the work all the same.
  /// @throws UsageError for outputs that would write over them, over an input that was given or over each other
  void check_files(std::vector<NamedFile> inputs = {}) const;

 private:
  using CLI::App::callback;  // runs() is the way: it checks
  struct Written {
    const CLI::Option* option;
    std::string ending;
    FilesInFolder files;  // of a folder
    std::string remedy;
  };
  static Output output_of(const Written& written, const std::string& path);

  std::vector<CLI::Option*> inputs_;
  std::vector<Written> outputs_;
};

/// Adds a verb to a program, which owns it.
Verb* add_verb(CLI::App& program, const std::string& name, const std::string& description);

}  // namespace pelage::console
