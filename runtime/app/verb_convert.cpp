// pelage convert: a hair file of one format as a file of another.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "pelage/app/verbs.h"
#include "pelage/console/json_output.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/resample.h"

namespace pelage::app {
namespace {

constexpr std::size_t kNamed = 10;  // strands that are named on the terminal; --json names more

struct Options {
  std::filesystem::path input, output;
  std::string unit = "m", up = "y", curve = "polyline";
  int resample = 0;
  bool in_place = false;
};

void print_json(const Options& options, const hair::ReadReport& read, const hair::WriteReport& written,
                const Strands& strands) {
  nlohmann::json issues = nlohmann::json::array();
  for (const hair::StrandIssue& s : read.issues)
    issues.push_back({{"strand", s.strand}, {"dropped", s.dropped}, {"reason", s.reason}});
  const nlohmann::json json = {
      {"input", options.input.string()},
      {"input_format", read.format},
      {"output", options.output.string()},
      {"output_format", written.format},
      {"strands_in_file", read.strands_in_file},
      {"strands", strands.count()},
      {"vertices", strands.vertices.size()},
      {"dropped", read.dropped()},
      {"repaired", read.repaired()},
      {"issues", issues},
      {"notes", read.notes},
      {"output_notes", written.notes},
      {"lost", written.lost},
  };
  console::print_json(json);
}

void print_text(const Options& options, const hair::ReadReport& read, const hair::WriteReport& written,
                const Strands& strands) {
  fmt::print("{}: {} -> {}: {}\n", options.input.string(), read.format, options.output.string(), written.format);
  fmt::print("{} of {} strands, {} vertices", strands.count(), read.strands_in_file, strands.vertices.size());
  const std::size_t issues = read.dropped() + read.repaired();
  fmt::print("; {} dropped, {} repaired\n", read.dropped(), read.repaired());
  for (std::size_t k = 0; k < std::min(read.issues.size(), kNamed); ++k) {
    const hair::StrandIssue& issue = read.issues[k];
    fmt::print("  strand {} {}: {}\n", issue.strand, issue.dropped ? "dropped" : "repaired", issue.reason);
  }
  if (issues > kNamed) fmt::print("  and {} more: --json names the first {}\n", issues - kNamed, hair::kMaxIssues);
  for (const std::string& note : read.notes) fmt::print("note: {}\n", note);
  for (const std::string& note : written.notes) fmt::print("note: {}\n", note);
  for (const std::string& lost : written.lost) fmt::print("lost: {}\n", lost);
}

void run(Options options) {
  hair::ReadOptions read;
  read.metres_per_unit = hair::parse_unit(options.unit);
  read.up = hair::parse_up_axis(options.up);
  read.curve = hair::parse_curve(options.curve);
  if (options.in_place) options.output = options.input;
  if (options.output.empty())
    throw UsageError("output is required: name a file, or write over the input by --in-place");
  hair::check_hair_output(options.output);
  check_writable(options.output);

  hair::ReadReport report;
  Strands strands = hair::read_hair(options.input, read, &report);
  console::throw_if_interrupted();
  if (options.resample != 0) strands = hair::resample(strands, options.resample);
  console::throw_if_interrupted();
  const hair::WriteReport written = hair::write_strands(strands, options.output, report.opacity);
  (console::common().json ? print_json : print_text)(options, report, written, strands);
}

}  // namespace

void add_convert(CLI::App& app) {
  console::Verb* const verb = console::add_verb(app, "convert", "Write a hair file in another format, metres and Y up");
  const auto options = std::make_shared<Options>();
  verb->add_input("input", options->input, "hair file: .hair, .tfx, .data, .ply, .obj (polylines), .usda")->required();
  CLI::Option* const output =
      verb->add_output("output", options->output, "file to write; the extension says the format",
                       {{}, "name another file, or write over the input by --in-place"});
  verb->add_flag("--in-place", options->in_place,
                 "write over the input, once all of it is read and made anew; other hard links of it stay as they were")
      ->excludes(output);
  verb->add_option("--unit", options->unit, "of the input: m, cm, mm, in, or metres per unit (.usda says its own)")
      ->capture_default_str();
  verb->add_option("--up", options->up, "axis of the input that points up: x, y or z (.usda says its own)")
      ->capture_default_str();
  verb->add_option("--curve", options->curve, "what its vertices are: polyline or bspline (.usda says it)")
      ->capture_default_str();
  verb->add_option("--resample", options->resample, "vertices per strand, evenly spaced; 0: as they are")
      ->check(CLI::Range(0, 65536))
      ->capture_default_str();
  console::add_common_options(*verb);
  verb->runs([options] { run(*options); });
}

}  // namespace pelage::app
