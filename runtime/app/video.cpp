#include "pelage/app/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <vector>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"

extern char** environ;

namespace pelage::app {
namespace {

bool is_installed(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

/// Runs a program without a shell; @return its exit status, or -1 where it did not start or was killed
int run(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);  // results alone go to ours
  pid_t child = 0;
  const int failed = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (failed != 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

}  // namespace

void check_video(const std::filesystem::path& file) {
  if (!is_installed("ffmpeg"))
    throw UsageError(
        "--video: ffmpeg makes videos and is not installed: install it (apt install ffmpeg), or leave "
        "--video out and keep the pictures");
  check_writable(file);
}

void make_video(const std::filesystem::path& folder, int frames, double fps, const std::filesystem::path& file) {
  std::string pictures;
  for (const char c : (folder / "frame_").string()) pictures += c == '%' ? "%%" : std::string(1, c);
  pictures += "%04d.png";
  AtomicFile out(file);
  // Players want 4:2:0, which wants even sizes.
  const int status = run({"ffmpeg", "-y", "-loglevel", "error", "-framerate", fmt::format("{}", fps), "-start_number",
                          "0", "-i", pictures, "-frames:v", std::to_string(frames), "-vf",
                          "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", out.temporary().string()});
  if (status != 0)
    throw OutputError(file.string(),
                      fmt::format("ffmpeg ended with {}; the pictures are there: {}", status, folder.string()));
  out.commit();
}

}  // namespace pelage::app
