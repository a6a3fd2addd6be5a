#include "pelage/app/sweep.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>

#include "pelage/app/command_line.h"
#include "pelage/app/machine.h"
#include "pelage/app/repeat.h"
#include "pelage/app/tradeoff_files.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/db/database.h"
#include "pelage/image/image_file.h"
#include "pelage/tradeoff/combine.h"
#include "pelage/tradeoff/front.h"

namespace pelage::app {
namespace {

/// Points of several knobs together, of each base.
constexpr std::size_t kCombined = 10, kQuickCombined = 3;
/// Values of a knob that a quick sweep looks at; of choices, which have no order.
constexpr std::size_t kQuickValues = 5, kQuickChoices = 12;

using Settings = std::vector<std::string>;

/// In the order of the diagrams; names begin those of files.
struct MeasureEntry {
  MeasureKind kind;
  const char* name;
  std::unique_ptr<Measure> (*make)(const MeasureRequest&);
};
constexpr MeasureEntry kMeasures[] = {{MeasureKind::transmittance, "transmittance", measure_transmittance},
                                      {MeasureKind::records, "records", measure_records},
                                      {MeasureKind::picture, "picture", measure_picture},
                                      {MeasureKind::curve, "curve", measure_curve},
                                      {MeasureKind::motion, "motion", measure_motion},
                                      {MeasureKind::period, "period", measure_period}};

const MeasureEntry& entry_of(MeasureKind kind) {
  return *std::find_if(std::begin(kMeasures), std::end(kMeasures),
                       [&](const MeasureEntry& e) { return e.kind == kind; });
}

Settings joined(Settings first, const Settings& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// What names files: a label may hold anything.
std::string id_of(const std::string& knob, const std::string& label) {
  std::string id = knob + "-" + label;
  for (char& c : id) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
    else if (!plain)
      c = '-';
  }
  return id;
}

Times times_of(const std::vector<double>& ms) {
  if (ms.empty()) return {};
  const auto [least, most] = std::minmax_element(ms.begin(), ms.end());
  return {*least, median_of(ms), *most, static_cast<int>(ms.size())};
}

/// Evenly spread ones, both ends among them.
std::vector<KnobValue> thinned(std::vector<KnobValue> values) {
  const std::size_t most = std::isnan(values.front().amount) ? kQuickChoices : kQuickValues;
  if (values.size() <= most) return values;
  std::vector<KnobValue> few;
  for (std::size_t i = 0; i < most; ++i) few.push_back(values[i * (values.size() - 1) / (most - 1)]);
  return few;
}

struct Point {
  std::string id, knob, label;
  double amount = std::nan("");
  Settings base, settings;  // settings: on top of the base
  int threads = 0;
  std::string paper;
};

int threads_now() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

/// All points of one measure, in one diagram.
class MeasureSweep {
 public:
  MeasureSweep(const SweepRequest& request, MeasureKind kind, const Origin& origin)
      : request_(request), kind_(kind), name_(entry_of(kind).name), origin_(origin) {
    points_.push_back({"default", "default", "the program's own", std::nan(""), {}, {}, 0, {}});
    for (const Knob& knob : request.knobs) {
      if (knob.measure != kind) continue;
      diagram_.curves.push_back({knob.name, knob.what, knob.unit});
      for (const KnobValue& v : request.measure.quick ? thinned(knob.values) : knob.values)
        if (v.threads <= threads_now())
          points_.push_back(
              {id_of(knob.name, v.label), knob.name, v.label, v.amount, knob.base, v.settings, v.threads, v.paper});
    }
    add_bases();
  }

  std::size_t size() const { return points_.size() + combined_at_most(); }

  /// @param done  told after each point
  Diagram run(const std::function<void()>& done) {
    for (const Point& point : points_) {
      add(point);
      done();
    }
    if (request_.combine) combine(done);
    const MeasureFacts facts = facts_of_measure();
    diagram_.id = facts.id;
    diagram_.title = facts.title;
    diagram_.error_name = facts.error_name;
    diagram_.error_unit = facts.error_unit;
    diagram_.time_name = facts.time_name;
    diagram_.truth = facts.truth;
    mark_front(diagram_.rows);
    diagram_.slopes = fit_slopes(diagram_.curves, diagram_.rows);
    return std::move(diagram_);
  }

 private:
  std::size_t most_combined() const { return request_.measure.quick ? kQuickCombined : kCombined; }
  std::size_t combined_at_most() const { return request_.combine ? bases_.size() * most_combined() : 0; }

  /// Bases that several knobs stand on, each measured alone.
  void add_bases() {
    std::map<Settings, std::vector<std::string>> knobs;
    for (const Point& p : points_)
      if (p.knob != "default" && p.threads == 0) {
        std::vector<std::string>& on = knobs[p.base];
        if (std::find(on.begin(), on.end(), p.knob) == on.end()) on.push_back(p.knob);
      }
    for (const auto& [base, on] : knobs) {
      if (on.size() < 2) continue;
      const std::string id = "base-" + std::to_string(bases_.size() + 1);
      bases_.push_back(base);
      points_.push_back({id, "base", fmt::format("{}", fmt::join(base, " ")), std::nan(""), base, {}, 0, {}});
    }
  }

  /// Made when the first point wants it, once: where that fails, every point fails for its reason.
  Measure& measure() {
    if (cannot_) std::rethrow_exception(cannot_);
    if (measure_) return *measure_;
    try {
      measure_ = request_.make_measure(kind_, request_.measure);
    } catch (const Interrupted&) {
      throw;
    } catch (...) {
      cannot_ = std::current_exception();
      throw;
    }
    return *measure_;
  }

  MeasureFacts facts_of_measure() {
    try {
      return measure().facts();
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      return {name_, name_, "error", "", "time", std::string("None could be had: ") + error.what()};
    }
  }

  std::filesystem::path file_of(const std::string& id) const {
    return request_.folder / "points" / (name_ + "." + id + ".json");
  }

  void add(const Point& point) {
    console::throw_if_interrupted();
    TradeoffRow row = begin(point);
    const std::string what = what_is_measured(row);
    if (std::optional<TradeoffRow> known = read_back(row)) {
      row = std::move(*known);
    } else {
      measure_point(point, what, row);
      write_row(row, file_of(row.id));
      if (request_.after_point) request_.after_point();
    }
    measured_.emplace(what, diagram_.rows.size());
    diagram_.rows.push_back(std::move(row));
  }

  TradeoffRow begin(const Point& point) {
    TradeoffRow row;
    row.id = point.id;
    row.knob = point.knob;
    row.label = point.label;
    row.amount = point.amount;
    row.settings = joined(point.base, point.settings);
    row.paper = point.paper;
    row.origin = origin_;
    if (point.threads > 0) row.origin.threads = point.threads;
    return row;
  }

  /// The same point, measured by the same program on the same machine and scene.
  std::optional<TradeoffRow> read_back(const TradeoffRow& wanted) const {
    const std::filesystem::path file = file_of(wanted.id);
    if (!std::filesystem::exists(file)) return {};
    try {
      TradeoffRow row = read_row(file);
      const bool same = row.origin == wanted.origin && row.settings == wanted.settings && row.knob == wanted.knob;
      if (!same) return {};
      if (!row.picture.empty() && !std::filesystem::exists(request_.folder / row.picture)) return {};
      return row;
    } catch (const InputError& damaged) {
      spdlog::warn("{}; it is measured again", damaged.what());
      return {};
    }
  }

  /// The same for points whose scenes and threads are.
  std::string what_is_measured(const TradeoffRow& row) const {
    try {
      const Scene scene = with_values(request_.measure.scene, row.settings);
      return to_json(scene) + "@" + std::to_string(row.origin.threads);
    } catch (const UsageError&) {
      return row.id;  // no scene has these settings: measure_point() says why
    }
  }

  void measure_point(const Point& point, const std::string& what, TradeoffRow& row) {
    try {
      const Scene scene = with_values(request_.measure.scene, row.settings);
      if (const auto twin = measured_.find(what); twin != measured_.end()) {
        copy_figures(diagram_.rows.at(twin->second), row);
      } else {
        std::optional<tbb::global_control> threads;
        if (point.threads > 0)
          threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(point.threads));
        Measured m = measure().measure(scene);
        threads.reset();
        fill(std::move(m), row);
      }
      row.command = command_of(row);
    } catch (const Interrupted&) {
      throw;
    } catch (const OutputError&) {
      throw;
    } catch (const std::exception& error) {
      row.failed = error.what();
      spdlog::warn("{}: {}", row.id, error.what());
    }
  }

  static void copy_figures(const TradeoffRow& from, TradeoffRow& to) {
    to.failed = from.failed;
    to.error = from.error;
    to.error_bar = from.error_bar;
    to.others = from.others;
    to.time = from.time;
    to.prepare_ms = from.prepare_ms;
    to.bytes = from.bytes;
    to.picture = from.picture;
  }

  void fill(Measured m, TradeoffRow& row) const {
    if (!std::isfinite(m.error)) throw InputError(row.id, "its error is not finite");
    row.error = m.error;
    row.error_bar = m.error_bar;
    row.others = std::move(m.others);
    row.time = times_of(m.ms);
    row.prepare_ms = m.prepare_ms;
    row.bytes = m.bytes;
    if (!m.picture) return;
    row.picture = "points/" + name_ + "." + row.id + ".png";
    write_image(*m.picture, request_.folder / row.picture, {{"Software", "pelage"}});
  }

  std::string command_of(const TradeoffRow& row) {
    const auto [verb, tail] = measure().command();
    std::string line = "pelage " + verb + " " + request_.row_words;
    for (const std::string& setting : row.settings) line += " --set " + shell_word(setting);
    if (row.origin.threads != origin_.threads) line += fmt::format(" -j {}", row.origin.threads);
    return line + (tail.empty() ? "" : " " + tail);
  }

  const TradeoffRow* row_of(const std::string& id) const {
    for (const TradeoffRow& row : diagram_.rows)
      if (row.id == id) return &row;
    return nullptr;
  }

  void combine(const std::function<void()>& done) {
    for (std::size_t b = 0; b < bases_.size(); ++b) {
      const TradeoffRow* const base = row_of("base-" + std::to_string(b + 1));
      std::vector<Settings> worth;
      if (base->failed.empty()) {
        std::vector<SinglePoint> singles;
        for (const Point& p : points_) {
          const TradeoffRow& row = *row_of(p.id);
          if (p.base == bases_[b] && !p.settings.empty() && p.threads == 0 && row.failed.empty())
            singles.push_back({p.knob, p.settings, row.error, row.time.median_ms});
        }
        worth = worth_combining({"", {}, base->error, base->time.median_ms}, singles, diagram_.rows, most_combined());
      }
      for (std::size_t i = 0; i < most_combined(); ++i) {
        if (i < worth.size())
          add({fmt::format("combined-{}-{}", b + 1, i + 1),
               "combined",
               fmt::format("{}", fmt::join(worth[i], " ")),
               std::nan(""),
               bases_[b],
               worth[i],
               0,
               {}});
        done();
      }
    }
  }

  const SweepRequest& request_;
  MeasureKind kind_;
  std::string name_;  // of the measure
  Origin origin_;
  std::vector<Point> points_;
  std::vector<Settings> bases_;
  std::unique_ptr<Measure> measure_;
  std::exception_ptr cannot_;                    // why there is none
  std::map<std::string, std::size_t> measured_;  // scene and threads -> row
  Diagram diagram_;
};

}  // namespace

Tradeoff sweep(const SweepRequest& request) {
  Tradeoff result;
  result.name = request.name;
  result.command = request.command;
  result.scene = to_json(request.measure.scene);
  result.quick = request.measure.quick;
  result.origin = {scene_hash(request.measure.scene, request.measure.quick), request.measure.seed, program_revision(),
                   cpu_name(), threads_now()};
  std::vector<MeasureSweep> sweeps;
  std::uint64_t total = 0, done = 0;
  for (const auto& [kind, name, make] : kMeasures) {
    const bool any = std::any_of(request.knobs.begin(), request.knobs.end(),
                                 [kind = kind](const Knob& k) { return k.measure == kind; });
    if (!any) continue;
    total += sweeps.emplace_back(request, kind, result.origin).size();
  }
  if (total == 0) return result;
  console::Progress progress("measuring", total, "points");
  for (MeasureSweep& each : sweeps) result.diagrams.push_back(each.run([&] { progress.update(++done); }));
  return result;
}

std::unique_ptr<Measure> make_measure(MeasureKind kind, const MeasureRequest& request) {
  return entry_of(kind).make(request);
}

}  // namespace pelage::app
