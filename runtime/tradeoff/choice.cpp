#include "pelage/tradeoff/choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace pelage {
namespace {

/// Of a logarithm: what two candidates' ratio may differ by between scenes even where the references agree.
constexpr double kLeastVariance = 0.01;
constexpr double kTiny = 1e-12;

struct Estimate {
  double error, ms;
};

double log_of(double value) {
  return std::log(std::max(value, kTiny));
}

/// Of what `b` is measured as when `a` is known: the mean over the references of log(b / a), and its variance.
struct Ratio {
  double log_mean, variance;
};
Ratio ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double sum = 0, squares = 0;
  for (std::size_t r = 0; r < a.size(); ++r) {
    const double log_ratio = log_of(b[r]) - log_of(a[r]);
    sum += log_ratio;
    squares += log_ratio * log_ratio;
  }
  const double mean = sum / n;
  return {mean, std::max(squares / n - mean * mean, 0.0) + kLeastVariance};
}

class Search {
 public:
  Search(const std::vector<Candidate>& ladder, const Goal& goal) : ladder_(ladder), goal_(goal) {
    if (ladder.empty()) throw std::invalid_argument("choose: no candidates");
    if (!goal.budget_ms && !goal.target_error) throw std::invalid_argument("choose: no goal");
    for (const Candidate& c : ladder)
      if (c.error.empty() || c.error.size() != ladder[0].error.size() || c.ms.size() != c.error.size())
        throw std::invalid_argument("choose: candidates of different references");
  }

  /// Known where it was probed; else every probe's figure scaled as the references' are, the alike ones counting most.
  Estimate estimate(std::size_t c) const {
    if (const ProbedCandidate* const p = probed(c)) return {p->probe.error + p->probe.error_bar, p->probe.ms};
    double error = 0, ms = 0, error_weight = 0, ms_weight = 0;
    for (const ProbedCandidate& p : tried_) {
      const Ratio e = ratio(ladder_[p.candidate].error, ladder_[c].error),
                  t = ratio(ladder_[p.candidate].ms, ladder_[c].ms);
      error += (log_of(p.probe.error) + e.log_mean) / e.variance;
      error_weight += 1 / e.variance;
      ms += (log_of(p.probe.ms) + t.log_mean) / t.variance;
      ms_weight += 1 / t.variance;
    }
    if (!tried_.empty()) return {std::exp(error / error_weight), std::exp(ms / ms_weight)};
    for (std::size_t r = 0; r < ladder_[c].error.size(); ++r)
      error += log_of(ladder_[c].error[r]), ms += log_of(ladder_[c].ms[r]);
    const auto n = static_cast<double>(ladder_[c].error.size());
    return {std::exp(error / n), std::exp(ms / n)};
  }

  /// The best that is expected to meet the goal; else what comes closest. @param only_probed  what is not, is no choice
  std::size_t best(bool only_probed) const {
    std::size_t best = ladder_.size();
    double least = 0;
    bool best_meets = false;
    for (std::size_t c = 0; c < ladder_.size(); ++c) {
      if (only_probed && probed(c) == nullptr) continue;
      const Estimate e = estimate(c);
      const bool meets = this->meets(e);
      const double rank = meets ? (goal_.target_error ? e.ms : e.error) : miss(e);
      if (best == ladder_.size() || meets > best_meets || (meets == best_meets && rank < least))
        best = c, least = rank, best_meets = meets;
    }
    return best;
  }

  void probe(std::size_t c, const std::function<Probe(std::size_t)>& measure) {
    const Estimate e = estimate(c);
    tried_.push_back({c, e.error, e.ms, measure(c)});
  }

  const ProbedCandidate* probed(std::size_t c) const {
    for (const ProbedCandidate& p : tried_)
      if (p.candidate == c) return &p;
    return nullptr;
  }

  Choice result() const {
    const std::size_t c = best(true);
    const ProbedCandidate& p = *probed(c);
    return {c, meets(estimate(c)), p.predicted_error, p.predicted_ms, p.probe, tried_};
  }

  std::size_t probes() const { return tried_.size(); }

 private:
  bool meets(const Estimate& e) const {
    return (!goal_.target_error || e.error <= *goal_.target_error) && (!goal_.budget_ms || e.ms <= *goal_.budget_ms);
  }
  /// By how many times the goals are missed, the worse of both.
  double miss(const Estimate& e) const {
    double worst = 0;
    if (goal_.target_error) worst = std::max(worst, e.error / *goal_.target_error);
    if (goal_.budget_ms) worst = std::max(worst, e.ms / *goal_.budget_ms);
    return worst;
  }

  const std::vector<Candidate>& ladder_;
  const Goal& goal_;
  std::vector<ProbedCandidate> tried_;
};

}  // namespace

Choice choose(const std::vector<Candidate>& ladder, const Goal& goal,
              const std::function<Probe(std::size_t candidate)>& probe, int most) {
  Search search(ladder, goal);
  for (int i = 0; i < std::max(most, 1); ++i) {
    const std::size_t next = search.best(false);
    if (search.probed(next) != nullptr) break;
    search.probe(next, probe);
  }
  return search.result();
}

}  // namespace pelage
