// A measure: how far a scene's settings are from an independent truth, and what they cost. One for each MeasureKind;
// the sweep (sweep.h) knows nothing else of what it measures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pelage/data_schema/knob.h"
#include "pelage/data_schema/scene.h"
#include "pelage/image/image.h"

namespace pelage::app {

struct MeasureFacts {
  std::string id, title, error_name, error_unit, time_name, truth;  // as Diagram has them
};

/// Of one point.
struct Measured {
  double error = 0, error_bar = 0;
  std::vector<std::pair<std::string, double>> others;
  std::vector<double> ms;  // of each repetition, warm
  double prepare_ms = 0;
  std::uint64_t bytes = 0;
  std::optional<Image> picture;  // exposed and over its background
};

class Measure {
 public:
  virtual ~Measure() = default;
  virtual const MeasureFacts& facts() const = 0;
  /// @param scene  the swept one with a point's settings     @throws what goes wrong; the sweep lists it
  virtual Measured measure(const Scene& scene) = 0;
  /// The verb and options that show settings alone, e.g. "render" and "-o a.png": the command of a row.
  virtual std::pair<std::string, std::string> command() const = 0;
};

struct MeasureRequest {
  Scene scene;  // with a size, lights and, where it is drawn, a camera or none
  bool quick = false;
  std::uint64_t seed = 1;
};

/// Traces or simulates the truth: takes seconds to minutes, tells its progress. @throws Interrupted
std::unique_ptr<Measure> measure_transmittance(const MeasureRequest& request);
std::unique_ptr<Measure> measure_records(const MeasureRequest& request);
std::unique_ptr<Measure> measure_picture(const MeasureRequest& request);
std::unique_ptr<Measure> measure_curve(const MeasureRequest& request);
std::unique_ptr<Measure> measure_motion(const MeasureRequest& request);
std::unique_ptr<Measure> measure_period(const MeasureRequest& request);

}  // namespace pelage::app
