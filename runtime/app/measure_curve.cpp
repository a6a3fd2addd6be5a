// How far the polyline that is drawn is from the curve through its vertices (hair/catmull_rom.h): chords of k pieces
// per segment miss it by a distance of order 1 / k^2.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "pelage/app/drawing.h"
#include "pelage/app/framing.h"
#include "pelage/app/measure.h"
#include "pelage/app/repeat.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/catmull_rom.h"

namespace pelage::app {
namespace {

/// The curve itself is looked at in so many pieces between two vertices of the polyline; smooth() makes 32 at most.
constexpr int kBetween = 4;
constexpr std::size_t kMostStrands = 1000;

double to_chord(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 way = b - a;
  const double length = glm::dot(way, way);
  const double at = length > 0 ? std::clamp(glm::dot(p - a, way) / length, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + at * way);
}

class CurveMeasure final : public Measure {
 public:
  explicit CurveMeasure(const MeasureRequest& request)
      : hair_(prepare_strands(request.scene)), head_(prepare_head(request.scene)) {
    const std::size_t count = hair_.strands.count(),
                      step = std::max<std::size_t>(1, (count + kMostStrands - 1) / kMostStrands);
    for (std::size_t s = 0; s < count; s += step) {
      // None whose vertices coincide: smooth() would leave them out.
      const auto strand = hair_.strands.strand(s);
      if (std::adjacent_find(strand.begin(), strand.end()) == strand.end()) sample_.append(strand);
    }
    if (sample_.vertices.empty()) throw InputError(request.scene.hair, "has no strands to measure");
    facts_ = {
        "curve",
        "Strands: polyline and curve",
        "RMS distance",
        "mm",
        "a frame in which the hair has moved, drawn with it",
        fmt::format("The Catmull-Rom curve through the vertices of {} of {} strands; its distance from the chords, "
                    "at {} places between two vertices of the polyline. Its error is that of float.",
                    sample_.count(), count, kBetween - 1)};
  }

  const MeasureFacts& facts() const override { return facts_; }
  std::pair<std::string, std::string> command() const override { return {"render", "-o picture.png"}; }

  Measured measure(const Scene& scene) override {
    const Strands drawn = hair::smooth(sample_, scene.strands.smoothing);
    const Strands curve = hair::smooth(sample_, scene.strands.smoothing * kBetween);
    Measured result;
    double squares = 0, most = 0;
    std::size_t places = 0;
    for (std::size_t s = 0; s < drawn.count(); ++s) {
      const auto chords = drawn.strand(s), places_of = curve.strand(s);
      for (std::size_t i = 0; i < places_of.size(); ++i) {
        const std::size_t piece = i / static_cast<std::size_t>(kBetween);
        if (i % static_cast<std::size_t>(kBetween) == 0 || piece + 1 >= chords.size()) continue;
        const double d = to_chord(places_of[i], chords[piece], chords[piece + 1]);
        squares += d * d;
        most = std::max(most, d);
        ++places;
      }
    }
    result.error = 1e3 * std::sqrt(squares / static_cast<double>(std::max<std::size_t>(places, 1)));
    result.others = {{"max", 1e3 * most}};
    const auto drawing = make_strand_drawing(scene.method, hair_, head_);
    const Camera camera = camera_of(scene, hair_.strands, head_);
    result.ms = repeated_ms(
        [&] {
          drawing->refresh();
          drawing->render(scene, camera);
        },
        {3, 9, 1000});
    for (const Stage& stage : drawing->ledger().stages()) result.bytes += stage.bytes;
    return result;
  }

 private:
  StrandHair hair_;
  Mesh head_;
  Strands sample_;
  MeasureFacts facts_;
};

}  // namespace

std::unique_ptr<Measure> measure_curve(const MeasureRequest& request) {
  return std::make_unique<CurveMeasure>(request);
}

}  // namespace pelage::app
