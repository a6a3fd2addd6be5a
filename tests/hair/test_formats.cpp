// Every format: the same hair comes out of each, what is written comes back bit for bit, what cannot be held is told or
// refused, and no byte of a file hurts. (HARD_CASES 28, 31.)
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "../data_schema/temporary.h"
#include "format_fixtures.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

using test::Bytes;
using test::bytes_of;
using test::Fixture;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

const char* const kWritten[] = {"x.hair", "x.tfx", "x.data", "x.ply", "x.obj", "x.usda"};
constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
constexpr ReadOptions kAnyLength{.check_unit = false};

std::string refusal(const std::string& name, const Bytes& bytes) {
  return test::message_of<InputError>([&] { parse_hair(bytes, name, kAnyLength); });
}

bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

void expect_same(const Strands& read, const Strands& expected, const std::string& name) {
  EXPECT_EQ(read.offsets, expected.offsets) << name;
  EXPECT_TRUE(same_bits(read.vertices, expected.vertices)) << name;
  EXPECT_TRUE(same_bits(read.colours, expected.colours)) << name;
  EXPECT_EQ(read.diameters_m, expected.diameters_m) << name;
  EXPECT_EQ(read.diameter_m, expected.diameter_m) << name;
}

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// `counts` vertices per strand with awkward coordinates: -0, denormals, many digits.
Strands awkward_hair(const std::vector<std::size_t>& counts) {
  Strands strands;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(-0.01F, 0.01F);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    std::vector<glm::vec3> points;
    for (std::size_t k = 0; k < counts[i]; ++k)
      points.emplace_back(k % 2 == 0 ? -0.0F : kDenormal, -0.05F * static_cast<float>(k) + u(random), u(random));
    strands.append(points);
    strands.colours.emplace_back(1.0F, static_cast<float>(static_cast<double>(i) / 255.0), 0.0F);
  }
  strands.diameter_m = 8e-5F;
  return strands;
}

/// What a format can hold of it.
Strands held(Strands strands, const std::string& name) {
  if (is_one_of(name, {"x.data"})) strands.colours.clear();
  if (is_one_of(name, {"x.data", "x.obj"})) {
    strands.diameters_m.clear();
    strands.diameter_m = 0;
  }
  return strands;
}

TEST(Formats, FixturesOfAllFormatsAreTheSameHair) {
  const Strands expected = parse_hair(test::plain_hair(), "a.hair");
  ASSERT_EQ(expected.vertices, test::fixture_vertices());
  for (const Fixture& fixture : test::fixtures()) {
    if (fixture.name.starts_with("full")) continue;
    ReadReport report;
    expect_same(parse_hair(fixture.bytes, fixture.name, {}, &report), expected, fixture.name);
    EXPECT_THAT(report.issues, IsEmpty()) << fixture.name;
    const bool tells = is_one_of(fixture.name, {"a.usda", "text.tfx"});  // a transform; texture coordinates
    EXPECT_EQ(report.notes.size(), tells ? 1U : 0U) << fixture.name;
  }
}

TEST(Formats, RoundTripsAreExact) {
  for (const std::vector<std::size_t>& counts : {std::vector<std::size_t>{4, 4, 4}, {2, 9, 3, 2, 64}}) {
    const Strands strands = awkward_hair(counts);
    for (const std::string name : kWritten) {
      if (counts[0] != counts[1] && name == "x.tfx") continue;
      const std::string bytes = format_strands(strands, name);
      expect_same(parse_hair(bytes_of(bytes), name), held(strands, name), name);
      EXPECT_EQ(format_strands(held(strands, name), name), bytes);  // the same bytes again
    }
  }
}

TEST(Formats, RoundTripsOfRandomNumbersAreExactInText) {
  std::mt19937 random(11);
  Strands strands;
  while (strands.vertices.size() < 20'000) {
    std::vector<glm::vec3> points;
    while (points.size() < 100) {
      glm::vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      if (std::abs(p.x) < 1e6F && std::abs(p.y) < 1e6F && std::abs(p.z) < 1e6F) points.push_back(p);
    }
    strands.append(points);
  }
  for (const std::string name : {"x.obj", "x.usda"})
    expect_same(parse_hair(bytes_of(format_strands(strands, name)), name, kAnyLength), strands, name);
}

TEST(Formats, DiametersAlongAStrandSurviveWhereThereIsRoom) {
  Strands strands = awkward_hair({4, 4});
  strands.diameter_m = 0;
  strands.diameters_m = {4e-5F, 3e-5F, 2e-5F, 1e-5F, 5e-5F, 5e-5F, 5e-5F, 5e-5F};
  for (const std::string name : {"x.hair", "x.ply", "x.usda"}) {
    WriteReport report;
    expect_same(parse_hair(bytes_of(format_strands(strands, name, {}, &report)), name), strands, name);
    EXPECT_THAT(report.lost, IsEmpty()) << name;
  }
  WriteReport report;
  const Strands tfx = parse_hair(bytes_of(format_strands(strands, "x.tfx", {}, &report)), "x.tfx");
  EXPECT_EQ(tfx.diameters_m, (std::vector<float>{2.5e-5F, 2.5e-5F, 2.5e-5F, 2.5e-5F, 5e-5F, 5e-5F, 5e-5F, 5e-5F}));
  ASSERT_EQ(report.lost.size(), 1U);
  EXPECT_THAT(report.lost[0], HasSubstr("along 1 strands"));
}

TEST(Formats, ADiameterOfOneIsNotTakenForNone) {
  Strands strands;
  strands.append(std::vector<glm::vec3>{{0, 0, 0}, {0, 100, 0}});
  strands.diameter_m = 1.0F;  // found by fuzzing: 1 in HAIR's header is what writers leave that have none
  for (const std::string name : {"x.hair", "x.tfx", "x.ply", "x.usda"})
    expect_same(parse_hair(bytes_of(format_strands(strands, name)), name, kAnyLength), strands, name);
}

TEST(Formats, WhatIsLostIsTold) {
  Strands strands = awkward_hair({4, 4});
  const auto lost = [&](const std::string& name) {
    WriteReport report;
    format_strands(strands, name, 0.75F, &report);
    std::string words;
    for (const std::string& s : report.lost) words += s.substr(0, s.find(':')) + ";";
    return words;
  };
  EXPECT_EQ(lost("x.hair"), "");
  EXPECT_EQ(lost("x.usda"), "");
  EXPECT_EQ(lost("x.tfx"), "opacity;");
  EXPECT_EQ(lost("x.ply"), "opacity;");
  EXPECT_EQ(lost("x.obj"), "diameter;opacity;");
  EXPECT_EQ(lost("x.data"), "colour;diameter;opacity;");
  strands.colours[0] = {0.1F, 0.2F, 0.3F};
  EXPECT_EQ(lost("x.ply"), "opacity;colour;");
}

TEST(Formats, OpacitySurvives) {
  const Strands strands = awkward_hair({4});
  for (const std::string name : {"x.hair", "x.usda"}) {
    for (const float opacity : {0.6F, 0.75F, 1.0F / 3.0F, 1e-3F, 1.0F}) {
      WriteReport written;
      ReadReport report;
      parse_hair(bytes_of(format_strands(strands, name, opacity, &written)), name, {}, &report);
      if (written.lost.empty()) {
        EXPECT_EQ(report.opacity, opacity) << name;
      } else {
        EXPECT_NEAR(static_cast<double>(report.opacity.value_or(1.0F)), static_cast<double>(opacity), 6e-8);
        EXPECT_EQ(name, "x.hair");  // half an ulp of 1: it stores 1 - opacity
      }
    }
  }
}

TEST(Formats, WhatAFormatCannotTakeIsRefusedWithTheRemedy) {
  const auto refuses = [](const Strands& strands, const std::string& name) {
    return test::message_of<OutputError>([&] { format_strands(strands, name); });
  };
  EXPECT_THAT(refuses(awkward_hair({4, 4, 5}), "x.tfx"),
              testing::AllOf(HasSubstr("strand 2"), HasSubstr("--resample")));
  Strands long_one;
  long_one.append(std::vector<glm::vec3>(65'537, glm::vec3(0.0F)));
  for (const char* name : {"x.hair", "x.ply"}) EXPECT_THAT(refuses(long_one, name), HasSubstr("--resample"));
  Strands none = awkward_hair({4, 0});
  for (const char* name : {"x.hair", "x.ply", "x.tfx"}) EXPECT_THAT(refuses(none, name), HasSubstr("strand 1"));
  for (const char* name : {"x.abc", "x", "x.hair.gz", "x.bin", ""})
    EXPECT_THROW(check_hair_output(name), UsageError) << name;
  EXPECT_NO_THROW(check_hair_output("folder.usda/X.OBJ"));
}

TEST(Formats, StrandsOfOneOrNoVertexComeBackAsDropped) {
  for (const std::string name : kWritten) {
    const bool takes_none = is_one_of(name, {"x.data", "x.usda", "x.obj"});
    if (name == "x.tfx") continue;  // wants the same count in all
    const Strands strands =
        awkward_hair(takes_none ? std::vector<std::size_t>{3, 1, 0, 2} : std::vector<std::size_t>{3, 1, 2});
    WriteReport written;
    ReadReport report;
    const Strands read = parse_hair(bytes_of(format_strands(strands, name, {}, &written)), name, {}, &report);
    EXPECT_EQ(read.count(), 2U) << name;
    if (name == "x.obj") {
      EXPECT_THAT(written.lost, testing::Contains(HasSubstr("2 strands")));
      continue;
    }
    EXPECT_EQ(report.dropped(), takes_none ? 2U : 1U) << name;
    EXPECT_EQ(report.issues.front().strand, 1U);
  }
}

TEST(Formats, TruncatedAtAnyByteIsRefusedOrClean) {
  for (const Fixture& fixture : test::fixtures()) {
    std::size_t unnoticed = 0;  // bytes at the end that a reader need not miss
    if (is_one_of(fixture.name, {"text.tfx", "text.ply", "a.usda"})) unnoticed = 1;  // the last line's end
    if (fixture.name == "a.obj") unnoticed = fixture.bytes.size();  // an OBJ has no end: it may lose a strand
    for (std::size_t n = 0; n < fixture.bytes.size(); ++n) {
      const Bytes part(fixture.bytes.begin(), fixture.bytes.begin() + static_cast<std::ptrdiff_t>(n));
      const std::string message = refusal(fixture.name, part);
      if (n + unnoticed >= fixture.bytes.size()) continue;
      EXPECT_NE(message, "nothing was thrown") << fixture.name << ", " << n << " of " << fixture.bytes.size();
    }
  }
}

void expect_clean(const Strands& s) {
  ASSERT_EQ(s.offsets.back(), s.vertices.size());
  ASSERT_TRUE(std::is_sorted(s.offsets.begin(), s.offsets.end()));
  for (const glm::vec3& p : s.vertices) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
  for (const float d : s.diameters_m) ASSERT_TRUE(d >= 0 && std::isfinite(d));
  for (const glm::vec3& c : s.colours) ASSERT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1);
  ASSERT_TRUE(s.colours.empty() || s.colours.size() == s.count());
  ASSERT_TRUE(s.diameters_m.empty() || s.diameters_m.size() == s.vertices.size());
}

TEST(Formats, SurviveRandomFlipsAndSplices) {
  std::mt19937 random(13);
  std::vector<Fixture> all = test::fixtures();
  const Strands rich = awkward_hair({4, 4});
  for (const char* name : kWritten) all.push_back({name, bytes_of(format_strands(rich, name, 0.5F))});
  for (const Fixture& fixture : all) {
    std::size_t accepted = 0;
    for (int round = 0; round < 6'000; ++round) {
      Bytes bytes = fixture.bytes;
      for (unsigned k = 0; k <= random() % 3; ++k) bytes[random() % bytes.size()] ^= std::byte(1U << (random() % 8));
      if (round % 4 == 0) {  // a piece again somewhere else
        const auto from = static_cast<std::ptrdiff_t>(random() % bytes.size());
        const auto to = static_cast<std::ptrdiff_t>(random() % bytes.size());
        const Bytes piece(bytes.begin() + from, bytes.begin() + std::min<std::ptrdiff_t>(from + 20, std::ssize(bytes)));
        bytes.insert(bytes.begin() + to, piece.begin(), piece.end());
      }
      try {
        expect_clean(parse_hair(bytes, fixture.name, kAnyLength));
        ++accepted;
      } catch (const InputError&) {
      }
    }
    EXPECT_GT(accepted, 100U) << fixture.name;  // otherwise the loop checked little
  }
}

TEST(Formats, HugeCountsAreRefusedWithoutAllocating) {
  for (const std::int32_t n :
       {-1, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}) {
    for (const std::size_t at : {0, 4, 56}) {
      Bytes bytes = test::plain_data(0);
      test::put(bytes, at, n);
      EXPECT_THAT(refusal("x.data", bytes), HasSubstr("export it again"));
    }
  }
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return bytes_of(text);
  };
  for (const std::string huge : {"4294967295", "4294967296", "18446744073709551615", "99999999999999999999", "-1"}) {
    for (const char* element : {"element vertex 8", "element strand 2", "element face 1", "element edge 1"}) {
      const std::string with = std::string(element, std::string_view(element).rfind(' ') + 1) + huge;
      EXPECT_NE(refusal("x.ply", replaced(test::ply_text(), element, with)), "nothing was thrown") << with;
    }
    EXPECT_NE(refusal("x.tfx", replaced(test::kTfxText, "numStrands 2", "numStrands " + huge)), "nothing was thrown");
    EXPECT_NE(refusal("x.tfx", replaced(test::kTfxText, "numVerts 4", "numVerts " + huge)), "nothing was thrown");
    EXPECT_NE(refusal("x.usda", replaced(test::kUsdaText, "[4, 4]", "[" + huge + ", 4]")), "nothing was thrown");
    EXPECT_NE(refusal("x.obj", replaced(test::kObjText, "l 1 2", "l 1" + huge + " 2")), "nothing was thrown");
  }
  EXPECT_NE(refusal("x.usda", replaced(test::kUsdaText, "[4, 4]", "[2147483647, 2147483647, 10]")),
            "nothing was thrown");
  EXPECT_NE(refusal("x.ply", replaced(test::ply_text(), "2 0 1", "250 0 1")), "nothing was thrown");  // a list
}

TEST(Formats, NumbersThatAreNoneDropTheirStrandOnly) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return bytes_of(text);
  };
  for (const char* bad : {"nan", "inf", "-inf", "1e39", "-1e999", "2e6"}) {
    for (const auto& [name, bytes] :
         {std::pair("x.tfx", replaced(test::kTfxText, "0.0078125, 1", std::string(bad) + ", 1")),
          std::pair("x.ply", replaced(test::ply_text(), "0.0078125 1", std::string(bad) + " 1")),
          std::pair("x.obj", replaced(test::kObjText, "0.0078125 1", std::string(bad) + " 1")),
          std::pair("x.usda", replaced(test::kUsdaText, "0.015625, 2",
                                       std::string(bad == std::string("2e6") ? "4e6" : bad) + ", 2"))}) {
      ReadReport report;
      EXPECT_EQ(parse_hair(bytes, name, {}, &report).count(), 1U) << name << bad;
      ASSERT_EQ(report.issues.size(), 1U);
      EXPECT_TRUE(report.issues[0].dropped && report.issues[0].strand == 1U);
    }
  }
  const Strands tiny = parse_hair(replaced(test::kObjText, "0.0078125 1", "1e-60 1"), "x.obj");
  EXPECT_EQ(tiny.vertices[4].x, 0.0F);  // rounds to zero
}

TEST(Formats, HostileTextTakesLinearTimeAndNoStack) {
  constexpr std::size_t n = 300'000;
  const auto many = [](const std::string& piece) {
    std::string text;
    for (std::size_t k = 0; k < n; ++k) text += piece;
    return text;
  };
  const std::string prim = "#usda 1.0\ndef BasisCurves \"a\" {\n";
  const std::pair<const char*, std::string> cases[] = {
      {"x.usda", "#usda 1.0\n" + many("def X \"a\" {")},
      {"x.usda", "#usda 1.0\n" + many("def BasisCurves \"a\" {")},
      {"x.usda", "#usda 1.0\n" + many("def BasisCurves \"a\" {}")},
      {"x.usda", prim + "point3f[] points = " + many("[(")},
      {"x.usda", prim + "x y = " + many("{([")},
      {"x.usda", prim + many("\"")},
      {"x.usda", prim + many("\\")},
      {"x.usda", prim + many("custom ")},
      {"x.usda", "#usda 1.0\n(" + many("metersPerUnit = 1\n")},
      {"x.ply", "ply\nformat ascii 1.0\n" + many("element a 0\n")},
      {"x.ply", "ply\n" + many("property\n")},
      {"x.ply", "ply\nformat ascii 1.0\n" + many("element a 4000000000\n") + "end_header\n"},
      {"x.obj", "v 0 0 0\n" + many("l 1 1\n")},
      {"x.obj", "v 0 0 0\nl" + many(" 1")},
      {"x.obj", "v 0 0 0\nv 0 0 0\n" + many("l 1 2\nl 2 1\n")},
      {"x.obj", "v 0 0 0\n" + many("v 0 0 0\nl -1 -2\nl -1 1\n")},
      {"x.obj", "v 0 0 0\n" + many("\\\n") + "l 1\n"},
      {"x.tfx", "version 2.0\n" + many("strand 0 numVerts 0\n")},
      {"x.tfx", "version 2.0\n" + many(" ")}};
  for (const auto& [name, text] : cases) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(refusal(name, bytes_of(text)), "nothing was thrown") << text.substr(0, 60);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 20.0) << text.substr(0, 60);  // quadratic would be hours
  }
}

TEST(Obj, JoinsTheEdgesThatBlenderWrites) {
  ReadReport report;
  const Strands s = parse_hair(bytes_of("v 0 0 0\nv 0 .1 0\nv 0 .2 0\nv 1 0 0\nv 1 .1 0\nl 1 2\nl 2 3\nl 4 5\n"),
                               "x.obj", {}, &report);
  EXPECT_EQ(s.offsets, (std::vector<std::uint32_t>{0, 3, 5}));
  EXPECT_THAT(report.notes, testing::ElementsAre(HasSubstr("1 edges joined")));
  // Not across an object's border, nor polylines that happen to meet.
  EXPECT_EQ(parse_hair(bytes_of("v 0 0 0\nv 0 .1 0\nv 0 .2 0\nl 1 2\no b\nl 2 3\n"), "x.obj").count(), 2U);
  EXPECT_EQ(parse_hair(bytes_of("v 0 0 0\nv 0 .1 0\nv 0 .2 0\nl 1 2\nl 2 3 1\n"), "x.obj").count(), 2U);
}

std::vector<std::string> notes_of(const Bytes& bytes, const std::string& name) {
  ReadReport report;
  parse_hair(bytes, name, kAnyLength, &report);
  return report.notes;
}

TEST(Formats, TellsWhichColoursWereAveragedOrClamped) {
  const std::string averaged = "per-point colours averaged to one per strand: they vary along 1 strand";
  const Bytes hair = test::small_hair(), tfx = test::small_tfx();
  EXPECT_THAT(notes_of(hair, "x.hair"), IsEmpty());
  EXPECT_THAT(notes_of(tfx, "x.tfx"), IsEmpty());
  const auto with = [](Bytes bytes, std::size_t from_end, float value) {
    test::put(bytes, bytes.size() - from_end, value);
    return bytes;
  };
  EXPECT_THAT(notes_of(with(hair, 12, 0.75F), "x.hair"), testing::ElementsAre(HasSubstr(averaged)));
  EXPECT_THAT(notes_of(with(tfx, 16, 0.5F), "x.tfx"), testing::ElementsAre(HasSubstr(averaged)));
  EXPECT_THAT(notes_of(with(hair, 108 + 4, 0.5F), "x.hair"),  // of the last point
              testing::ElementsAre(HasSubstr("transparency of 9 points averaged to one")));
  const std::string obj = "v 0 0 0 1 1 1\nv 0 .1 0 1 1 1\nv 0 .2 0 1 1 0\nl 1 2\nv 0 0 0 1 1 1\nl 2 3\n";
  EXPECT_THAT(notes_of(bytes_of(obj), "x.obj"), testing::ElementsAre(HasSubstr(averaged)));
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty float s\n"
      "element strand 2\nproperty ushort nsegs\nend_header\n";
  EXPECT_THAT(
      notes_of(bytes_of(ply + "0 0 0 0 0 0 255 0\n0 1 0 9 0 0 254 0\n1 0 0 8 8 8 255 0\n1 1 0 8 8 8 255 0\n1\n1\n"),
               "x.ply"),
      testing::UnorderedElementsAre(HasSubstr(averaged), HasSubstr("alpha of 1 vertex"),
                                    HasSubstr("texture coordinates")));
  const std::string bright = "v 0 0 0 0 0 2\nv 0 .1 0 0 0 2\nl 1 2\nv 0 0 0 -1 0 1\nv 0 .1 0 -1 0 1\nl 3 4\n";
  EXPECT_THAT(notes_of(bytes_of(bright), "x.obj"), testing::ElementsAre(HasSubstr("colours of 2 strands clamped")));
}

TEST(Formats, TellsWhichTextureCoordinatesAndPinnedVerticesAreNotKept) {
  Bytes tfx = test::plain_tfx();
  test::put(tfx, 160 + 12, 0.0F);  // the first root: as it is written
  EXPECT_THAT(notes_of(tfx, "x.tfx"), IsEmpty());
  test::put(tfx, 160 + 16 + 12, 0.0F);
  EXPECT_THAT(notes_of(tfx, "x.tfx"), testing::ElementsAre(HasSubstr("1 pinned vertex behind the root")));
  test::put(tfx, 16, static_cast<std::uint32_t>(tfx.size()));
  for (int k = 0; k < 4; ++k) test::append(tfx, 0.5F);
  EXPECT_THAT(notes_of(tfx, "x.tfx"), testing::Contains(HasSubstr("texture coordinates not read: of 2 strands")));
  EXPECT_THAT(notes_of(bytes_of(test::kTfxText), "x.tfx"),
              testing::ElementsAre(HasSubstr("texture coordinates not read: of 2 strands")));
  EXPECT_THAT(notes_of(bytes_of("vt 0 1\n" + test::kObjText), "x.obj"),
              testing::ElementsAre(HasSubstr("texture coordinates not read: of 1 strand")));
}

TEST(Formats, ManyBadStrandsAreCountedAndTheFirstAreNamed) {
  constexpr std::int32_t n = 500'000;
  Bytes bytes = test::plain_data(0);
  test::put(bytes, 0, n + 2);
  bytes.resize(bytes.size() + 4 * std::size_t{n});
  ReadReport report;
  EXPECT_EQ(parse_hair(bytes, "x.data", {}, &report).count(), 2U);
  EXPECT_EQ(report.dropped(), std::size_t{n});
  EXPECT_EQ(report.repaired(), 0U);
  ASSERT_EQ(report.issues.size(), 10'000U);
  EXPECT_EQ(report.issues.back().strand, 10'001U);
}

TEST(Formats, WithoutAUsableStrandTheFirstDropIsTheReason) {
  std::string text = test::kUsdaText;
  text.replace(text.find("0, 2, 0"), 7, "nan, 0, 0");
  text.replace(text.find("[4, 4]"), 6, "[8]");
  text.insert(text.find("rel material"), "float[] widths = [-1, 0, 0, 0, 0, 0, 0, 0]\n");
  EXPECT_THAT(refusal("x.usda", bytes_of(text)), HasSubstr("strand 0: vertex 0 is not a finite position"));
}

TEST(Formats, AByteOrderMarkIsPassedOver) {
  const std::string mark = "\xEF\xBB\xBF";
  const Strands expected = parse_hair(test::plain_hair(), "a.hair");
  expect_same(parse_hair(bytes_of(mark + test::kObjText), "x.obj"), expected, "x.obj");
  expect_same(parse_hair(bytes_of(mark + test::kTfxText), "x.tfx"), expected, "x.tfx");
  expect_same(parse_hair(bytes_of(mark + test::kUsdaText), "x.usda"), expected, "x.usda");
}

TEST(Formats, NumbersTooLongForFloatRoundToTheNearest) {
  const std::string tiny = "0." + std::string(60, '0') + "1", huge = "1" + std::string(60, '0');
  const auto x_of = [](const std::string& x) {
    return parse_hair(bytes_of("v " + x + " 0 0\nv 0 .1 0\nl 1 2\n"), "x.obj", kAnyLength).vertices[0].x;
  };
  for (const std::string& zero :
       {tiny, "-" + tiny, "+" + tiny, std::string("1e-999"), "0." + std::string(400, '0') + "1"})
    EXPECT_EQ(x_of(zero), 0.0F) << zero;
  EXPECT_EQ(refusal("x.obj", bytes_of("v " + huge + " 0 0\nv 0 .1 0\nl 1 2\n")).find("is no number"),
            std::string::npos);
  for (const char* bad : {"+-1", "++1", "+", "1.5.2", "0x10", "1e", "--1"})
    EXPECT_THAT(refusal("x.obj", bytes_of(std::string("v ") + bad + " 0 0\n")), HasSubstr("is no number")) << bad;
}

TEST(Obj, ReadsContinuedLinesAndTrailingComments) {
  const Strands expected = parse_hair(test::plain_hair(), "a.hair");
  const std::string text =
      "# a folder: C:\\\nv 0 1 0 # a root\nv 0 0.95\\\n 0\nv 0 \\\r\n0.9 \\\r\n0\nv 0 0.85 0#\nl 1 2 \\\n3 4 # strand\n"
      "v 0.0078125 1 0\nv 0.0078125 0.95 0\nv 0.0078125 0.9 0\nv 0.0078125 0.85 0\nl 5 6 7 8\\";
  expect_same(parse_hair(bytes_of(text), "x.obj"), expected, "x.obj");
  EXPECT_THAT(refusal("x.obj", bytes_of("v 0 0 0\nv 0 \\\n\\\n")), HasSubstr("line 3"));
}

TEST(Obj, JoinsEdgesInAnyOrderWhereTheyFormAChain) {
  const std::string vertices = "v 0 0 0\nv 0 .1 0\nv 0 .2 0\nv 0 .3 0\nv 1 0 0\nv 1 .1 0\n";
  const auto heights = [&](const std::string& edges) {  // "0 1 2; 5 6": of each strand
    std::string text;
    const Strands s = parse_hair(bytes_of(vertices + edges), "x.obj", kAnyLength);
    for (std::size_t i = 0; i < s.count(); ++i) {
      if (i > 0) text += ';';
      for (const glm::vec3& p : s.strand(i)) text += ' ' + std::to_string(std::lround(10 * p.y + 5 * p.x));
    }
    return text;
  };
  EXPECT_EQ(heights("l 2 3\nl 1 2\n"), " 0 1 2");  // all run from 1
  EXPECT_EQ(heights("l 3 2\nl 2 1\n"), " 2 1 0");
  EXPECT_EQ(heights("l 2 1\nl 3 2\n"), " 2 1 0");
  EXPECT_EQ(heights("l 2 3\nl 2 1\n"), " 2 1 0");  // directions differ: the end that is named first
  EXPECT_EQ(heights("l 1 2\nl 3 2\n"), " 0 1 2");
  EXPECT_EQ(heights("l 3 4\nl 5 6\n# between\n\nl 2 1\nl 3 2\n"), " 3 2 1 0; 5 6");
  EXPECT_EQ(heights("l 3 4\nl 1 2\nl 6 5\nl 2 3\n"), " 0 1 2 3; 6 5");
  EXPECT_EQ(heights("l 1 2\nl 2 3\nl 2 4\n"), " 0 1 2; 1 3");  // a fork: only those that continue the one before
  EXPECT_EQ(heights("l 2 4\nl 2 3\nl 1 2\n"), " 1 3; 1 2; 0 1");
  EXPECT_EQ(heights("l 1 2\nl 2 3\nl 3 1\n"), " 0 1 2 0");  // a ring
  EXPECT_EQ(heights("l 2 3\nl 1 2 3\nl 1 2\n"), " 1 2; 0 1 2; 0 1");
  EXPECT_EQ(heights("l 1 2\nl 1 2\n"), " 0 1; 0 1");
}

TEST(Obj, ColoursPolygonsAndWhatIsMissing) {
  ReadReport report;
  const Strands s =
      parse_hair(bytes_of("v 0 0 0\nv 0 .1 0\nl 1 2\nv 1 0 0 .25 .5 1\nv 1 .1 0 .75 .5 1\nl 3 4\nf 1 2 3\n"), "x.obj",
                 {}, &report);
  EXPECT_EQ(s.colours, (std::vector<glm::vec3>(2, {0.5F, 0.5F, 1.0F})));  // the first has none: the mean of the others
  ASSERT_EQ(report.repaired(), 1U);
  EXPECT_EQ(report.issues[0].strand, 0U);
  EXPECT_THAT(report.notes, testing::UnorderedElementsAre(HasSubstr("1 polygons ignored"), HasSubstr("averaged")));
  EXPECT_THAT(refusal("x.obj", bytes_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), HasSubstr("--head"));
  EXPECT_THAT(refusal("x.obj", bytes_of("v 0 0 0\nl 1 2\n")), HasSubstr("line 2"));
  EXPECT_THAT(refusal("x.obj", bytes_of("v 0 0\n")), HasSubstr("line 1"));
  EXPECT_THAT(refusal("x.obj", bytes_of("v 0 0 0\nl\n")), HasSubstr("line 2"));
}

TEST(Ply, ABareVertexListIsRefusedWithTheRemedy) {
  const std::string bare =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_THAT(refusal("x.ply", bytes_of(bare + "end_header\n0 0 0\n")),
              testing::AllOf(HasSubstr("GaussianHaircut"), HasSubstr(".data")));
  EXPECT_THAT(refusal("x.ply", bytes_of("ply\nformat ascii 1.0\nend_header\n")), HasSubstr("vertex"));
  EXPECT_THAT(refusal("x.ply", bytes_of("ply\nformat what 1.0\nend_header\n")), HasSubstr("what"));
}

TEST(Ply, WritesTheLayoutOfHairutil) {
  const Strands strands = awkward_hair({2, 3});
  const std::string text = format_strands(strands, "x.ply");
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment Pelage: metres, Y up\nelement vertex 5\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar alpha\nproperty float thickness\nelement strand 2\nproperty ushort nsegs\nelement edge 3\n"
      "property int vertex1\nproperty int vertex2\nend_header\n";
  EXPECT_EQ(text.substr(0, header.size()), header);
  EXPECT_EQ(text.size(), header.size() + 5 * 20 + 2 * 2 + 3 * 8);
}

TEST(Tfx, WritesItsHeaderAndPinsTheRoot) {
  const std::string text = format_strands(awkward_hair({4, 4}), "x.tfx");
  const Bytes bytes = bytes_of(text);
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  const std::uint32_t expected[] = {std::bit_cast<std::uint32_t>(4.0F), 2, 4, 160, 0, 0, 160 + 128, 160 + 128 + 8};
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(word(4 * k), expected[k]) << k;
  EXPECT_EQ(bytes.size(), 160U + 128 + 8 + 128);
  for (std::size_t k = 0; k < 8; ++k)
    EXPECT_EQ(word(160 + 16 * k + 12), std::bit_cast<std::uint32_t>(k % 4 == 0 ? 0.0F : 1.0F)) << k;
}

TEST(Data, NamesItsWiderTwin) {
  EXPECT_THAT(refusal("x.data", test::plain_data(4)), HasSubstr("extension .bin"));
  EXPECT_THAT(refusal("x.bin", test::plain_data(0)), HasSubstr("another format"));
}

TEST(TfxText, TellsItsTransformAndRefusesOtherVersions) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = test::kTfxText;
    text.replace(text.find(from), from.size(), to);
    return bytes_of(text);
  };
  ReadReport report;
  parse_hair(with("scale 1.0", "scale 0.5"), "x.tfx", {}, &report);
  EXPECT_THAT(report.notes, testing::Contains(HasSubstr("scale")));
  parse_hair(with("translation 0 0 0", "translation 0 0 3"), "x.tfx", {}, &report);
  EXPECT_THAT(report.notes, testing::Contains(HasSubstr("translation")));
  EXPECT_THAT(refusal("x.tfx", with("version 2.0", "version 3.0")), HasSubstr("3.0"));
  EXPECT_THAT(refusal("x.tfx", with("numStrands 2", "numStrands 3")), HasSubstr("3 strands"));
  EXPECT_THAT(refusal("x.tfx", with("0, 0.95", "0; 0.95")), HasSubstr("line 13"));
}

TEST(RealFiles, SintelThroughEveryFormatAndBack) {
  const fs::path file = PELAGE_SOURCE_DIR "/../shared/data/sintel/sintel_hair_16points.tfx";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  const Strands strands = read_hair(file);
  const test::TemporaryFolder folder;
  for (const std::string name : kWritten) {
    write_strands(strands, folder / name);
    expect_same(read_hair(folder / name), strands, name);
  }
}

TEST(RealFiles, FurAsBSplineControlPoints) {
  const fs::path file = PELAGE_SOURCE_DIR "/../shared/data/fur/fur.hair";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  ReadReport report;
  const Strands control = read_hair(file, {}, &report);
  const Strands curves = read_hair(file, {.curve = Curve::b_spline}, &report);
  EXPECT_THAT(report.issues, IsEmpty());
  ASSERT_EQ(curves.vertices.size(), 8 * curves.count());
  for (std::size_t i = 0; i < curves.count(); i += 997) {  // ends of the one span, by the definition of the basis
    const auto c = control.strand(i);
    const glm::vec3 first = (c[0] + 4.0F * c[1] + c[2]) / 6.0F, last = (c[1] + 4.0F * c[2] + c[3]) / 6.0F;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(curves.strand(i).front()[k], first[k], 3e-7F);
      EXPECT_NEAR(curves.strand(i).back()[k], last[k], 3e-7F);
    }
  }
}

}  // namespace
}  // namespace pelage::hair
