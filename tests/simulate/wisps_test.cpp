#include "pelage/simulate/wisps.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <set>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/groom.h"
#include "pelage/simulate/centre_lines.h"
#include "shape_fixture.h"

namespace pelage {
namespace {

using namespace pelage::test;

const glm::dquat kNoTurn(1, 0, 0, 0);

Strands bob_lines(std::uint32_t strands) {
  hair::GroomSettings settings;
  settings.style = hair::GroomStyle::bob;
  settings.strands = strands;
  return centre_lines(hair::groom(settings), 16);
}

Strands interpolated(const Wisps& wisps, const Strands& guides, const glm::dquat& turn, const Strands& lines) {
  Strands out = lines;
  for (vec3& p : out.vertices) p = vec3(NAN);
  wisps.interpolate(guides, turn, out);
  return out;
}

/// A sway that bends lower hair more and is 5 cm at the tips: what simulated wisps do, without a simulation.
dvec3 swayed(const dvec3& p) {
  const double below = std::max(0.0, 1.75 - p.y);
  return p + dvec3(0.6 * below * below * (1 + std::sin(9 * p.z)), 0.3 * below * below, 0.4 * below * below * p.x / 0.1);
}

/// Every strand swayed, its segments as long as before.
Strands swayed_hair(const Strands& rest) {
  Strands out = moved(rest, swayed);
  for (std::size_t s = 0; s < rest.count(); ++s) {
    dvec3 at(0), last(0);
    for (std::size_t v = rest.offsets[s]; v < rest.offsets[s + 1]; ++v) {
      const dvec3 p(out.vertices[v]);
      if (v == rest.offsets[s]) {
        at = p;
      } else {
        at += glm::distance(dvec3(rest.vertices[v - 1]), dvec3(rest.vertices[v])) * glm::normalize(p - last);
      }
      last = p;
      out.vertices[v] = vec3(at);
    }
  }
  return out;
}

void check_rest_and_turns(const Strands& lines, int wisps_wanted, const char* what) {
  const Wisps wisps(lines, wisps_wanted);
  const double size = size_of(lines);
  // Offsets of up to the size, turned there and back, from vertex to vertex.
  EXPECT_LT(largest_distance(interpolated(wisps, wisps.guides(), kNoTurn, lines), lines), 5e-6 * size) << what;
  for (const glm::dquat& turn : {turn_about({0, 1, 0}, kPi), turn_about({1, 0.2, -0.4}, 2.5)}) {
    const auto rigid = [&](const dvec3& p) { return turned_by(turn, p) + dvec3(0.3, -0.2, 0.1) * size; };
    const Strands now = interpolated(wisps, moved(wisps.guides(), rigid), turn, lines);
    EXPECT_LT(largest_distance(now, moved(lines, rigid)), 1e-5 * size) << what;
  }
}

TEST(Wisps, GiveRestBackAndTurnWithTheHead) {
  check_rest_and_turns(bob_lines(3000), 100, "bob");
  check_rest_and_turns(centre_lines(random_strands(500, 3), 16), 20, "of all lengths");
  check_rest_and_turns(centre_lines(random_strands(500, 3), 16), 1000, "more wisps than strands");
}

TEST(Wisps, OfRealGroomsGiveRestBack) {
  bool any = false;
  for (const RealGroom& groom : kRealGrooms) {
    const Strands hair = read(groom);
    if (hair.count() == 0) continue;
    any = true;
    check_rest_and_turns(centre_lines(hair, 16), 134, groom.name);
  }
  if (!any) GTEST_SKIP() << "no real grooms in ../shared/data";
}

TEST(Wisps, HaveThreeGuidesThatDifferAndWeightsThatSumToOne) {
  const Strands lines = bob_lines(3000);
  const Wisps wisps(lines, 100);
  EXPECT_LE(wisps.guides().count(), 300U);
  EXPECT_GE(wisps.guides().count(), 280U);
  std::set<std::array<float, 3>> tips;
  for (std::size_t g = 0; g < wisps.guides().count(); ++g) {
    const vec3 tip = wisps.guides().strand(g).back();
    tips.insert({tip.x, tip.y, tip.z});
  }
  EXPECT_EQ(tips.size(), wisps.guides().count());
  std::size_t alone = 0;
  double nearest = 0, own = 0;
  for (std::size_t s = 0; s < lines.count(); ++s) {
    const Guidance& g = wisps.guidance()[s];
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(g.weight[k], 0.0F);
      ASSERT_LT(g.guide[k], wisps.guides().count());
      sum += g.weight[k];
      alone += g.weight[k] == 1.0F;
    }
    EXPECT_NEAR(sum, 1.0F, 1e-6F) << s;
    // The wisp is where the strand is.
    double least = 1e9;
    for (std::size_t k = 0; k < wisps.guides().count(); ++k)
      least = std::min(least, static_cast<double>(glm::distance(wisps.guides().strand(k)[0], lines.strand(s)[0])));
    nearest += least;
    own += static_cast<double>(glm::distance(wisps.guides().strand(g.guide[0])[0], lines.strand(s)[0]));
  }
  EXPECT_GE(alone, wisps.guides().count());  // guides are their own
  const auto mean_mm = [&](double sum) { return 1e3 * sum / static_cast<double>(lines.count()); };
  std::cout << "root to the nearest guide " << mean_mm(nearest) << " mm, to its own " << mean_mm(own) << " mm\n";
  EXPECT_LT(mean_mm(own), 40);
}

/// Rows of three, apart: each is a wisp. And wisps of one, two, no strands.
TEST(Wisps, UseWhatThereIs) {
  Strands lines;
  for (int group = 0; group < 4; ++group) {
    for (int k = 0; k <= group; ++k) {
      const dvec3 root(group, 0.01 * k, 0);
      lines.append(
          curve(5 + static_cast<std::size_t>(k), [&](double u) { return root + dvec3(0, -0.2 * u, 0.02 * u); }));
    }
  }
  lines.append({});
  lines.append(std::vector{vec3(7)});
  const Wisps wisps(lines, 5);
  EXPECT_EQ(wisps.guides().count(), 1U + 2 + 3 + 3 + 1);
  EXPECT_LT(largest_distance(interpolated(wisps, wisps.guides(), kNoTurn, lines), lines), 1e-6 * 7);
  const Wisps none(Strands{}, 5);
  EXPECT_EQ(none.guides().count(), 0U);
  Strands bad = lines;
  bad.vertices[3].x = NAN;
  EXPECT_THROW(Wisps(bad, 3), InputError);
  EXPECT_THROW(Wisps(lines, 0), UsageError);
}

TEST(Wisps, KeepRootsAndLengthsWhateverTheGuidesDo) {
  const Strands lines = bob_lines(1000);
  const Wisps wisps(lines, 40);
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (int kind = 0; kind < 4; ++kind) {
    Strands guides = wisps.guides();
    for (std::size_t g = 0; g < guides.count(); ++g) {
      const vec3 root = guides.strand(g)[0];
      const vec3 aside = glm::normalize(vec3(normal(random), normal(random), normal(random)));
      for (std::size_t v = guides.offsets[g]; v < guides.offsets[g + 1]; ++v) {
        vec3& p = guides.vertices[v];
        if (kind == 0) p = root + glm::distance(p, root) * aside;  // every which way
        if (kind == 1) p = root + (v % 2 == 0 ? 0.02F : -0.02F) * (v == guides.offsets[g] ? vec3(0) : aside);  // folds
        if (kind == 2) p = root;  // collapsed
        if (kind == 3) p = vec3(swayed(dvec3(p)));
      }
      guides.vertices[guides.offsets[g]] = root;
    }
    const Strands out = interpolated(wisps, guides, kNoTurn, lines);
    for (std::size_t s = 0; s < lines.count(); ++s) {
      EXPECT_LT(glm::distance(out.strand(s)[0], lines.strand(s)[0]), 1e-6F) << kind << ' ' << s;
      for (const vec3& p : out.strand(s)) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << kind << ' ' << s;
      if (kind == 2) continue;  // no direction anywhere
      EXPECT_NEAR(length_of(out.strand(s)), length_of(lines.strand(s)), 1e-5) << kind << ' ' << s;
    }
  }
}

/// Guides against all: the error falls with the number of wisps.
TEST(Wisps, ComeNearToMovingAllStrands) {
  const Strands lines = bob_lines(4000), all = swayed_hair(lines);
  double last = 1e9;
  for (const int count : {10, 40, 160}) {
    const Wisps wisps(lines, count);
    const Strands out = interpolated(wisps, swayed_hair(wisps.guides()), kNoTurn, lines);
    double error2 = 0, motion2 = 0;
    for (std::size_t v = 0; v < out.vertices.size(); ++v) {
      error2 += std::pow(glm::distance(dvec3(out.vertices[v]), dvec3(all.vertices[v])), 2);
      motion2 += std::pow(glm::distance(dvec3(lines.vertices[v]), dvec3(all.vertices[v])), 2);
    }
    const double share = std::sqrt(error2 / motion2);
    std::cout << count << " wisps: RMS error " << 100 * share << " % of the motion\n";
    EXPECT_LT(share, 0.9 * last) << count;
    last = share;
  }
  EXPECT_LT(last, 0.05);
}

TEST(Wisps, AreTheSameForAnyNumberOfThreads) {
  const Strands lines = bob_lines(2000);
  std::vector<vec3> guides, out;
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Wisps wisps(lines, 50);
    const Strands now = interpolated(wisps, moved(wisps.guides(), swayed), turn_about({0, 1, 0}, 0.1), lines);
    if (threads == 1) guides = wisps.guides().vertices, out = now.vertices;
    EXPECT_EQ(wisps.guides().vertices, guides) << threads;
    EXPECT_EQ(now.vertices, out) << threads;
  }
}

TEST(Wisps, TakeNanosecondsPerVertex) {
  const Strands lines = bob_lines(10'000);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto begin = now();
  const Wisps wisps(lines, 134);
  const std::chrono::duration<double, std::milli> made = now() - begin;
  Strands out = lines;
  double best_ns = 1e9;
  for (int i = 0; i < 20; ++i) {
    const auto start = now();
    wisps.interpolate(wisps.guides(), kNoTurn, out);
    const std::chrono::duration<double, std::nano> took = now() - start;
    best_ns = std::min(best_ns, took.count() / static_cast<double>(lines.vertices.size()));
  }
  std::cout << "made in " << made.count() << " ms; " << best_ns << " ns per vertex\n";
  EXPECT_LT(best_ns, 2000);
}

}  // namespace
}  // namespace pelage
