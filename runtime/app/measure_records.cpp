// Records: radiance of sectors of the scene's own hairstyle, as a source of records shows it, against tracing each
// sector finely (bake/record_error.h). Errors count on plates half-way between the hairstyle's, which no bake has seen.
// The time is that of attaching the sampled tracks (features, search, choice) and of evaluating the counted sectors on
// one thread. Databases are baked for the measurement, not taken out of a cache, so that the preparation is what it
// takes.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>

#include "pelage/app/measure.h"
#include "pelage/app/prepare.h"
#include "pelage/app/stopwatch.h"
#include "pelage/bake/direct_source.h"
#include "pelage/bake/record_error.h"
#include "pelage/console/program.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/literal_key_source.h"

namespace pelage::app {
namespace {

using Clock = std::chrono::steady_clock;
using Bank = std::shared_ptr<const RecordBank>;

constexpr std::size_t kMostBytesKept = std::size_t{1} << 30;  // of banks that other points may want again

/// The model of the scene's records (widths, smoothing, Phong, c0, longest march), traced as finely as matters.
BakeSettings finest(BakeSettings settings) {
  settings.grid = std::max(settings.grid, 64);
  settings.samples = std::max(settings.samples, 64);
  settings.early_stop = 1;
  return settings;
}

class RecordsMeasure final : public Measure {
 public:
  explicit RecordsMeasure(const MeasureRequest& request)
      : style_(prepare_hairstyle(request.scene)),
        within_ms_(request.quick ? 300 : 1000),
        sample_(sample_sectors(style_, request.scene.bake, request.quick ? 1000 : 4000, request.quick ? 4 : 6,
                               Counted::between)) {
    const BakeSettings settings = finest(request.scene.bake);
    DirectSource direct(settings);
    direct.attach(sample_.sectors);
    truth_ = look(direct, sample_);
    facts_ = {"records",
              "Records: radiance of the hairstyle's sectors",
              "RMSE of radiance",
              "",
              "tracks attached and sectors evaluated",
              fmt::format("Each of {} sectors traced from {} directions with {} cells per side and {} rays: their own "
                          "strands, on plates between those that a bake has seen",
                          std::count(sample_.counted.begin(), sample_.counted.end(), 1), sample_.angle_pairs,
                          settings.grid, settings.samples)};
  }

  const MeasureFacts& facts() const override { return facts_; }

  Measured measure(const Scene& scene) override {
    Measured measured;
    const std::unique_ptr<RecordSource> source = prepare(scene, measured);
    const auto begun = Clock::now();
    std::vector<double> attach;
    while (measured.ms.size() < 3 || (measured.ms.size() < 1000 && ms_since(begun) < within_ms_)) {
      console::throw_if_interrupted();
      const auto start = Clock::now();
      source->attach(sample_.sectors);
      attach.push_back(ms_since(start));
      measured.ms.push_back(attach.back() + evaluate_ms(*source, sample_));
    }
    const RecordError error = record_error(look(*source, sample_, truth_.samples), truth_, sample_);
    std::nth_element(attach.begin(), attach.begin() + static_cast<std::ptrdiff_t>(attach.size() / 2), attach.end());
    measured.error = error.radiance_rmse;
    measured.error_bar = error.radiance_rmse_error;
    measured.others = {{"bias", error.radiance_bias},
                       {"alpha RMSE", error.alpha_rmse},
                       {"seam", error.seam},
                       {"attach ms", attach[attach.size() / 2]}};
    return measured;
  }

  std::pair<std::string, std::string> command() const override { return {"render", "-o records.png"}; }

 private:
  struct Baked {
    std::string key;
    Bank bank;
    double ms = 0;
  };

  std::unique_ptr<RecordSource> prepare(const Scene& scene, Measured& measured) {
    if (scene.satf.records == RecordsFrom::direct) {
      measured.bytes = sample_.sectors.crossings.size() * sizeof(sample_.sectors.crossings[0]);
      return std::make_unique<DirectSource>(scene.bake);
    }
    const Baked baked = baked_for(scene);
    const auto start = Clock::now();
    std::unique_ptr<RecordSource> source = record_source(scene.satf, baked.bank);
    measured.prepare_ms = baked.ms + ms_since(start);
    const auto* const literal = dynamic_cast<const LiteralKeySource*>(source.get());
    measured.bytes = literal != nullptr ? literal->bytes() : baked.bank->bytes();
    return source;
  }

  /// Kept from another point with the time that it took then, or baked now; a database file is read.
  Baked baked_for(const Scene& scene) {
    const std::string key = scene.database + "\n" + to_json(scene.bake);
    const auto same = std::find_if(kept_.begin(), kept_.end(), [&](const Baked& b) { return b.key == key; });
    if (same != kept_.end()) return *same;
    const bool generic = scene.database == kGenericDatabase;
    const auto start = Clock::now();
    Bank bank = scene.database.empty() || generic ? bake_temporary(scene.bake, generic ? nullptr : &style_)
                                                  : std::make_shared<const RecordBank>(scene.database);
    kept_.push_back({key, std::move(bank), ms_since(start)});
    while (kept_.size() > 1 && bytes_kept() > kMostBytesKept) kept_.pop_front();
    return kept_.back();
  }

  std::size_t bytes_kept() const {
    std::size_t bytes = 0;
    for (const Baked& b : kept_) bytes += b.bank->bytes();
    return bytes;
  }

  Hairstyle style_;
  double within_ms_;
  SectorSample sample_;
  SeenSectors truth_;
  MeasureFacts facts_;
  std::deque<Baked> kept_;
};

}  // namespace

std::unique_ptr<Measure> measure_records(const MeasureRequest& request) {
  return std::make_unique<RecordsMeasure>(request);
}

}  // namespace pelage::app
