// pelage info of a database: words, JSON, picture; and what diagrams are drawn with.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "../db/fixtures.h"
#include "child.h"
#include "pelage/bake/bake_pipeline.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/image/draw.h"
#include "pelage/image/image_file.h"

namespace pelage {
namespace {

using ::testing::HasSubstr;

constexpr int kOutlier = 17;

/// Records of one strand near the middle, and one of many in a corner.
void write_database_with_outlier(const std::filesystem::path& file, FeatureSet features) {
  BakeSettings settings = fixtures::small_settings();
  settings.sectors = 30;
  settings.features = features;
  std::vector<StoredSector> sectors;
  for (int i = 0; i < settings.sectors; ++i) {
    std::vector<glm::vec2> strands(i == kOutlier ? 9 : 1, {0.1F, 0.9F});
    if (i != kOutlier)
      strands[0] = {0.5F + 0.01F * static_cast<float>(i % 6), 0.5F + 0.01F * static_cast<float>(i / 6)};
    sectors.push_back(
        fixtures::stored(settings, fixtures::arbitrary_record(settings, static_cast<unsigned>(i)), strands));
  }
  fixtures::write_database(file, settings, sectors);
}

std::size_t colours_in(const Image& image) {
  std::set<std::array<float, 3>> colours;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.pixel(x, y);
      colours.insert({p[0], p[1], p[2]});
    }
  }
  return colours.size();
}

TEST(InfoOfDatabase, NamesTheThinnestPlaceAndDrawsIt) {
  for (const FeatureSet set : {FeatureSet::paper3, FeatureSet::moments5, FeatureSet::profile11}) {
    const test::TemporaryFolder folder;
    write_database_with_outlier(folder / "x.hrir", set);
    const test::Result words = test::run(folder, {"info", "@x.hrir", "-o", "@x.png"});
    EXPECT_EQ(words.code, 0) << words.err;
    EXPECT_THAT(words.out, HasSubstr("30 records"));
    EXPECT_THAT(words.out, HasSubstr("thinnest places     records 17,"));
    const Image picture = read_image(folder / "x.png");
    EXPECT_EQ(picture.width, 1440);
    EXPECT_GT(colours_in(picture), 200U);  // cards, words and dots, not one flat colour
    const auto json = nlohmann::json::parse(test::run(folder, {"info", "@x.hrir", "--json"}).out);
    EXPECT_EQ(json["thinnest"][0], kOutlier);
    EXPECT_GT(json["spacing"]["max"].get<double>(), 3 * json["spacing"]["p95"].get<double>());
  }
}

TEST(InfoOfDatabase, ComparesWithAHairstyle) {
  const test::TemporaryFolder folder;
  const Hairstyle style = fixtures::hand_made_style(2, 40, 1);
  save_hairstyle(style, folder / "style.json");
  BakeSettings settings = fixtures::small_settings();
  settings.sectors = 1000;
  bake_database(settings, &style, folder / "own.hrir", {});
  const auto covered = [&](const char* file) {
    const auto ran = test::run(folder, {"info", file, "--against", "@style.json", "-o", "@c.png", "--json"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(ran.out)["against"];
  };
  EXPECT_EQ(covered("@own.hrir")["distances"]["max"], 0.0);  // every non-empty sector is a record
  write_database_with_outlier(folder / "other.hrir", FeatureSet::profile11);
  EXPECT_GT(covered("@other.hrir")["uncovered_share"].get<double>(), 0.5);
}

TEST(InfoOfDatabase, OptionsOfADatabaseAreRefusedForHair) {
  const test::TemporaryFolder folder;
  const auto hair = test::run(folder, {"info", test::kExamples + "three_locks.hairstyle.json", "-o", "@x.png"});
  EXPECT_EQ(hair.code, 2);
  EXPECT_THAT(hair.err, HasSubstr("is no database"));
  write_database_with_outlier(folder / "x.hrir", FeatureSet::paper3);
  EXPECT_EQ(test::run(folder, {"info", "@x.hrir", "-o", "@absent/x.png"}).code, 1);
  EXPECT_EQ(test::run(folder, {"info", "@x.hrir", "-o", "@x.gif"}).code, 2);
}

TEST(InfoOfDatabase, AFullDiskIsASentenceAndTheEarlierPictureStays) {
  const test::TemporaryFolder folder;
  write_database_with_outlier(folder / "x.hrir", FeatureSet::paper3);
  for (const std::string name : {"x.png", "x.exr"}) {
    folder.write(name, "earlier");
    // 32 blocks of 512 or 1024 bytes: less than either picture.
    const std::string command = "trap '' XFSZ; ulimit -f 32; exec " PELAGE_PROGRAM " info " +
                                (folder / "x.hrir").string() + " -o " + (folder / name).string();
    const test::Result ran = test::Child(folder, {"-c", command}, {}, "/bin/sh").wait();
    EXPECT_EQ(ran.code, 1) << ran.out;
    EXPECT_THAT(ran.err, HasSubstr(name + ": cannot write"));
    EXPECT_EQ(test::text_of(folder / name), "earlier");
  }
  EXPECT_EQ(folder.entries(), 5U);  // database, two pictures, stdout, stderr
}

TEST(Draw, ADiscCoversItsArea) {
  Image image(40, 40);
  draw::disc(image, {20.3F, 19.6F}, 9, {1, 1, 1});
  double area = 0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) area += static_cast<double>(image.pixel(x, y)[3]);
  }
  EXPECT_NEAR(area, std::numbers::pi * 81, 0.02 * std::numbers::pi * 81);  // a linear edge ramp over one pixel
}

TEST(Draw, NothingIsDrawnOutside) {
  Image image(8, 8);
  draw::fill(image, {-5, 6}, {10, 10}, {1, 0, 0});
  draw::disc(image, {-2, -2}, 1, {1, 1, 1});
  draw::disc(image, {1e4F, 3}, 2, {1, 1, 1});
  EXPECT_EQ(image.pixel(4, 7)[0], 1.0F);
  EXPECT_EQ(image.pixel(5, 7)[0], 0.0F);
  EXPECT_EQ(image.pixel(0, 5)[0], 0.0F);
}

TEST(Draw, TextIsAsWideAsItSays) {
  Image image(200, 40);
  const int width = draw::text(image, {5, 25}, "3.14 strands", 14, {1, 1, 1});
  if (width == 0) GTEST_SKIP() << "no DejaVu font here (Debian: fonts-dejavu-core)";
  int last = 0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (image.pixel(x, y)[3] > 0) last = std::max(last, x);
    }
  }
  EXPECT_NEAR(last, 5 + width, 3);
}

}  // namespace
}  // namespace pelage
