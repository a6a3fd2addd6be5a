// pelage info: what a hair file, its bone weights, a hairstyle or a database holds, and what looks implausible about
// it.
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pelage/app/info_database.h"
#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/hair/facts.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/tfx_bone.h"

namespace pelage::app {
namespace {

struct Options {
  std::filesystem::path input, against, picture;
  std::string unit = "m", up = "y", curve = "polyline";
};

bool is_database(const std::filesystem::path& file) {
  std::string magic(15, '\0');
  std::ifstream in(file, std::ios::binary);
  return in.read(magic.data(), static_cast<std::streamsize>(magic.size())) && magic == "SQLite format 3";
}

void info_of_hair(const Options& options) {
  hair::ReadOptions read;
  read.metres_per_unit = hair::parse_unit(options.unit);
  read.up = hair::parse_up_axis(options.up);
  read.curve = hair::parse_curve(options.curve);
  read.check_unit = false;  // an implausible unit is one of the things to show
  hair::ReadReport report;
  const Strands strands = hair::read_hair(options.input, read, &report);
  const hair::HairFacts facts = hair::hair_facts(strands, report, report.metres_per_unit);
  fmt::print("{}", console::common().json ? hair::to_json(facts) + "\n" : hair::to_text(facts));
}

struct StyleFacts {
  std::size_t clusters, strands, instances, points, least = 0, most = 0;
  float shortest_m = 0, longest_m = 0;
};

StyleFacts facts_of(const Hairstyle& style) {
  StyleFacts f{style.clusters.size(), style.strand_count(), 0, 0};
  std::vector<std::size_t> counts;
  std::vector<float> lengths_m;
  for (const Cluster& cluster : style.clusters) {
    f.instances += std::max<std::size_t>(cluster.transforms.size(), 1);
    f.points += cluster.strand_points.size();
    counts.push_back(cluster.strand_count());
    lengths_m.push_back(sweep(cluster, style.division.plates).length_m);
  }
  if (counts.empty()) return f;
  f.least = *std::min_element(counts.begin(), counts.end());
  f.most = *std::max_element(counts.begin(), counts.end());
  f.shortest_m = *std::min_element(lengths_m.begin(), lengths_m.end());
  f.longest_m = *std::max_element(lengths_m.begin(), lengths_m.end());
  return f;
}

void info_of_hairstyle(const std::filesystem::path& file) {
  const Hairstyle style = load_hairstyle(file);
  const StyleFacts f = facts_of(style);
  const Division& d = style.division;
  if (console::common().json) {
    const nlohmann::json json = {{"format", "hairstyle"},
                                 {"name", style.name},
                                 {"source", style.source},
                                 {"clusters", f.clusters},
                                 {"instances", f.instances},
                                 {"strands", f.strands},
                                 {"strands_per_cluster", {{"min", f.least}, {"max", f.most}}},
                                 {"strand_points", f.points},
                                 {"cluster_length_m", {{"min", f.shortest_m}, {"max", f.longest_m}}},
                                 {"division", {{"layers", d.layers}, {"sectors", d.sectors}, {"plates", d.plates}}},
                                 {"diameter_m", style.diameter_m},
                                 {"opacity", style.opacity}};
    console::print_json(json);
    return;
  }
  fmt::print("format              hairstyle \"{}\"{}\n", style.name,
             style.source.empty() ? "" : ", from " + style.source);
  fmt::print("clusters            {}, {} instances, {:.1f} to {:.1f} mm long\n", f.clusters, f.instances,
             1e3 * static_cast<double>(f.shortest_m), 1e3 * static_cast<double>(f.longest_m));
  fmt::print("strands             {} of {} points, {} to {} per cluster\n", f.strands, f.points, f.least, f.most);
  fmt::print("division            {} layers, {} sectors, {} plates\n", d.layers, d.sectors, d.plates);
  fmt::print("diameter, opacity   {:.4g} um, {:.3g}\n", 1e6 * static_cast<double>(style.diameter_m), style.opacity);
}

void info_of_bones(const std::filesystem::path& file) {
  const hair::TfxBones bones = hair::read_tfxbone(file);
  if (console::common().json) {
    const nlohmann::json json = {{"format", "TFX bones"},
                                 {"bones", bones.names},
                                 {"strands", bones.strands.size()},
                                 {"weight_sum_farthest_from_1", bones.farthest_sum},
                                 {"repaired", bones.repaired}};
    console::print_json(json);
    return;
  }
  fmt::print("format              TFX bones: the weights of the .tfx file beside it\n");
  fmt::print("bones               {}\n", bones.names.size());
  fmt::print("strands             {}, {} without a usable weight\n", bones.strands.size(), bones.repaired.size());
  fmt::print("weights             scaled to a sum of 1; the sum farthest from it is {:.4g}\n", bones.farthest_sum);
}

/// Options that say how hair is to be read have no say over anything else.
void refuse_hair_options(const CLI::App& verb, const Options& options) {
  for (const char* const option : {"--unit", "--up", "--curve"}) {
    if (verb.count(option) == 0) continue;
    throw UsageError(std::string(option) + " is for hair files, which " + options.input.string() + " is not");
  }
}

void run(const CLI::App& verb, const Options& options) {
  const bool database = is_database(options.input), style = options.input.extension() == ".json",
             bones = options.input.extension() == ".tfxbone";
  if (database || style || bones) refuse_hair_options(verb, options);
  if (database) return info_of_database(options.input, options.against, options.picture);
  if (!options.picture.empty() || !options.against.empty()) {
    throw UsageError(options.input.string() + " is no database: -o and --against belong to one");
  }
  if (style) return info_of_hairstyle(options.input);
  if (bones) return info_of_bones(options.input);
  info_of_hair(options);
}

}  // namespace

void add_info(CLI::App& app) {
  console::Verb* const verb = console::add_verb(
      app, "info", "Show what a hair file, a hairstyle or a database holds, and what looks implausible");
  const auto options = std::make_shared<Options>();
  verb->add_input("file", options->input,
                  "hair file (.hair, .tfx, .data, .ply, .obj, .usda), bone weights (.tfxbone), a hairstyle (.json), "
                  "or a database (.hrir)")
      ->required();
  verb->add_option("--unit", options->unit, "of the hair file: m, cm, mm, in, or metres per unit")
      ->capture_default_str();
  verb->add_option("--up", options->up, "axis of the hair file that points up: x, y or z")->capture_default_str();
  verb->add_option("--curve", options->curve, "what its vertices are: polyline or bspline")->capture_default_str();
  verb->add_input("--against", options->against, "of a database: hairstyle (.json) whose sectors should be covered");
  verb->add_output("-o,--output", options->picture, "of a database: draw records and coverage to this PNG or EXR file");
  console::add_common_options(*verb);
  verb->runs([verb, options] { run(*verb, *options); });
}

}  // namespace pelage::app
