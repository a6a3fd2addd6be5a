// `pelage` run as a process of its own, in a temporary folder with its cache there. Arguments that start with '@' name
// files in that folder.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include "../data_schema/temporary.h"

namespace pelage::test {

struct Result {
  int code;  // exit code, or minus the signal
  std::string out, err;
};

class Child {
 public:
  /// @param environment  "NAME=value", or "NAME" to unset it
  Child(const TemporaryFolder& folder, std::vector<std::string> arguments, std::vector<std::string> environment = {},
        const std::string& program = PELAGE_PROGRAM)
      : folder_(folder) {
    for (std::string& argument : arguments)
      if (argument.starts_with('@')) argument = (folder / argument.substr(1)).string();
    arguments.insert(arguments.begin(), program);
    environment.insert(environment.begin(), "PELAGE_CACHE=" + (folder / "cache").string());
    process_ = fork();
    if (process_ == 0) run(arguments, environment);
  }
  void signal(int number) const { kill(process_, number); }
  /// Has it set its own handler for the signal, as both programs do before a verb's work begins?
  bool catches(int number) const {
    const std::string status = text_of("/proc/" + std::to_string(process_) + "/status"), key = "SigCgt:\t";
    const std::size_t at = status.find(key);
    return at != std::string::npos &&
           (std::stoull(status.substr(at + key.size(), 16), nullptr, 16) >> (number - 1) & 1) != 0;
  }
  /// Has it not ended yet? Asks without waiting, and leaves the exit status to wait().
  bool is_running() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
  }
  std::string err() const { return text_of(folder_ / "stderr"); }
  Result wait() const {
    int status = 0;
    waitpid(process_, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), text_of(folder_ / "stdout"), err()};
  }

 private:
  [[noreturn]] void run(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
    for (const auto& [name, to] : {std::pair("stdout", STDOUT_FILENO), std::pair("stderr", STDERR_FILENO)})
      dup2(open((folder_ / name).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644), to);
    for (const std::string& each : environment) {
      const std::size_t equals = each.find('=');
      if (equals == std::string::npos)
        unsetenv(each.c_str());
      else
        setenv(each.substr(0, equals).c_str(), each.substr(equals + 1).c_str(), 1);
    }
    std::vector<char*> list;
    for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
    list.push_back(nullptr);
    execvp(list[0], list.data());
    _exit(127);
  }

  const TemporaryFolder& folder_;
  pid_t process_;
};

inline Result run(const TemporaryFolder& folder, std::vector<std::string> arguments,
                  std::vector<std::string> environment = {}) {
  return Child(folder, std::move(arguments), std::move(environment)).wait();
}

inline const std::string kExamples = PELAGE_SOURCE_DIR "/data_schema/examples/";

}  // namespace pelage::test
