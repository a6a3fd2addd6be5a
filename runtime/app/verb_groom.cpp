// pelage groom: procedural hair on the parametric head, or grown on a given head mesh, as a hair file.
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/grow.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/mesh_obj.h"
#include "pelage/hair/mesh_roots.h"
#include "pelage/simulate/mesh_distance.h"

namespace pelage::app {
namespace {

constexpr float kFieldCell_m = 0.005F;  // on a head of 0.24 m

struct Options {
  std::string style = "wavy";
  hair::GroomSettings settings;
  std::filesystem::path output, head_output;

  std::filesystem::path on;  // a head mesh; the rest belongs to it
  hair::GrowSettings grow;
  std::string unit = "m", up = "y", face = "+z";
};

/// @throws UsageError for options of the one kind of groom with the other
void check_kind(const CLI::App& verb, const Options& options) {
  const bool on_mesh = !options.on.empty();
  if (on_mesh && verb.count("--style") > 0 && options.style != "grown")
    throw UsageError("--style " + options.style +
                     " grows on the parametric head: leave out --on, or give --style grown");
  if (!on_mesh && options.style == "grown") throw UsageError("--style grown: give the head mesh with --on");
  for (const char* option : {"--length-scale", "--head-out"})
    if (on_mesh && verb.count(option) > 0)
      throw UsageError(std::string(option) + " is of the parametric head: leave it out with --on" +
                       (std::string(option) == "--length-scale" ? ", or give --length-m" : ""));
  for (const char* option : {"--length-m", "--unit", "--up", "--face"})
    if (!on_mesh && verb.count(option) > 0)
      throw UsageError(std::string(option) + " is of a given head mesh: give that with --on");
}

Strands grown(const Options& options) {
  hair::ReadOptions read;
  read.metres_per_unit = hair::parse_unit(options.unit);
  read.up = hair::parse_up_axis(options.up);
  const glm::vec3 face = hair::parse_face(options.face);
  const Mesh head = hair::read_obj(options.on, read);
  const float height_m = options.settings.head.height_m;
  const hair::Skull skull = hair::find_skull(head, height_m, face);
  console::throw_if_interrupted();
  const MeshDistance field(head, height_m / 0.24F * kFieldCell_m);
  if (field.empty()) throw InputError(options.on.string(), "no triangle of it has an area: export it again");
  const hair::DistanceField distance = [&](glm::vec3 p) {
    const SurfaceSample s = field.sample(p);
    return hair::HeadField::Sample{s.distance_m, s.normal};
  };
  const auto roots = hair::mesh_roots(head, skull, distance, options.settings.strands, options.settings.seed);
  console::throw_if_interrupted();
  hair::GrowSettings grow = options.grow;
  grow.seed = options.settings.seed;
  if (options.settings.vertices != 0) grow.vertices = options.settings.vertices;
  return hair::grow(roots, skull, distance, grow);
}

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

void check_outputs(const Options& options) {
  hair::check_hair_output(options.output);
  check_writable(options.output);
  if (!options.head_output.empty()) check_writable(options.head_output);
}

void write_head(const Options& options) {
  try {
    hair::write_obj(hair::parametric_head(options.settings.head), options.head_output);
  } catch (const OutputError& error) {
    throw OutputError(error.what(), options.output.string() + " was written, the head was not");
  }
}

Strands parametric(Options& options) {
  options.settings.style = hair::parse_groom_style(options.style);
  return hair::groom(options.settings);
}

void run(const CLI::App& verb, Options& options) {
  check_kind(verb, options);
  if (!options.on.empty()) options.style = "grown";
  check_outputs(options);
  const Strands strands = options.on.empty() ? parametric(options) : grown(options);
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
  console::Verb* const verb =
      console::add_verb(app, "groom", "Grow hair on a parametric head, or on a given one, and write it as a hair file");
  const auto options = std::make_shared<Options>();
  verb->add_option("--style", options->style, "straight, wavy, curly, bob or ponytail; with --on: grown")
      ->capture_default_str();
  verb->add_option("--strands", options->settings.strands, "number of strands")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_option("--seed", options->settings.seed, "the same seed gives the same hair")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)))
      ->capture_default_str();
  verb->add_option("--vertices", options->settings.vertices, "per strand; 0: 32, 64 for curls, 16 with --on")
      ->capture_default_str();
  verb->add_option("--length-scale", options->settings.length_scale, "longer or shorter hair, 0.2 to 3")
      ->check(console::finite())
      ->capture_default_str();
  verb->add_option("--head-height", options->settings.head.height_m, "crown to the middle of the neck, metres")
      ->check(console::finite())
      ->capture_default_str();
  verb->add_output("-o,--output", options->output, "hair file to write: .hair, .tfx, .data, .ply, .obj or .usda")
      ->required();
  verb->add_output("--head-out", options->head_output, "also write the head, as OBJ");
  verb->add_input("--on", options->on,
                  "grow on this head mesh instead (OBJ): strands that gravity bends, for the simulation");
  verb->add_option("--length-m", options->grow.length_m, "with --on: length of the strands")
      ->check(console::finite())
      ->capture_default_str();
  verb->add_option("--unit", options->unit, "with --on: m, cm, mm, in, or metres per unit")->capture_default_str();
  verb->add_option("--up", options->up, "with --on: axis of the mesh that points up: x, y or z")->capture_default_str();
  verb->add_option("--face", options->face, "with --on: where the face looks once Y is up: +z, -z, +x or -x")
      ->capture_default_str();
  console::add_common_options(*verb);
  verb->runs([verb, options] { run(*verb, *options); });
}

}  // namespace pelage::app
