#include "pelage/app/comparison_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <utility>

#include "pelage/app/text_files.h"

namespace pelage::app {
namespace {

using nlohmann::ordered_json;

struct Figure {
  const char* name;
  double PictureError::*value;
};
constexpr std::array<Figure, 7> kFigures{{{"rmse", &PictureError::rmse},
                                          {"bias", &PictureError::bias},
                                          {"rel_mse", &PictureError::rel_mse},
                                          {"psnr_db", &PictureError::psnr_db},
                                          {"flip", &PictureError::flip},
                                          {"max", &PictureError::max},
                                          {"rmse_covered", &PictureError::rmse_covered}}};

ordered_json json_of(const PictureError& error) {
  ordered_json json;
  for (const Figure& f : kFigures) {
    const double value = error.*f.value;
    json[f.name] = std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
  }
  return json;
}

ordered_json json_of(const std::vector<Stage>& stages) {
  ordered_json json = ordered_json::array();
  for (const Stage& s : stages)
    json.push_back({{"name", s.name}, {"ms", s.milliseconds}, {"bytes", s.bytes}, {"calls", s.calls}});
  return json;
}

ordered_json json_of(const ComparedMethod& m) {
  ordered_json json{{"id", m.id}, {"title", m.title}, {"what", m.what}, {"command", m.command}};
  if (!m.failed.empty()) {
    json["failed"] = m.failed;
    return json;
  }
  json.update({{"error", json_of(m.error)},
               {"prepare_ms", m.prepare_ms},
               {"first_ms", m.first_ms},
               {"again_ms", m.again_ms},
               {"bytes", m.bytes},
               {"stages", json_of(m.stages)},
               {"picture", m.picture},
               {"error_map", m.error_map},
               {"flip_map", m.flip_map}});
  if (m.frames.empty()) return json;
  json["flicker"] = m.flicker;
  for (const ComparedFrame& f : m.frames)
    json["frames"].push_back({{"error", json_of(f.error)}, {"flicker", f.flicker}, {"ms", f.ms}});
  return json;
}

std::string figures_csv(const PictureError& error) {
  std::string line;
  for (const Figure& f : kFigures) line += fmt::format(",{}", error.*f.value);
  return line;
}

std::string figure_names() {
  std::string line;
  for (const Figure& f : kFigures) line += std::string(",") + f.name;
  return line;
}

bool is_animated(const Comparison& c) {
  return c.fps > 0;
}

}  // namespace

ordered_json comparison_json(const Comparison& c) {
  ordered_json json{{"name", c.name},
                    {"command", c.command},
                    {"revision", c.revision},
                    {"cpu", c.cpu},
                    {"threads", c.threads},
                    {"width", c.width},
                    {"height", c.height},
                    {"error_scale", c.error_scale},
                    {"truth_samples", c.truth_samples},
                    {"truth_noise", json_of(c.truth_noise)}};
  if (is_animated(c)) json.update({{"fps", c.fps}, {"flicker_noise", c.flicker_noise}});
  for (const ComparedMethod& m : c.methods) json["methods"].push_back(json_of(m));
  json["scene"] = ordered_json::parse(c.scene);
  return json;
}

std::string comparison_csv(const Comparison& c) {
  std::string text = "id,title" + figure_names() + ",flicker,prepare_ms,first_ms,again_ms,bytes,failed\r\n";
  for (const ComparedMethod& m : c.methods) {
    text += m.id + "," + csv_field(m.title);
    if (m.failed.empty())
      text += figures_csv(m.error) + "," + (is_animated(c) ? fmt::format("{}", m.flicker) : "") +
              fmt::format(",{},{},{},{},", m.prepare_ms, m.first_ms, m.again_ms, m.bytes);
    else
      text += std::string(kFigures.size() + 6, ',') + csv_field(m.failed);
    text += "\r\n";
  }
  return text;
}

std::string comparison_frames_csv(const Comparison& c) {
  std::string text = "id,frame" + figure_names() + ",flicker,ms\r\n";
  for (const ComparedMethod& m : c.methods)
    for (std::size_t k = 0; k < m.frames.size(); ++k)
      text += fmt::format("{},{}{},{},{}\r\n", m.id, k, figures_csv(m.frames[k].error), m.frames[k].flicker,
                          m.frames[k].ms);
  return text;
}

void write_comparison(const Comparison& c, const std::filesystem::path& folder) {
  write_text(comparison_json(c).dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n",
             folder / "comparison.json");
  write_text(comparison_csv(c), folder / "comparison.csv");
  if (is_animated(c)) write_text(comparison_frames_csv(c), folder / "comparison-frames.csv");
}

}  // namespace pelage::app
