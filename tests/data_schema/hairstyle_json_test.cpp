#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/procedural_strands.h"
#include "temporary.h"

namespace pelage {
namespace {

using test::message_of;
using ::testing::HasSubstr;
const std::filesystem::path kExamples = PELAGE_SOURCE_DIR "/data_schema/examples";

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const Hairstyle& a, const Hairstyle& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.source_hash, b.source_hash);
  EXPECT_EQ(a.division, b.division);
  EXPECT_EQ(a.diameter_m, b.diameter_m);
  EXPECT_EQ(a.opacity, b.opacity);
  ASSERT_EQ(a.clusters.size(), b.clusters.size());
  for (std::size_t i = 0; i < a.clusters.size(); ++i) {
    const Cluster &p = a.clusters[i], &q = b.clusters[i];
    EXPECT_TRUE(same_bits(p.centre_line, q.centre_line));
    EXPECT_TRUE(same_bits(p.cross_sections, q.cross_sections));
    EXPECT_EQ(p.first_normal, q.first_normal);
    EXPECT_EQ(p.strand_offsets, q.strand_offsets);
    EXPECT_TRUE(same_bits(p.strand_points, q.strand_points));
    EXPECT_TRUE(same_bits(p.transforms, q.transforms));
    EXPECT_EQ(p.colour, q.colour);
  }
}

/// A hairstyle of awkward numbers: floats drawn over many magnitudes.
Hairstyle random_hairstyle(unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](double size) {
    return static_cast<float>((static_cast<double>(random()) / 0x1p31 - 1) * size);
  };
  Hairstyle style{
      "n\u00e4me \"x\"", "in.hair", std::string(64, 'a'), {3, 17, 9, 0.25F}, 7.7e-5F + 1e-6F * number(1), 0.3F, {}};
  for (int c = 0; c < 3; ++c) {
    Cluster cluster;
    for (int i = 0; i < 5 + c; ++i) cluster.centre_line.emplace_back(number(1), number(1e-3), number(1e5));
    for (int i = 0; i < 4; ++i) cluster.cross_sections.push_back({0.02F + number(0.01), number(0.001), 0.02F});
    cluster.first_normal = {number(1), 1.0F, number(1)};
    for (std::uint32_t s = 0; s < 20; ++s) {
      for (std::uint32_t k = 0; k < 2 + s; ++k)
        cluster.strand_points.push_back({static_cast<float>(k + 1) / 23.0F, number(1), number(1e-20)});
      cluster.strand_offsets.push_back(static_cast<std::uint32_t>(cluster.strand_points.size()));
    }
    if (c == 1) cluster.colour = {0.1F, 0.2F, 0.3F};
    if (c == 2) {
      glm::mat4 m(1.0F);
      m[3] = {number(10), number(10), 0.1F, 1.0F};
      m[1][0] = number(0.3);
      cluster.transforms = {glm::mat4(1.0F), m};
    }
    style.clusters.push_back(cluster);
  }
  return style;
}

TEST(HairstyleJson, SavedFileReadsBackBitForBit) {
  const test::TemporaryFolder folder;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Hairstyle style = random_hairstyle(seed);
    save_hairstyle(style, folder / "style.json");
    expect_same(load_hairstyle(folder / "style.json"), style);
  }
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(HairstyleJson, ExamplesLoad) {
  const Hairstyle lock = load_hairstyle(kExamples / "lock.hairstyle.json");
  ASSERT_EQ(lock.clusters.size(), 1U);
  EXPECT_EQ(lock.strand_count(), 400U);
  EXPECT_FLOAT_EQ(lock.diameter_m, 160e-6F);
  EXPECT_EQ(lock.division.sectors, 16);
  EXPECT_GT(sweep(lock.clusters[0], 24).length_m, 0.2F);
  const Hairstyle three = load_hairstyle(kExamples / "three_locks.hairstyle.json");
  ASSERT_EQ(three.clusters.size(), 1U);
  ASSERT_EQ(three.clusters[0].transforms.size(), 3U);
  EXPECT_FLOAT_EQ(three.clusters[0].transforms[0][3].x, -0.03F) << "translation is the last column";
  EXPECT_FLOAT_EQ(three.clusters[0].transforms[2][2].x, 0.5F) << "rows in the file, columns in glm";
}

std::string hairstyle_of(const std::string& cluster) {
  return R"({"version": 1, "clusters": [{)" + cluster + "}]}";
}
constexpr const char* kStraight = R"("centre_line": [[0,0.2,0],[0,0,0]], "radii_m": 0.01)";

TEST(HairstyleJson, ShortControlListsAreTheSameCurveWithMoreControls) {
  const test::TemporaryFolder folder;
  const Hairstyle style = load_hairstyle(folder.write(
      "s.json", hairstyle_of(R"("centre_line": [[0,3,0],[3,0,0]], "radii_m": [0.02, 0.01], "strand_count": 1)")));
  const Cluster& c = style.clusters[0];
  ASSERT_EQ(c.centre_line.size(), 4U);
  EXPECT_LT(glm::length(c.centre_line[1] - glm::vec3(1, 2, 0)), 1e-6F);
  for (const float x : {0.0F, 0.3F, 1.0F}) {
    EXPECT_LT(glm::length(evaluate_b_spline(c.centre_line, x) - glm::vec3(3 * x, 3 - 3 * x, 0)), 2e-6F);
    EXPECT_NEAR(evaluate_b_spline(c.cross_sections, x).xx, 0.02F - 0.01F * x, 1e-8F);
  }
  EXPECT_NEAR(glm::dot(c.first_normal, glm::vec3(1, -1, 0)), 0.0F, 1e-6F);
  EXPECT_FLOAT_EQ(style.diameter_m, 400e-6F) << "one strand: the default's upper end";
}

TEST(HairstyleJson, ThreeWaysToGiveStrands) {
  const test::TemporaryFolder folder;
  const auto load = [&](const std::string& strands) {
    return load_hairstyle(folder.write("s.json", hairstyle_of(kStraight + std::string(", ") + strands)));
  };
  const Hairstyle listed = load(R"("strands": [[[0,0.1,0],[1,0.2,0]],[[0.25,0,0.5],[0.5,0,0.5],[0.75,0,0.25]]])");
  EXPECT_EQ(listed.clusters[0].strand_offsets, (std::vector<std::uint32_t>{0, 2, 5}));
  EXPECT_EQ(listed.clusters[0].strand(1)[2].y, 0.25F);
  save_hairstyle(listed, folder / "packed.json");
  EXPECT_THAT(test::text_of(folder / "packed.json"), HasSubstr("packed_strands"));
  expect_same(load_hairstyle(folder / "packed.json"), listed);
  EXPECT_EQ(load(R"("strand_count": 12, "distribution": "shell")").strand_count(), 12U);
}

TEST(HairstyleJson, StrandsAreGivenExactlyOnce) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& rest) {
    const auto file = folder.write("s.json", hairstyle_of(R"("centre_line": [[0,1,0],[0,0,0]])" + rest));
    return message_of<InputError>([&] { load_hairstyle(file); });
  };
  EXPECT_THAT(message(R"(, "radii_m": 0.1)"),
              HasSubstr("/clusters/0: give exactly one of the keys strand_count, strands, packed_strands"));
  EXPECT_THAT(message(R"(, "radii_m": 0.1, "strand_count": 3, "strands": [])"), HasSubstr("give exactly one of"));
  EXPECT_THAT(message(R"(, "strand_count": 3)"), HasSubstr("give exactly one of the keys radii_m, cross_sections"));
}

TEST(HairstyleJson, WhatASchemaCannotSayIsCheckedToo) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& cluster) {
    const auto file = folder.write("s.json", hairstyle_of(cluster));
    return message_of<InputError>([&] { load_hairstyle(file); });
  };
  const std::string straight = kStraight;
  EXPECT_THAT(message(straight + R"(, "strands": [[[0,0,0],[0.5,0,0],[0.5,0,0]]])"),
              HasSubstr("/clusters/0: strand 0: point 2: t = 0.500000 does not increase"));
  EXPECT_THAT(message(straight + R"(, "strands": [[[0,0,0],[1.5,0,0]]])"), HasSubstr("is not in [0, 1]"));
  EXPECT_THAT(message(R"("centre_line": [[0,1,0],[0,1,0]], "radii_m": 0.1, "strand_count": 1)"),
              HasSubstr("centre_line has no length"));
  EXPECT_THAT(message(R"("centre_line": [[0,1,0],[0,0,0]], "cross_sections": [[1,2,1]], "strand_count": 1)"),
              HasSubstr("cross_sections/0 is not positive definite"));
  EXPECT_THAT(message(straight + R"(, "first_normal": [0,0,0], "strand_count": 1)"), HasSubstr("first_normal"));
  EXPECT_THAT(message(straight + R"(, "transforms": [[[0,0,0,0],[0,1,0,0],[0,0,1,0]]], "strand_count": 1)"),
              HasSubstr("transforms/0 flattens"));
}

TEST(HairstyleJson, PackedStrandsThatLieAreRefused) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& counts, const std::string& points) {
    const auto file =
        folder.write("s.json", hairstyle_of(kStraight + (R"(, "packed_strands": {"points_per_strand": ")" + counts +
                                                         R"(", "points": ")" + points + R"("})")));
    return message_of<InputError>([&] { load_hairstyle(file); });
  };
  const std::string two_points = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAA";  // (0,0,0), (1,0,0)
  const std::string nan_point = "AAAAAAAAAAAAAAAAAACAPwAAwH8AAAAA";   // (0,0,0), (1,NaN,0)
  EXPECT_EQ(message("AgAAAA==", two_points), "nothing was thrown");
  EXPECT_THAT(message("AwAAAA==", two_points), HasSubstr("disagree: 2 points are there"));
  EXPECT_THAT(message("/////w==", two_points), HasSubstr("disagree"));
  EXPECT_THAT(message("AgAAAA==", two_points + two_points), HasSubstr("disagree: 4 points are there"));
  EXPECT_THAT(message("AQAAAAEAAAA=", two_points), HasSubstr("strand 0: has fewer than 2 points"));
  EXPECT_THAT(message("AgAA", two_points), HasSubstr("no multiple of 4"));
  EXPECT_THAT(message("AgAAAA==", "AAAA"), HasSubstr("no multiple of 12"));
  EXPECT_THAT(message("AgAAAA==", "?AAA"), HasSubstr("is not base64"));
  EXPECT_THAT(message("AgAAAA==", nan_point), HasSubstr("point 1"));
}

TEST(HairstyleJson, BrokenHairstyleIsNotSaved) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("style.json", "old");
  Hairstyle style = random_hairstyle(1);
  style.clusters[1].strand_points[5].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(save_hairstyle(style, file), InputError);
  EXPECT_THROW(save_hairstyle(random_hairstyle(1), folder / "missing/style.json"), OutputError);
  EXPECT_EQ(test::text_of(file), "old");
}

TEST(ProceduralStrands, StayInTheDiskAndWander) {
  for (const auto distribution : {StrandDistribution::uniform, StrandDistribution::shell}) {
    Cluster cluster;
    append_procedural_strands(cluster, 2000, distribution, 5);
    ASSERT_EQ(cluster.strand_count(), 2000U);
    float drift = 0, largest_bend = 0, mean_radius_sq = 0;
    for (std::size_t s = 0; s < cluster.strand_count(); ++s) {
      const auto strand = cluster.strand(s);
      EXPECT_EQ(strand.front().t, 0.0F);
      EXPECT_EQ(strand.back().t, 1.0F);
      for (std::size_t k = 0; k < strand.size(); ++k) {
        const float radius = std::hypot(strand[k].x, strand[k].y);
        EXPECT_LE(radius, 0.981F);
        mean_radius_sq += radius * radius / static_cast<float>(strand.size() * cluster.strand_count());
        if (k > 0) {
          EXPECT_GT(strand[k].t, strand[k - 1].t);
        }
        if (k > 1) largest_bend = std::max(largest_bend, std::abs(strand[k].x - 2 * strand[k - 1].x + strand[k - 2].x));
      }
      drift += std::hypot(strand.back().x - strand.front().x, strand.back().y - strand.front().y) / 2000;
    }
    EXPECT_GT(drift, 0.05F);
    // A spline's second derivative at its clamped end is 6 n^2 (c0 - 3/2 c1 + c2 / 2), n = 4 spans, |c| <= 0.12 of
    // drift and as much of turn; over steps of 1/32 that is at most 0.07. Independent points would differ by 1.
    EXPECT_LT(largest_bend, 0.07F);
    // Uniform on a disk of radius R: E r^2 = R^2 / 2; shell: (R^2 + 0.36) / 2. Wander adds less than 0.02.
    EXPECT_NEAR(mean_radius_sq, distribution == StrandDistribution::uniform ? 0.48F : 0.66F, 0.025F);
  }
}

TEST(ProceduralStrands, DependOnSeedAndIndexOnly) {
  Cluster few, many, other;
  append_procedural_strands(few, 3, StrandDistribution::uniform, 9);
  append_procedural_strands(many, 30, StrandDistribution::uniform, 9);
  append_procedural_strands(other, 3, StrandDistribution::uniform, 10);
  many.strand_points.resize(few.strand_points.size());
  EXPECT_TRUE(same_bits(few.strand_points, many.strand_points));
  EXPECT_FALSE(same_bits(few.strand_points, other.strand_points));
}

}  // namespace
}  // namespace pelage
