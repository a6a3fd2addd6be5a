#include "pelage/console/progress.h"

#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pelage/console/program.h"

namespace pelage::console {
namespace {

constexpr auto kBarPeriod = std::chrono::milliseconds(100);
constexpr auto kLinePeriod = std::chrono::seconds(5);
constexpr std::size_t kBarCells = 24;

bool on_terminal() {
  return isatty(STDERR_FILENO) != 0;
}

std::size_t terminal_columns() {
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string duration(double seconds) {
  const auto s = static_cast<std::uint64_t>(std::ceil(std::min(seconds, 3.6e8)));  // bounds the cast
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string bar(std::uint64_t done, std::uint64_t total) {
  const auto filled = static_cast<std::size_t>(done * kBarCells / total);
  return "[" + std::string(filled, '#') + std::string(kBarCells - filled, '.') + "] ";
}

}  // namespace

std::string progress_text(const std::string& label, const std::string& unit, const ProgressState& state) {
  const std::uint64_t total = std::max<std::uint64_t>(state.total, 1), done = std::min(state.done, total);
  std::string text =
      fmt::format("{}: {:.0f} %, {}/{} {}", label,
                  std::floor(100.0 * static_cast<double>(done) / static_cast<double>(total)), done, total, unit);
  if (state.elapsed_s <= 0 || done <= state.first_done) return text;
  const double rate = static_cast<double>(done - state.first_done) / state.elapsed_s;
  text += fmt::format(", {:.{}f} {}/s", rate, rate < 10 ? 1 : 0, unit);
  if (done < total) return text + ", ETA " + duration(static_cast<double>(total - done) / rate);
  return text + ", " + duration(state.elapsed_s);
}

Progress::Progress(std::string label, std::uint64_t total, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      total_(std::max<std::uint64_t>(total, 1)),
      bar_(common().progress == "always" || (common().progress == "auto" && on_terminal())),
      silent_(common().progress == "never"),
      start_(std::chrono::steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_ && bar_) std::fputc('\n', stderr);
}

void Progress::update(std::uint64_t done) {
  if (silent_) return;
  const auto now = std::chrono::steady_clock::now();
  if (first_) {
    first_ = false;
    first_done_ = done;
    start_ = now;
  }
  const bool finished = done >= total_ && (bar_ || drawn_);
  const bool due = now - last_ >= (bar_ ? std::chrono::duration<double>(kBarPeriod) : kLinePeriod);
  if (!due && !finished) return;
  last_ = now;
  draw(done);
}

void Progress::draw(std::uint64_t done) {
  const double elapsed_s = std::chrono::duration<double>(last_ - start_).count();
  std::string text = progress_text(label_, unit_, {done, total_, first_done_, elapsed_s});
  drawn_ = true;
  if (!bar_) {
    std::fprintf(stderr, "%s\n", text.c_str());
    return;
  }
  text = bar(std::min(done, total_), total_) + text;
  if (text.size() >= terminal_columns()) text.resize(terminal_columns() - 1);  // a wrapped line could not be redrawn
  std::fprintf(stderr, "\r\x1b[K%s", text.c_str());
}

}  // namespace pelage::console
