// Shadows strand by strand: T at vertices drawn at random against the ray-traced T* there (shadow_error.h). The time is
// that of a map built anew and read at all vertices. The first light only. Scenes of the methods satf and truth, which
// shadow otherwise, are measured with the density map that strand drawing has by default.
#include <fmt/format.h>

#include "pelage/app/measure.h"
#include "pelage/app/prepare.h"
#include "pelage/app/shadow_error.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"

namespace pelage::app {
namespace {

class TransmittanceMeasure final : public Measure {
 public:
  explicit TransmittanceMeasure(const MeasureRequest& request)
      : hair_(prepare_strands(request.scene)), repeats_{3, 1000, request.quick ? 300.0 : 1000.0} {
    if (hair_.strands.vertices.empty()) throw InputError(request.scene.hair, "has no strands to measure");
    light_of(request.scene);
    trace(request);
    const TruthSettings settings = truth_settings(request);
    facts_ = {"transmittance",
              "Shadows: transmittance at vertices",
              "RMSE of T",
              "",
              "map built and read at all vertices",
              fmt::format("T* at {} vertices of {}, drawn at random: {} rays each, spread over {:.2g} mm. Mean {:.3f}, "
                          "standard deviation {:.3f}; its own standard error is {:.4f} (RMS over the vertices)",
                          truth_.points.size(), hair_.strands.vertices.size(), settings.rays,
                          1e3 * static_cast<double>(settings.footprint_m), truth_.mean, truth_.deviation,
                          truth_.standard_error)};
  }

  const MeasureFacts& facts() const override { return facts_; }

  Measured measure(const Scene& scene) override {
    const bool otherwise = scene.method == Method::satf || scene.method == Method::truth;
    const ShadowRow row{"", "", otherwise ? Method::density_map : scene.method, scene.shadow};
    ShadowResult result = measure_shadow(row, hair_.strands, hair_.opacity, light_of(scene), truth_, repeats_);
    Measured measured;
    measured.error = result.error.rmse;
    measured.error_bar = result.error.rmse_error;
    measured.others = {{"bias", result.error.bias},
                       {"p99", result.error.p99},
                       {"max", result.error.max},
                       {"build ms", result.build_ms},
                       {"read ms", result.filter_ms}};
    measured.ms = std::move(result.sum_ms);
    measured.bytes = result.bytes;
    return measured;
  }

  std::pair<std::string, std::string> command() const override { return {"render", "-o shadows.png"}; }

 private:
  static const Light& light_of(const Scene& scene) {
    if (scene.lights.empty()) throw UsageError("the scene has no light: there is no shadow to measure");
    return scene.lights.front();
  }

  static TruthSettings truth_settings(const MeasureRequest& request) {
    TruthSettings settings = request.scene.truth;
    settings.rays = request.quick ? 2048 : 8192;
    return settings;
  }

  void trace(const MeasureRequest& request) {
    const std::size_t points = request.quick ? 400 : 1000;
    console::Progress progress("tracing shadows of " + hair_.name, points, "points");
    truth_ = shadow_truth(hair_.strands, hair_.opacity, light_of(request.scene), truth_settings(request), points,
                          request.seed, [&](std::uint64_t done, std::uint64_t) {
                            console::throw_if_interrupted();
                            progress.update(done);
                          });
  }

  StrandHair hair_;
  Repeats repeats_;
  ShadowTruth truth_;
  MeasureFacts facts_;
};

}  // namespace

std::unique_ptr<Measure> measure_transmittance(const MeasureRequest& request) {
  return std::make_unique<TransmittanceMeasure>(request);
}

}  // namespace pelage::app
