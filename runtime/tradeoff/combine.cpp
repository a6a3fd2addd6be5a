#include "pelage/tradeoff/combine.h"

#include <algorithm>
#include <cmath>

namespace pelage {
namespace {

/// Of the base's squared error, what a knob cannot take away for certain.
constexpr double kLeastShare = 0.05;
/// Combinations looked at; what would be more is built of the better part of each knob's values.
constexpr std::size_t kMost = 200'000;

struct Guess {
  std::vector<std::string> settings;
  double square, ms;  // of the error; time
  int knobs = 0;
};

bool is_dominated(const Guess& guess, std::span<const TradeoffRow> known) {
  return std::any_of(known.begin(), known.end(), [&](const TradeoffRow& row) {
    return row.failed.empty() && row.time.median_ms <= guess.ms && row.error * row.error <= guess.square;
  });
}

/// Fastest first, each more accurate than those before.
std::vector<Guess> front_of(std::vector<Guess> guesses) {
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const Guess& a, const Guess& b) { return a.ms != b.ms ? a.ms < b.ms : a.square < b.square; });
  std::vector<Guess> front;
  for (Guess& guess : guesses)
    if (front.empty() || guess.square < front.back().square) front.push_back(std::move(guess));
  return front;
}

}  // namespace

std::vector<std::vector<std::string>> worth_combining(const SinglePoint& base, std::span<const SinglePoint> singles,
                                                      std::span<const TradeoffRow> known, std::size_t most) {
  const double base_square = base.error * base.error;
  std::vector<std::string> knobs;
  for (const SinglePoint& p : singles)
    if (std::find(knobs.begin(), knobs.end(), p.knob) == knobs.end()) knobs.push_back(p.knob);
  std::vector<Guess> guesses{{{}, base_square, base.ms, 0}};
  for (const std::string& knob : knobs) {
    const std::size_t before = guesses.size();
    for (const SinglePoint& p : singles) {
      // Slower and no more accurate than the base: never worth it.
      if (p.knob != knob || p.settings.empty() || (p.ms >= base.ms && p.error >= base.error)) continue;
      for (std::size_t i = 0; i < before && guesses.size() < kMost; ++i) {
        Guess guess = guesses[i];
        guess.settings.insert(guess.settings.end(), p.settings.begin(), p.settings.end());
        guess.square = std::max(guess.square + p.error * p.error - base_square, kLeastShare * base_square);
        guess.ms *= base.ms > 0 ? p.ms / base.ms : 1;
        ++guess.knobs;
        guesses.push_back(std::move(guess));
      }
    }
  }
  std::vector<Guess> front = front_of(std::move(guesses));
  std::erase_if(front, [&](const Guess& guess) { return guess.knobs < 2 || is_dominated(guess, known); });
  std::vector<std::vector<std::string>> chosen;
  const std::size_t count = std::min(most, front.size());
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(front[count > 1 ? i * (front.size() - 1) / (count - 1) : 0].settings);
  return chosen;
}

}  // namespace pelage
