// `pelage cluster IN -o style.json`: fits clusters to a hair file and says how well they hold it.
#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/cluster_fit.h"
#include "pelage/hair/hair_file.h"

namespace pelage::app {
namespace {

struct Options {
  std::string input, output;
  std::string unit = "m", up = "y", curve = "polyline";
  hair::FitSettings fit;
  Division division;
  double diameter_um = 0;  // 0: the file's, or the default
  float opacity = 0;       // 0: the file's, or the default
};

void add_options(console::Verb& verb, Options& o) {
  verb.add_input("input", o.input, "hair file (HAIR, TFX 4)")->required();
  verb.add_output("-o,--output", o.output, "hairstyle file to write (JSON)")->required();
  verb.add_option("--clusters", o.fit.clusters, "clusters to fit, at most")->check(CLI::Range(1, 10000));
  verb.add_option("--coverage", o.fit.coverage, "share of the strands' length that lies inside the envelopes")
      ->check(console::finite(0.5, 1));
  verb.add_option("--seed", o.fit.seed, "of the clustering")
      ->check(console::finite(0, static_cast<double>(kLargestSeed)));
  verb.add_option("--layers", o.division.layers, "layers of a cluster")->check(CLI::Range(1, 32));
  verb.add_option("--sectors", o.division.sectors, "sectors around the outermost layer")->check(CLI::Range(3, 256));
  verb.add_option("--plates", o.division.plates, "sections along a cluster")->check(CLI::Range(2, 512));
  verb.add_option("--unit", o.unit, "of the file: m, cm, mm, in, or metres per unit");
  verb.add_option("--up", o.up, "axis of the file that points up: x, y, z");
  verb.add_option("--curve", o.curve, "what the file's points are: polyline, bspline");
  verb.add_option("--diameter-um", o.diameter_um, "drawn diameter of a strand; 0: the file's, else by their number")
      ->check(console::finite(0, 1e5));
  verb.add_option("--opacity", o.opacity, "of a strand; 0: the file's, else 0.6")->check(console::finite(0, 1));
}

Strands read(const Options& o, hair::ReadReport& report) {
  hair::ReadOptions options;
  options.metres_per_unit = hair::parse_unit(o.unit);
  options.up = hair::parse_up_axis(o.up);
  options.curve = hair::parse_curve(o.curve);
  return hair::read_hair(o.input, options, &report);
}

std::vector<double> sorted(const hair::FitReport& report, double (*value)(const hair::ClusterReport&)) {
  std::vector<double> values;
  for (const hair::ClusterReport& c : report.clusters) values.push_back(value(c));
  std::sort(values.begin(), values.end());
  return values;
}

std::string spread(const std::vector<double>& v) {
  return fmt::format("{:.4g} ({:.4g} ... {:.4g})", v[v.size() / 2], v.front(), v.back());
}

void print_text(const hair::FitReport& r, const Hairstyle& style, std::ostream& out) {
  const auto strands = sorted(r, [](const hair::ClusterReport& c) { return static_cast<double>(c.strands); });
  const auto radii = sorted(r, [](const hair::ClusterReport& c) { return 1e3 * static_cast<double>(c.radius_m); });
  const auto lengths = sorted(r, [](const hair::ClusterReport& c) { return 1e3 * static_cast<double>(c.length_m); });
  out << fmt::format("clusters            {}\n", r.clusters.size())
      << fmt::format("strands             {} in clusters, {} dropped, {} reassigned\n", r.strands, r.dropped,
                     r.reassigned)
      << fmt::format("inside envelopes    {:.1f} % of strand length\n", 100 * r.inside)
      << fmt::format("reconstruction      {:.3f} mm RMS\n", 1e3 * r.rms_m)
      << fmt::format("cut, turning back   {} of {} vertices\n", r.cut_points, r.points)
      << fmt::format("overlapping plates  {} of {}\n", r.overlapping_plates, r.plates)
      << fmt::format("per cluster         median (least ... most)\n")
      << fmt::format("  strands           {}\n", spread(strands))
      << fmt::format("  radius [mm]       {}\n", spread(radii))
      << fmt::format("  length [mm]       {}\n", spread(lengths))
      << fmt::format("strand              {:.0f} um, opacity {:.2f}\n", 1e6 * static_cast<double>(style.diameter_m),
                     static_cast<double>(style.opacity));
}

nlohmann::ordered_json to_json(const hair::FitReport& r, const Hairstyle& style) {
  nlohmann::ordered_json clusters = nlohmann::ordered_json::array();
  for (const hair::ClusterReport& c : r.clusters) {
    clusters.push_back({{"strands", c.strands},
                        {"radius_m", c.radius_m},
                        {"length_m", c.length_m},
                        {"inside", c.inside},
                        {"rms_m", c.rms_m},
                        {"vertices", c.points},
                        {"cut_vertices", c.cut_points},
                        {"overlapping_plates", c.overlapping_plates}});
  }
  return {{"strands", r.strands},
          {"dropped", r.dropped},
          {"reassigned", r.reassigned},
          {"inside", r.inside},
          {"rms_m", r.rms_m},
          {"vertices", r.points},
          {"cut_vertices", r.cut_points},
          {"overlapping_plates", r.overlapping_plates},
          {"plates", r.plates},
          {"diameter_m", style.diameter_m},
          {"opacity", style.opacity},
          {"clusters", clusters}};
}

void run(Options o) {
  check_writable(o.output);
  hair::ReadReport file;
  const Strands strands = read(o, file);
  for (const std::string& note : file.notes) spdlog::warn("{}: {}", o.input, note);
  if (!file.issues.empty()) {
    spdlog::warn("{}: {} strands dropped, {} repaired, the first is strand {}: {}", o.input, file.dropped(),
                 file.repaired(), file.issues.front().strand, file.issues.front().reason);
  }
  Hairstyle style;
  style.source = std::filesystem::path(o.input).filename().string();
  style.name = std::filesystem::path(o.input).stem().string();
  style.division = o.division;
  style.diameter_m = o.diameter_um > 0 ? static_cast<float>(1e-6 * o.diameter_um) : hair::drawn_diameter_m(strands);
  style.opacity = o.opacity > 0 ? o.opacity : file.opacity.value_or(kDefaultOpacity);
  spdlog::info("strands are {:.0f} um wide, opacity {:.2f}", 1e6 * static_cast<double>(style.diameter_m),
               static_cast<double>(style.opacity));
  o.fit.diameter_m = style.diameter_m;
  hair::ClusterFit fit = hair::fit_clusters(strands, o.fit);
  console::throw_if_interrupted();
  style.clusters = std::move(fit.clusters);
  save_hairstyle(style, o.output);
  if (console::common().json) {
    console::print_json(to_json(fit.report, style));
  } else {
    print_text(fit.report, style, std::cout);
  }
}

}  // namespace

void add_cluster(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "cluster", "Fit clusters to a hair file and write them as a hairstyle");
  const auto options = std::make_shared<Options>();
  add_options(*verb, *options);
  verb->runs([options] { run(*options); });
  console::add_common_options(*verb);
}

}  // namespace pelage::app
