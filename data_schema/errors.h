// Typed exceptions for cold edges (files, databases, options). Each says what, where, which value, and the remedy.
// Libraries throw them; only the programs turn them into a message and an exit code (bake/console/exit_codes.h).
#pragma once

#include <cassert>
#include <stdexcept>
#include <string>

namespace pelage {

/// The input is wrong: a file that cannot be read or holds an impossible value. Exit code 4.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& where, const std::string& what) : std::runtime_error(where + ": " + what) {}
};

/// The output cannot be written. Exit code 1.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::string& where, const std::string& what) : std::runtime_error(where + ": " + what) {}
};

/// An option or a combination of options makes no sense. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// No OpenGL, or one that is too old. Exit code 5.
class GraphicsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user asked to stop (Ctrl-C). Exit code 130; work done so far is kept.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace pelage

/// A broken contract between functions of this program (never a property of somebody's file).
#define PELAGE_ASSERT(condition) assert(condition)
