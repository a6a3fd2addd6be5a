// A program run by the shell, with what it says.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <string>

namespace pelage::fixtures {

struct Ran {
  std::string text;  // both streams
  int code;          // exit code, -1: none
};

inline Ran run_program(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {"", -1};
  std::string text;
  char part[512];
  while (std::fgets(part, sizeof part, pipe) != nullptr) text += part;
  const int status = pclose(pipe);
  return {text, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

}  // namespace pelage::fixtures
