// The frame of both programs, seen from outside: exit codes, one-line messages, Ctrl-C (hard case 32).
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
namespace fs = std::filesystem;

struct Result {
  int code;  // exit code, or minus the signal
  std::string out, err;
};

/// A running probe with its output in files of a temporary folder.
class Probe {
 public:
  explicit Probe(std::vector<std::string> arguments) {
    std::string name = (fs::temp_directory_path() / "pelage-probe-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    for (std::string& argument : arguments)
      if (argument.starts_with('@')) argument = (folder_ / argument.substr(1)).string();
    arguments.insert(arguments.begin(), PELAGE_CONSOLE_PROBE);
    process_ = fork();
    if (process_ == 0) run(arguments);
  }
  ~Probe() { fs::remove_all(folder_); }
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  Result wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), text("stdout"), text("stderr")};
  }
  void wait_until_started() {
    for (int i = 0; i < 1000 && text("stdout").empty(); ++i) usleep(5000);
  }
  void signal(int number) { kill(process_, number); }
  std::string text(const std::string& name) const {
    std::ifstream in(folder_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder() const { return folder_; }

 private:
  void run(const std::vector<std::string>& arguments) {
    const auto redirect = [&](const char* name, int to) {
      dup2(open((folder_ / name).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644), to);
    };
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    std::vector<char*> list;
    for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
    list.push_back(nullptr);
    execv(list[0], list.data());
    _exit(127);
  }

  fs::path folder_;
  pid_t process_;
};

Result run(std::vector<std::string> arguments) {
  return Probe(std::move(arguments)).wait();
}

TEST(Program, ErrorsBecomeExitCodesAndOneLine) {
  const std::vector<std::pair<std::string, int>> codes = {
      {"input", 4}, {"output", 1}, {"usage", 2}, {"graphics", 5}, {"memory", 1}, {"other", 1}, {"threshold", 3}};
  for (const auto& [name, code] : codes) {
    const Result result = run({"go", "--throw", name, "--progress", "never"});
    EXPECT_EQ(result.code, code) << name;
    if (name == "threshold") continue;
    EXPECT_THAT(result.err, StartsWith("probe: ")) << name;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << name;
    EXPECT_EQ(result.out, "") << name;
  }
  EXPECT_THAT(run({"go", "--throw", "input"}).err, Not(HasSubstr("\x1b"))) << "a file cannot colour the terminal";
}

TEST(Program, WrongCommandLinesAreUsageErrors) {
  const auto expect_usage = [](std::vector<std::string> arguments, const std::string& message) {
    const Result result = run(std::move(arguments));
    EXPECT_EQ(result.code, 2);
    EXPECT_THAT(result.err, AllOf(StartsWith("probe: "), HasSubstr(message)));
  };
  expect_usage({}, "A subcommand is required");
  expect_usage({"come"}, "there is no verb come");
  expect_usage({"go", "--nmber", "1"}, "--nmber (see probe go --help)");
  expect_usage({"go", "--number", "nan"}, "--number: nan is not finite: give a number in [0, 1]");
  expect_usage({"go", "--list", "1,inf,2"}, "inf is not finite");
  expect_usage({"go", "-j", "-1"}, "--jobs");
  expect_usage({"go", "--progress", "maybe"}, "--progress");
  expect_usage({"go", "--log-level", "loud"}, "--log-level");
}

TEST(Program, HelpShowsDefaultsAndVersionIsThere) {
  const Result help = run({"go", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("--number FLOAT=0.25"), HasSubstr("=auto"), HasSubstr("--jobs")));
  EXPECT_EQ(run({"--help"}).code, 0);
  const Result version = run({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_THAT(version.out, StartsWith("probe "));
}

TEST(Program, OptionsReachTheVerb) {
  const Result result = run({"go", "--number", "0.5", "--list", "-1,2,3e4", "--json", "-j", "3"});
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.out, "0.5 3 1 3\n");
}

TEST(Program, ProgressStaysOffWhereItIsNotSeen) {
  EXPECT_EQ(run({"go"}).err, "") << "0.2 s of work: nothing to say off a terminal";
  EXPECT_EQ(run({"go", "--progress", "never"}).err, "");
  const std::string bar = run({"go", "--progress", "always"}).err;
  EXPECT_THAT(bar, AllOf(HasSubstr("[########################] probe: 100 %, 40/40 steps"), HasSubstr("steps/s")));
  EXPECT_EQ(bar.back(), '\n');
}

TEST(Program, FullDiskOnStandardOutputIsAFailure) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string command = std::string(PELAGE_CONSOLE_PROBE) + " go > /dev/full 2> /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
}

TEST(Program, InterruptedWorkKeepsTheEarlierFileAndLeavesNoTemporary) {
  for (const int number : {SIGINT, SIGTERM}) {
    Probe probe({"go", "--write", "@out"});
    std::ofstream(probe.folder() / "out") << "earlier";
    probe.wait_until_started();
    probe.signal(number);
    const Result result = probe.wait();
    EXPECT_EQ(result.code, 130);
    EXPECT_EQ(result.err, "probe: interrupted\n");
    EXPECT_EQ(probe.text("out"), "earlier");
    EXPECT_EQ(std::distance(fs::directory_iterator(probe.folder()), {}), 3) << "out, stdout, stderr";
  }
}

TEST(Program, SecondInterruptKills) {
  Probe probe({"go", "--write", "@out", "--deaf"});
  probe.wait_until_started();
  probe.signal(SIGINT);
  usleep(200'000);
  probe.signal(SIGINT);
  EXPECT_EQ(probe.wait().code, -SIGINT);
}

}  // namespace
