#include "pelage/simulate/centre_lines.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/groom.h"
#include "shape_fixture.h"

namespace pelage {
namespace {

using namespace pelage::test;

Strands one(const std::vector<vec3>& points) {
  Strands strands;
  strands.append(points);
  return strands;
}

Strands curly_groom() {
  hair::GroomSettings settings;
  settings.style = hair::GroomStyle::curly;
  settings.strands = 2000;
  return hair::groom(settings);
}

/// Largest deviation of a chord from the line's mean, as a share of the line's length.
double unevenness(std::span<const vec3> line) {
  const double length = length_of(line), mean = length / static_cast<double>(line.size() - 1);
  double most = 0;
  for (std::size_t i = 1; i < line.size(); ++i)
    most = std::max(most, std::abs(glm::distance(dvec3(line[i - 1]), dvec3(line[i])) - mean));
  return length > 0 ? most / length : 0;
}

TEST(CentreLines, LeaveStraightStrandsAsTheyAre) {
  const dvec3 root(0.1, 1.6, -0.05), run(0.02, -0.3, 0.01);
  const Strands hair = one(curve(11, [&](double u) { return root + u * u * run; }));  // unevenly spaced
  const Strands lines = centre_lines(hair, 16);
  ASSERT_EQ(lines.strand(0).size(), 16U);
  for (std::size_t i = 0; i < 16; ++i) {
    const dvec3 expected = root + static_cast<double>(i) / 15 * run;
    EXPECT_LT(glm::distance(dvec3(lines.vertices[i]), expected), 2e-7) << i;  // an ulp at 1.6 m
  }
  EXPECT_EQ(lines.vertices.front(), hair.vertices.front());
  EXPECT_EQ(lines.vertices.back(), hair.vertices.back());
}

/// A circle of radius R smoothed by a hat of half-width h has radius R sinc^2(h / 2R) = R - h^2 / 12 R.
TEST(CentreLines, MoveBentStrandsInwardsByAsMuchAsTheySay) {
  const double radius = 0.2, length = 0.3;
  const Strands hair = one(curve(200, [&](double u) {
    const double a = length / radius * u;
    return radius * dvec3(std::cos(a), std::sin(a), 0);
  }));
  const Strands lines = centre_lines(hair, 31);
  const double segment = length / 30, expected = radius - std::pow(2 * segment, 2) / (12 * radius);
  for (std::size_t i = 3; i < 28; ++i) EXPECT_NEAR(glm::length(dvec3(lines.vertices[i])), expected, 3e-6) << i;
  EXPECT_LT(glm::distance(lines.vertices.back(), hair.vertices.back()), 1e-7F);
}

TEST(CentreLines, FindTheAxisOfAHelix) {
  for (const double pitch : {0.01, 0.02, 0.03}) {
    const double radius = 0.01, length = 0.3;
    const Strands hair = one(curve(600, [&](double u) {
      const double phi = 2 * kPi * length / pitch * u;
      return dvec3(radius * (std::cos(phi) - 1), -length * u, radius * std::sin(phi));  // grows at the origin
    }));
    const Strands lines = centre_lines(hair, 16);
    for (std::size_t i = 3; i < 13; ++i) {
      const vec3 p = lines.vertices[i];
      EXPECT_LT(std::hypot(static_cast<double>(p.x) + radius, static_cast<double>(p.z)), 0.05 * radius)
          << pitch << ' ' << i;
    }
    EXPECT_NEAR(length_of(lines.strand(0)), length, 0.03 * length) << pitch;
    EXPECT_LT(unevenness(lines.strand(0)), 1e-6) << pitch;
  }
}

TEST(CentreLines, HaveEqualChords) {
  for (const unsigned seed : {1U, 2U}) {
    const Strands hair = random_strands(500, seed);
    const Strands lines = centre_lines(hair, 20);
    for (std::size_t s = 0; s < lines.count(); ++s) {
      ASSERT_GE(lines.strand(s).size(), 2U);
      EXPECT_LT(unevenness(lines.strand(s)), 2e-6) << s;  // 1e-6, and float at 0.5 m from the origin
      EXPECT_EQ(lines.strand(s).front(), hair.strand(s).front());
      EXPECT_EQ(lines.strand(s).back(), hair.strand(s).back());
    }
  }
}

TEST(CentreLines, HaveVerticesByLength) {
  Strands hair;
  for (int i = 1; i <= 10; ++i) hair.append(curve(50, [&](double u) { return dvec3(0.03 * i * u, 0, 0); }));
  hair.append(std::vector{vec3(0), vec3(0.001F, 0, 0)});
  const Strands lines = centre_lines(hair, 21);
  for (std::size_t s = 0; s < 10; ++s) EXPECT_EQ(lines.strand(s).size(), 2 * s + 3);
  EXPECT_EQ(lines.strand(10).size(), 2U);
  const Strands coarse = centre_lines(hair, 2);
  for (std::size_t s = 0; s < coarse.count(); ++s) EXPECT_EQ(coarse.strand(s).size(), 2U);
}

TEST(CentreLines, KeepDiametersAndColours) {
  Strands hair = one(curve(9, [](double u) { return dvec3(0, -0.2 * u, 0); }));
  for (int i = 0; i < 9; ++i) hair.diameters_m.push_back(1e-4F * (1 - static_cast<float>(i) / 16));
  hair.colours = {vec3(0.1F, 0.2F, 0.3F)};
  hair.diameter_m = 7e-5F;
  const Strands lines = centre_lines(hair, 5);
  EXPECT_EQ(lines.colours, hair.colours);
  EXPECT_EQ(lines.diameter_m, hair.diameter_m);
  ASSERT_EQ(lines.diameters_m.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_FLOAT_EQ(lines.diameters_m[i], hair.diameters_m[2 * i]);
}

TEST(CentreLines, TakeStrandsWithoutLength) {
  Strands hair = one({vec3(1, 2, 3)});
  hair.append({});
  hair.append(std::vector<vec3>(5, vec3(0.1F)));
  const Strands lines = centre_lines(hair, 8);
  ASSERT_EQ(lines.count(), 3U);
  for (const vec3& p : lines.strand(0)) EXPECT_EQ(p, vec3(1, 2, 3));
  EXPECT_TRUE(lines.strand(1).empty());
  for (const vec3& p : lines.strand(2)) EXPECT_EQ(p, vec3(0.1F));
  Strands out = hair;
  StrandDetail(hair, lines).apply(lines, glm::dquat(1, 0, 0, 0), out);
  EXPECT_EQ(out.vertices, hair.vertices);
  EXPECT_EQ(centre_lines(Strands{}, 4).count(), 0U);
}

TEST(CentreLines, RefuseWhatIsNotFinite) {
  Strands hair = random_strands(4, 1);
  hair.vertices[hair.offsets[2]].y = INFINITY;
  EXPECT_THROW(centre_lines(hair, 8), InputError);
  EXPECT_THROW(centre_lines(Strands{}, 1), UsageError);
  const Strands fine = random_strands(4, 1);
  EXPECT_THROW(StrandDetail(fine, random_strands(3, 1)), InputError);
}

/// Rest is given back, and a turn of the lines is a turn of the hair, about a place far from the roots too.
void check_detail(const Strands& hair, int vertices, const char* what) {
  const Strands lines = centre_lines(hair, vertices);
  const StrandDetail detail(hair, lines);
  const double size = size_of(hair);
  Strands out = hair;
  for (vec3& p : out.vertices) p = vec3(NAN);
  detail.apply(lines, glm::dquat(1, 0, 0, 0), out);
  EXPECT_LT(largest_distance(out, hair), 4e-7 * size) << what;
  EXPECT_EQ(out.colours, hair.colours);
  for (const glm::dquat& turn :
       {turn_about({0, 1, 0}, 1.0), turn_about({0, 1, 0}, kPi), turn_about({1, 0.2, -0.4}, 2.5)}) {
    const auto rigid = [&](const dvec3& p) { return turned_by(turn, p) + dvec3(0.1, -0.2, 0.3) * size; };
    detail.apply(moved(lines, rigid), turn, out);
    EXPECT_LT(largest_distance(out, moved(hair, rigid)), 1e-5 * size) << what;
  }
}

TEST(StrandDetail, GivesRestBackAndTurnsWithTheHead) {
  check_detail(random_strands(700, 3), 16, "random");
  check_detail(random_strands(700, 3), 2, "random, one segment");
  check_detail(curly_groom(), 16, "curly");
}

TEST(StrandDetail, GivesRealGroomsBackAndTurnsThem) {
  bool any = false;
  for (const RealGroom& groom : kRealGrooms) {
    const Strands hair = read(groom);
    if (hair.count() == 0) continue;
    any = true;
    check_detail(hair, 16, groom.name);
    const Strands lines = centre_lines(hair, 16);
    const double size = size_of(hair);
    for (std::size_t s = 0; s < lines.count(); ++s) {  // two roundings of a float at the size of the head
      EXPECT_LT(unevenness(lines.strand(s)), 1e-6 + 1.2e-7 * size / length_of(lines.strand(s)))
          << groom.name << ' ' << s;
    }
  }
  if (!any) GTEST_SKIP() << "no real grooms in ../shared/data";
}

TEST(StrandDetail, CurlsOfAGroomAreMuchLongerThanTheirLines) {
  const Strands hair = curly_groom(), lines = centre_lines(hair, 16);
  double hair_m = 0, line_m = 0;
  for (std::size_t s = 0; s < hair.count(); ++s) {
    hair_m += length_of(hair.strand(s));
    line_m += length_of(lines.strand(s));
  }
  RecordProperty("hair_over_line", std::to_string(hair_m / line_m));
  EXPECT_GT(hair_m, 1.2 * line_m);
  EXPECT_LT(hair_m, 4 * line_m);
}

/// A helix on a line that is bent into an arc: curls stay curls, no vertex jumps, none spins about the line.
TEST(StrandDetail, RidesOnBentLines) {
  const double radius = 0.01, length = 0.3, pitch = 0.03;
  const auto helix = [&](double u) {
    const double phi = 2 * kPi * length / pitch * u;
    return dvec3(radius * (std::cos(phi) - 1), -length * u, radius * std::sin(phi));
  };
  const Strands hair = one(curve(400, helix)), lines = centre_lines(hair, 16);
  const StrandDetail detail(hair, lines);
  Strands before = hair;
  for (int step = 1; step <= 60; ++step) {
    const double bend = 0.05 * step;  // rad over the whole length
    const auto arc = [&](const dvec3& p) {
      const double a = bend * -p.y / length;
      return dvec3(p.x, 0, 0) + dvec3(0, -length / bend * std::sin(a), length / bend * (1 - std::cos(a))) +
             p.z * dvec3(0, std::sin(a), std::cos(a));
    };
    Strands out = hair;
    detail.apply(moved(lines, arc), glm::dquat(1, 0, 0, 0), out);
    EXPECT_NEAR(length_of(out.strand(0)), length_of(hair.strand(0)), 0.02 * length_of(hair.strand(0))) << bend;
    for (std::size_t i = 1; i < 400; ++i) {
      const double rest = glm::distance(hair.vertices[i - 1], hair.vertices[i]);
      EXPECT_NEAR(glm::distance(out.vertices[i - 1], out.vertices[i]), rest, 0.25 * rest) << bend << ' ' << i;
    }
    // 0.05 rad more: the tip moves by at most 0.05 x length.
    EXPECT_LT(largest_distance(out, before), 0.06 * length) << bend;
    // The arc itself carries the hair to the same places but for the corners' rounding.
    EXPECT_LT(largest_distance(out, moved(hair, arc)), 0.004 + 0.0005 * bend) << bend;
    before = out;
  }
}

TEST(StrandDetail, StaysFiniteOnAnyLines) {
  const Strands hair = random_strands(300, 5), lines = centre_lines(hair, 12);
  const StrandDetail detail(hair, lines);
  Strands out = hair;
  std::mt19937 random(6);
  std::normal_distribution<float> normal;
  for (int kind = 0; kind < 4; ++kind) {
    Strands wild = lines;
    for (std::size_t s = 0; s < wild.count(); ++s) {
      for (std::size_t v = wild.offsets[s]; v < wild.offsets[s + 1]; ++v) {
        if (kind == 0) wild.vertices[v] = wild.vertices[wild.offsets[s]];                 // collapsed
        if (kind == 1) wild.vertices[v] = vec3(0.01F * static_cast<float>(v % 2), 0, 0);  // folds
        if (kind == 2) wild.vertices[v] = 0.1F * vec3(normal(random), normal(random), normal(random));
        if (kind == 3) wild.vertices[v] = 2.0F * wild.vertices[wild.offsets[s]] - wild.vertices[v];  // reversed
      }
    }
    detail.apply(wild, glm::dquat(1, 0, 0, 0), out);
    for (const vec3& p : out.vertices) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << kind;
    for (const vec3& p : out.vertices) ASSERT_LT(glm::length(p), 10) << kind;
  }
}

TEST(StrandDetail, IsTheSameForAnyNumberOfThreads) {
  const Strands hair = random_strands(2000, 7);
  std::vector<vec3> first_lines, first_hair;
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Strands lines = centre_lines(hair, 16);
    const StrandDetail detail(hair, lines);
    Strands out = hair;
    detail.apply(moved(lines, [](const dvec3& p) { return p + dvec3(0.1 * p.y * p.y, 0, 0); }),
                 turn_about({0, 1, 0}, 0.3), out);
    if (threads == 1) first_lines = lines.vertices, first_hair = out.vertices;
    EXPECT_EQ(lines.vertices, first_lines) << threads;
    EXPECT_EQ(out.vertices, first_hair) << threads;
  }
}

TEST(StrandDetail, TakesNanosecondsPerVertex) {
  hair::GroomSettings settings;
  settings.strands = 10'000;
  const Strands hair = hair::groom(settings), lines = centre_lines(hair, 16);
  const StrandDetail detail(hair, lines);
  Strands out = hair;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    double best_ns = 1e9;
    for (int i = 0; i < 20; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      detail.apply(lines, glm::dquat(1, 0, 0, 0), out);
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
      best_ns = std::min(best_ns, took.count() / static_cast<double>(hair.vertices.size()));
    }
    RecordProperty("ns_per_vertex_threads_" + std::to_string(threads), std::to_string(best_ns));
    std::cout << threads << " threads: " << best_ns << " ns per hair vertex, "
              << static_cast<double>(hair.vertices.size()) / static_cast<double>(lines.vertices.size())
              << " of them per vertex of a line\n";
    EXPECT_LT(best_ns, 2000);  // of a sanitized build on a busy machine
  }
}

}  // namespace
}  // namespace pelage
