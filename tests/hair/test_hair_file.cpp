// Readers and writer: what a file says arrives; what is wrong is refused by name; nothing hurts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <random>

#include "../data_schema/temporary.h"
#include "bytes.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_file.h"

namespace pelage::hair {
namespace {

using test::append_point;
using test::Bytes;
using test::put;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr std::uint32_t kHuge = 0xFFFF'FFFFU;

std::string refusal(const Bytes& bytes, const ReadOptions& options = {}, const std::string& name = "x.hair") {
  try {
    parse_hair(bytes, name, options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(HairFile, ReadsEveryArrayOfHair) {
  ReadReport report;
  const Strands s = parse_hair(test::small_hair(), "x.hair", {}, &report);
  EXPECT_EQ(s.offsets, (std::vector<std::uint32_t>{0, 3, 5, 9}));
  EXPECT_EQ(s.vertices[4], glm::vec3(0.01F, -0.05F, 0.5F));
  EXPECT_EQ(s.diameter_m, 1e-4F);  // the same at all points: said once
  EXPECT_TRUE(s.diameters_m.empty());
  EXPECT_EQ(s.colours, std::vector<glm::vec3>(3, glm::vec3(0.5F, 0.25F, 0.125F)));
  ASSERT_TRUE(report.opacity.has_value());
  EXPECT_FLOAT_EQ(*report.opacity, 0.75F);
  EXPECT_TRUE(report.issues.empty());
  EXPECT_TRUE(report.notes.empty());
}

TEST(HairFile, ReadsTfx) {
  ReadReport report;
  const Strands s = parse_hair(test::small_tfx(), "x.tfx", {}, &report);
  EXPECT_EQ(report.format, "TFX 4");
  EXPECT_EQ(s.offsets, (std::vector<std::uint32_t>{0, 4, 8}));
  EXPECT_EQ(s.vertices[5], glm::vec3(0.01F, 0.95F, 0.0F));
  EXPECT_EQ(s.diameters_m[3], 2e-4F);
  EXPECT_EQ(s.diameters_m[4], 3e-4F);
  EXPECT_EQ(s.colours[1], glm::vec3(0.75F, 0.5F, 0.25F));
}

TEST(HairFile, LowercaseMagicIsHairToo) {
  Bytes bytes = test::small_hair();
  std::memcpy(bytes.data(), "hair", 4);
  EXPECT_EQ(parse_hair(bytes, "x.hair").count(), 3U);
}

TEST(HairFile, ZeroDefaultsMeanUnknown) {
  Bytes bytes = test::hair_header(1, 2, 2, 1);
  append_point(bytes, 0, 0, 0);
  append_point(bytes, 0, -0.1F, 0);
  ReadReport report;
  const Strands s = parse_hair(bytes, "x.hair", {}, &report);
  EXPECT_EQ(s.diameter_m, 0.0F);
  EXPECT_TRUE(s.diameters_m.empty() && s.colours.empty() && !report.opacity);
}

TEST(HairFile, ThicknessThatIsNoDiameterIsIgnoredWithANote) {
  Bytes bytes = test::hair_header(1, 2, 2, 1);
  put(bytes, 20, 0.09F);  // of a strand of 0.1
  append_point(bytes, 0, 0, 0);
  append_point(bytes, 0, -0.1F, 0);
  ReadReport report;
  EXPECT_EQ(parse_hair(bytes, "x.hair", {}, &report).diameter_m, 0.0F);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_THAT(report.notes[0], HasSubstr("thickness"));
  put(bytes, 20, 1e-4F);
  EXPECT_EQ(parse_hair(bytes, "x.hair").diameter_m, 1e-4F);
}

TEST(HairFile, RefusesDialectsByName) {
  Bytes luxcore = test::hair_header(1, 2, 0x22, 1);
  for (int k = 0; k < 10; ++k) test::append(luxcore, 0.0F);
  EXPECT_THAT(refusal(luxcore), HasSubstr("LuxCore"));
  Bytes vkhr = test::hair_header(1, 2, 0xE2, 1);
  for (int k = 0; k < 6 + 6 + 2; ++k) test::append(vkhr, 0.0F);
  EXPECT_THAT(refusal(vkhr), HasSubstr("vkhr"));
  EXPECT_THAT(refusal(test::hair_header(1, 2, 0x102, 1)), HasSubstr("no known dialect"));
}

TEST(HairFile, RefusesOtherFormatsByName) {
  const auto text = [](const std::string& s) {
    Bytes bytes(s.size());
    std::memcpy(bytes.data(), s.data(), s.size());
    return bytes;
  };
  EXPECT_THAT(refusal(text("Ogawa\xFF"), {}, "x.abc"), HasSubstr("Alembic"));
  EXPECT_THAT(refusal(text("PXR-USDC"), {}, "x.usd"), HasSubstr("usdcat"));
  EXPECT_THAT(refusal(text("anything"), {}, "x.txt"), HasSubstr("none of the hair formats"));
  EXPECT_THAT(refusal(text("nothing"), {}, "x.hair"), HasSubstr("does not start with"));
  for (const char* name : {"x.hair", "x.hrir", "x.txt"}) EXPECT_THAT(refusal({}, {}, name), HasSubstr("empty")) << name;
  EXPECT_THAT(refusal(text(std::string("SQLite format 3\0more", 20)), {}, "x.hair"), HasSubstr("HRIR database"));
  EXPECT_THAT(refusal(text("anything"), {}, "x.tfxbone"), HasSubstr("bone weights"));
  Bytes old = test::small_tfx();
  put(old, 0, 3.0F);
  EXPECT_THAT(refusal(old, {}, "x.tfx"), HasSubstr("version 3"));
  put(old, 0, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(refusal(old, {}, "x.tfx"), HasSubstr("version nan"));
}

TEST(HairFile, RefusesTruncationAtEveryByte) {
  for (const Bytes& whole : {test::small_hair(), test::small_tfx()}) {
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
      EXPECT_NE(refusal(part), "accepted") << n << " of " << whole.size() << " bytes";
    }
  }
}

TEST(HairFile, SurvivesRandomFlips) {
  std::mt19937 random(5);
  std::size_t accepted = 0;
  for (const Bytes& whole : {test::small_hair(), test::small_tfx()}) {
    for (int round = 0; round < 20'000; ++round) {
      Bytes bytes = whole;
      for (unsigned k = 0; k <= random() % 3; ++k) bytes[random() % bytes.size()] ^= std::byte(1U << (random() % 8));
      try {
        const Strands s = parse_hair(bytes, round % 2 == 0 ? "x.hair" : "x.tfx", {.check_unit = false});
        ++accepted;
        for (const glm::vec3& p : s.vertices) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
        for (const float d : s.diameters_m) ASSERT_TRUE(d >= 0 && std::isfinite(d));
        for (const glm::vec3& c : s.colours) ASSERT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1);
        ASSERT_EQ(s.offsets.back(), s.vertices.size());
      } catch (const InputError&) {
      }
    }
  }
  EXPECT_GT(accepted, 10'000U);  // otherwise the loop above checked little
}

TEST(HairFile, HugeCountsAreRefusedWithoutAllocating) {
  for (const std::uint32_t n : {kHuge, kHuge - 1, 0x8000'0000U, 0x5555'5556U, 0x1000'0001U}) {
    EXPECT_NE(refusal(test::hair_header(n, n, 31, 0)), "accepted");
    EXPECT_NE(refusal(test::hair_header(n, 4, 2, kHuge)), "accepted");
    EXPECT_NE(refusal(test::hair_header(1, n, 2, n - 1)), "accepted");
    for (const std::size_t field : {4, 8, 12, 24, 28}) {
      Bytes bytes = test::small_tfx();
      put(bytes, field, n);
      EXPECT_NE(refusal(bytes, {}, "x.tfx"), "accepted") << field;
    }
    Bytes both = test::small_tfx();  // the product passes 2^64 when multiplied by 16
    put(both, 4, n);
    put(both, 8, n);
    put(both, 24, std::uint32_t{0});  // no other array that would be refused first
    put(both, 28, std::uint32_t{0});
    EXPECT_NE(refusal(both, {}, "x.tfx"), "accepted");
  }
}

TEST(HairFile, DropsAndRepairsStrandsByIndex) {
  Bytes bytes = test::hair_header(5, 11, 3, 0);
  for (const std::uint16_t n : std::array<std::uint16_t, 5>{1, 0, 2, 2, 1}) test::append(bytes, n);
  append_point(bytes, 0, 0, 0);  // 0: NaN
  append_point(bytes, 0, std::numeric_limits<float>::quiet_NaN(), 0);
  append_point(bytes, 0, 0, 0);  // 1: one vertex
  append_point(bytes, 0, 0, 0);  // 2: first segment of no length
  append_point(bytes, 0, 0, 0);
  append_point(bytes, 0, -0.1F, 0);
  for (int k = 0; k < 3; ++k) append_point(bytes, 1, 1, 1);  // 3: no length at all
  append_point(bytes, 0, 0, 0);                              // 4: infinite
  append_point(bytes, std::numeric_limits<float>::infinity(), 0, 0);
  ReadReport report;
  const Strands s = parse_hair(bytes, "x.hair", {}, &report);
  EXPECT_EQ(s.count(), 1U);
  EXPECT_EQ(s.vertices, (std::vector<glm::vec3>{{0, 0, 0}, {0, -0.1F, 0}}));
  EXPECT_EQ(report.dropped(), 4U);
  EXPECT_EQ(report.repaired(), 1U);
  ASSERT_EQ(report.issues.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(report.issues[i].strand, i);
}

TEST(HairFile, AFileWithoutUsableStrandIsRefused) {
  EXPECT_THAT(refusal(test::hair_header(0, 0, 2, 3)), HasSubstr("no usable strand"));
}

TEST(HairFile, UnitsAndUpAxis) {
  Bytes bytes = test::hair_header(1, 2, 2, 1);
  append_point(bytes, 1, 2, 3);
  append_point(bytes, 1, 2, 13);
  EXPECT_THAT(refusal(bytes), HasSubstr("--unit cm"));
  const auto first = [&](UpAxis up) {
    return parse_hair(bytes, "x.hair", {.metres_per_unit = 0.5, .up = up, .check_unit = false}).vertices[0];
  };
  EXPECT_EQ(first(UpAxis::y), glm::vec3(0.5F, 1, 1.5F));
  EXPECT_EQ(first(UpAxis::z), glm::vec3(0.5F, 1.5F, -1));
  EXPECT_EQ(first(UpAxis::x), glm::vec3(-1, 0.5F, 1.5F));
  EXPECT_THAT(refusal(bytes, {.metres_per_unit = 1e-5}), HasSubstr("--unit cm"));
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(parse_hair(bytes, "x.hair", {.metres_per_unit = bad}), UsageError);
  }
  EXPECT_EQ(parse_unit("in"), 0.0254);
  EXPECT_EQ(parse_unit("0.00254"), 0.00254);
  EXPECT_EQ(parse_unit("+1e-3"), 1e-3);
  EXPECT_THROW(parse_hair(bytes, "x.hair", {.metres_per_unit = 1e-300}), UsageError);
  for (const char* bad : {"", "ft", "nan", "inf", "-1", "0", "1x", "1e-300", "1e-13", "+-1", "1e7"})
    EXPECT_THROW(parse_unit(bad), UsageError) << bad;
  EXPECT_THROW(parse_up_axis("w"), UsageError);
  EXPECT_THROW(parse_curve("bezier"), UsageError);
}

TEST(HairFile, BSplineOfEvenControlPointsIsAStraightLine) {
  Bytes bytes = test::hair_header(1, 4, 2, 3);
  for (int k = 0; k < 4; ++k) append_point(bytes, 0, 0.1F * static_cast<float>(k), 0);
  const Strands s = parse_hair(bytes, "x.hair", {.curve = Curve::b_spline});
  ASSERT_EQ(s.vertices.size(), 8U);
  for (std::size_t k = 0; k < 8; ++k) {  // linear precision: from control point 1 to 2
    EXPECT_NEAR(s.vertices[k].y, 0.1F + 0.1F * static_cast<float>(k) / 7.0F, 1e-7F);
  }
}

TEST(HairFile, WritesWhatItReads) {
  const test::TemporaryFolder folder;
  for (const Bytes& bytes : {test::small_hair(), test::small_tfx()}) {
    Strands s = parse_hair(bytes, "x.hair");
    s.diameter_m = 1.5e-4F;
    for (const bool arrays : {true, false}) {
      if (!arrays) s.diameters_m.clear(), s.colours.clear();
      const fs::path file = folder / "round_trip.hair";
      write_hair(s, file);
      const Strands r = read_hair(file);
      EXPECT_EQ(r.offsets, s.offsets);
      EXPECT_EQ(r.vertices, s.vertices);
      EXPECT_EQ(r.diameters_m, s.diameters_m);
      EXPECT_EQ(r.colours, s.colours);
      if (!arrays) {
        EXPECT_EQ(r.diameter_m, s.diameter_m);
      }
    }
  }
}

TEST(HairFile, WriterRefusesWhatItCannotWrite) {
  const test::TemporaryFolder folder;
  const Strands good = parse_hair(test::small_hair(), "x.hair");
  EXPECT_THROW(write_hair(good, folder / "no_such_folder/x.hair"), OutputError);
  EXPECT_THROW(write_hair(good, testing::TempDir()), OutputError);
  Strands long_one;
  long_one.append(std::vector<glm::vec3>(65'537, glm::vec3(0.0F)));
  EXPECT_THROW(write_hair(long_one, folder / "x.hair"), OutputError);
}

TEST(HairFile, MissingFileAndFolderAreInputErrors) {
  EXPECT_THROW(read_hair("/no/such/file.hair"), InputError);
  EXPECT_THROW(read_hair(testing::TempDir()), InputError);
}

struct RealFile {
  const char* name;
  double metres_per_unit;
  std::size_t strands, vertices;
};

class RealFiles : public testing::TestWithParam<RealFile> {};

TEST_P(RealFiles, HaveTheKnownCounts) {
  const fs::path file = fs::path(PELAGE_SOURCE_DIR "/../shared/data") / GetParam().name;
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  ReadReport report;
  const Strands s = read_hair(file, {.metres_per_unit = GetParam().metres_per_unit}, &report);
  EXPECT_EQ(s.count(), GetParam().strands);
  EXPECT_EQ(s.vertices.size(), GetParam().vertices);
  EXPECT_TRUE(report.issues.empty());
}

INSTANTIATE_TEST_SUITE_P(HairFile, RealFiles,
                         testing::Values(RealFile{"sintel/sintel_hair_16points.tfx", 1, 11'400, 182'400},
                                         RealFile{"sintel_guides/sintel_guides_32points.tfx", 0.01, 228, 7'296},
                                         RealFile{"ratboy/Ratboy_mohawk.tfx", 1, 2'228, 71'296},
                                         RealFile{"fur/fur.hair", 1, 50'000, 200'000}));

TEST(HairFile, CentimetresAreRefusedWithTheRemedy) {
  const fs::path file = PELAGE_SOURCE_DIR "/../shared/data/sintel_guides/sintel_guides_32points.tfx";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  EXPECT_THAT([&] { read_hair(file); }, testing::ThrowsMessage<InputError>(HasSubstr("--unit cm")));
}

}  // namespace
}  // namespace pelage::hair
