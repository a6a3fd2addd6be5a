#include "pelage/app/compare_thresholds.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/validate.h"

namespace pelage::app {
namespace {

struct Metric {
  const char* name;
  double (*value)(const ComparedMethod&);
};
const std::vector<Metric>& metrics() {
  using M = ComparedMethod;
  static const std::vector<Metric> all{{"rmse", [](const M& m) { return m.error.rmse; }},
                                       {"bias", [](const M& m) { return std::abs(m.error.bias); }},
                                       {"rel-mse", [](const M& m) { return m.error.rel_mse; }},
                                       {"psnr-db", [](const M& m) { return m.error.psnr_db; }},
                                       {"flip", [](const M& m) { return m.error.flip; }},
                                       {"max", [](const M& m) { return m.error.max; }},
                                       {"ms", [](const M& m) { return m.first_ms; }},
                                       {"flicker", [](const M& m) { return m.flicker; }}};
  return all;
}

/// @throws UsageError with the nearest one of `known`
void check_name(const std::string& name, const std::vector<std::string>& known, const std::string& what) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw UsageError("--threshold: there is no " + what + " '" + name + "' here; the nearest is " +
                   nearest_word(name, known));
}

double number(const std::string& text, const std::string& whole) {
  double value = NAN;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw UsageError("--threshold: '" + whole + "' is not METRIC=VALUE or METHOD:METRIC=VALUE, e.g. flip=0.1");
  return value;
}

/// Of a picture, or of the frame that is worst.
std::string violation(const ComparedMethod& m, const Threshold& t, const Metric& metric) {
  if (!m.failed.empty()) return fmt::format("{}: {} cannot be held, there is no picture: {}", m.id, t.metric, m.failed);
  const bool at_least = t.metric == "psnr-db";
  double worst = metric.value(m);
  std::size_t frame = 0;
  ComparedMethod shown = m;
  for (std::size_t k = 1; k < m.frames.size(); ++k) {
    shown.error = m.frames[k].error;
    const double value = metric.value(shown);
    const bool worse = !(at_least ? value >= worst : value <= worst);  // or no number
    if (worse && !std::isnan(worst)) worst = value, frame = k;
  }
  if (at_least ? worst >= t.limit : worst <= t.limit) return "";
  const std::string where = frame > 0 ? fmt::format(" in frame {}", frame) : "";
  return fmt::format("{}: {} is {:.6g}{}, {} {:g}", m.id, t.metric, worst, where, at_least ? "below" : "above",
                     t.limit);
}

}  // namespace

Threshold parse_threshold(const std::string& text, std::span<const CompareMethod> methods, bool animated) {
  const auto equals = text.find('='), colon = text.substr(0, equals).find(':');
  Threshold t;
  t.limit = number(equals == std::string::npos ? "" : text.substr(equals + 1), text);
  const std::string left = text.substr(0, equals);
  t.metric = colon == std::string::npos ? left : left.substr(colon + 1);
  std::vector<std::string> names, ids;
  for (const Metric& m : metrics()) names.emplace_back(m.name);
  for (const CompareMethod& m : methods) ids.push_back(m.id);
  check_name(t.metric, names, "metric");
  if (colon != std::string::npos) check_name(t.method = left.substr(0, colon), ids, "method");
  if (t.metric == "flicker" && !animated) throw UsageError("--threshold flicker: nothing moves, give --frames");
  return t;
}

std::vector<std::string> violations(const Comparison& comparison, std::span<const Threshold> thresholds) {
  std::vector<std::string> sentences;
  for (const Threshold& t : thresholds) {
    const auto metric =
        std::find_if(metrics().begin(), metrics().end(), [&](const Metric& m) { return t.metric == m.name; });
    for (const ComparedMethod& m : comparison.methods) {
      if (t.method.empty() ? m.id == "truth" : m.id != t.method) continue;
      const std::string sentence = violation(m, t, *metric);
      if (!sentence.empty()) sentences.push_back(sentence);
    }
  }
  return sentences;
}

}  // namespace pelage::app
