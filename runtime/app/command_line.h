// The command line as text, for reports that say how they were made.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pelage::app {

/// One word of a command line, quoted for a POSIX shell where it must be.
std::string shell_word(const std::string& word);

/// Input and options as they were given, besides those that `left_out` names, each with a space before it.
std::string words_of(const CLI::App& verb, const std::vector<std::string>& left_out);

}  // namespace pelage::app
