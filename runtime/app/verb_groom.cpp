// pelage groom: procedural hair on the parametric head, as a hair file.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/mesh_obj.h"

namespace pelage::app {
namespace {

struct Options {
  std::string style = "wavy";
  hair::GroomSettings settings;
  std::filesystem::path output, head_output;
};

void print_result(const Strands& strands, const Options& options) {
  if (console::common().json) {
    const nlohmann::json result = {{"file", options.output.string()},
                                   {"strands", strands.count()},
                                   {"vertices", strands.vertices.size()},
                                   {"style", options.style},
                                   {"seed", options.settings.seed}};
    console::print_json(result);
  } else {
    fmt::print("{}\n", options.output.string());
    if (!options.head_output.empty()) fmt::print("{}\n", options.head_output.string());
  }
}

/// @throws UsageError when both options name one file, whose hair the head would replace
void check_outputs(const Options& options) {
  hair::check_hair_output(options.output);
  check_writable(options.output);
  if (options.head_output.empty()) return;
  check_writable(options.head_output);
  if (std::filesystem::weakly_canonical(options.output) == std::filesystem::weakly_canonical(options.head_output))
    throw UsageError("-o and --head-out name the same file: give another for the head");
}

void write_head(const Options& options) {
  try {
    hair::write_obj(hair::parametric_head(options.settings.head), options.head_output);
  } catch (const OutputError& error) {
    throw OutputError(error.what(), options.output.string() + " was written, the head was not");
  }
}

void run(Options& options) {
  options.settings.style = hair::parse_groom_style(options.style);
  check_outputs(options);
  const Strands strands = hair::groom(options.settings);
  console::throw_if_interrupted();
  const hair::WriteReport written = hair::write_strands(strands, options.output);
  for (const std::string& lost : written.lost) spdlog::warn("{}: lost: {}", options.output.string(), lost);
  if (!options.head_output.empty()) write_head(options);
  spdlog::info("{} strands, {} vertices, style {}, seed {}", strands.count(), strands.vertices.size(), options.style,
               options.settings.seed);
  print_result(strands, options);
}

}  // namespace

void add_groom(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("groom", "Grow hair on a parametric head and write it as a hair file");
  const auto options = std::make_shared<Options>();
  verb->add_option("--style", options->style, "straight, wavy, curly, bob or ponytail")->capture_default_str();
  verb->add_option("--strands", options->settings.strands, "number of strands")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_option("--seed", options->settings.seed, "the same seed gives the same hair")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)))
      ->capture_default_str();
  verb->add_option("--vertices", options->settings.vertices, "per strand; 0: 32, and 64 for curls")
      ->capture_default_str();
  verb->add_option("--length-scale", options->settings.length_scale, "longer or shorter hair, 0.2 to 3")
      ->capture_default_str();
  verb->add_option("--head-height", options->settings.head.height_m, "crown to neck, metres")->capture_default_str();
  verb->add_option("-o,--output", options->output, "hair file to write: .hair, .tfx, .data, .ply, .obj or .usda")
      ->required();
  verb->add_option("--head-out", options->head_output, "also write the head, as OBJ");
  console::add_common_options(*verb);
  verb->callback([options] { run(*options); });
}

}  // namespace pelage::app
