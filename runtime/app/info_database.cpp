#include "pelage/app/info_database.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pelage/app/database_picture.h"
#include "pelage/console/json_output.h"
#include "pelage/console/program.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/db/database_source.h"
#include "pelage/image/image_file.h"

namespace pelage::app {
namespace {

void compare_with(const std::filesystem::path& hairstyle, const RecordBank& bank, CoverageShown& c) {
  const Hairstyle style = load_hairstyle(hairstyle);
  const SectorSet sectors = sectors_of(style.clusters, style.division);
  c.hairstyle = hairstyle.filename().string();
  c.sector_features = used_sector_features(bank, sectors);
  c.sector_distances = distances_to_records(bank, c.sector_features);
}

nlohmann::json json_of(const std::vector<float>& distances) {
  return {{"median", quantile(distances, 0.5)}, {"p95", quantile(distances, 0.95)}, {"max", quantile(distances, 1)}};
}

void print(const std::filesystem::path& database, const RecordBank& bank, const CoverageShown& c,
           const std::filesystem::path& picture) {
  const DatabaseMetadata& m = bank.metadata();
  const auto thin = thinnest(c.spacing, 8);
  if (console::common().json) {
    nlohmann::ordered_json json = {
        {"format", "database"},         {"records", bank.size()},        {"source", m.source},
        {"source_name", m.source_name}, {"spacing", json_of(c.spacing)}, {"thinnest", thin}};
    if (!c.hairstyle.empty()) {
      json["against"] = {{"hairstyle", c.hairstyle},
                         {"distances", json_of(c.sector_distances)},
                         {"uncovered_share", uncovered_share(c.spacing, c.sector_distances)}};
    }
    if (!picture.empty()) json["picture"] = picture.string();
    console::print_json(json);
    return;
  }
  const auto line = [](const std::string& of, const std::vector<float>& d) {
    fmt::print("{:20}{:.3f} median, {:.3f} for 95 %, {:.3f} at most, standard deviations per feature\n", of,
               quantile(d, 0.5), quantile(d, 0.95), quantile(d, 1));
  };
  fmt::print("format              HRIR database, {} records{}\n", bank.size(),
             m.source == "random" ? " of random sectors" : " of hairstyle '" + m.source_name + "'");
  line("record to record", c.spacing);
  fmt::print("thinnest places     records {}\n", fmt::join(thin, ", "));
  if (!c.hairstyle.empty()) {
    line("sector to record", c.sector_distances);
    fmt::print(
        "uncovered           {:.1f} % of the {} sectors of {}: farther from any record than 95 % of the records\n",
        100 * uncovered_share(c.spacing, c.sector_distances), c.sector_distances.size(), c.hairstyle);
  }
  fmt::print("{}\n", picture.empty() ? "picture             -o FILE.png draws records and coverage" : picture.string());
  fmt::print("more                pelage-bake info {} says how it was baked\n", database.string());
}

}  // namespace

void info_of_database(const std::filesystem::path& database, const std::filesystem::path& against,
                      const std::filesystem::path& picture) {
  if (!picture.empty()) check_writable(picture);
  const RecordBank bank(database);
  CoverageShown c;
  c.spacing = record_spacing(bank);
  if (!against.empty()) compare_with(against, bank, c);
  console::throw_if_interrupted();
  if (!picture.empty()) {
    write_image(draw_database(bank, database.filename().string(), c), picture,
                {{"Description", "Records and feature coverage of " + database.filename().string()}});
  }
  print(database, bank, c, picture);
}

}  // namespace pelage::app
