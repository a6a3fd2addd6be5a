// .tfxbone: names and weights arrive, sums become 1, indices are checked, no byte of it hurts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "../data_schema/temporary.h"
#include "bytes.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/tfx_bone.h"

namespace pelage::hair {
namespace {

using test::append;
using test::Bytes;
using testing::HasSubstr;

void append_strand(Bytes& bytes, std::int32_t index, std::int32_t bone, float weight, float other = 0.25F) {
  append(bytes, index);
  append(bytes, bone);
  append(bytes, weight);
  for (int k = 0; k < 3; ++k) {
    append(bytes, std::int32_t{k == 0 ? 0 : -1});
    append(bytes, k == 0 ? other : 0.0F);
  }
}

/// Two bones out of order, two strands; the first weighs 0.5 in all.
Bytes small_bones() {
  Bytes bytes;
  append(bytes, std::int32_t{2});
  for (const std::int32_t i : {1, 0}) {
    append(bytes, i);
    append(bytes, std::int32_t{3});
    for (const char c : {'b', static_cast<char>('0' + i), '\0'}) append(bytes, c);
  }
  append(bytes, std::int32_t{2});
  append_strand(bytes, 1, 1, 0.75F);
  append_strand(bytes, 0, 1, 0.25F);
  return bytes;
}
constexpr std::size_t kFirstStrand = 4 + 2 * 11 + 4;

std::string refusal(const Bytes& bytes) {
  return test::message_of<InputError>([&] { parse_tfxbone(bytes, "x.tfxbone"); });
}

TEST(TfxBone, ReadsAndRenormalises) {
  const TfxBones bones = parse_tfxbone(small_bones(), "x.tfxbone");
  EXPECT_EQ(bones.names, (std::vector<std::string>{"b0", "b1"}));
  ASSERT_EQ(bones.strands.size(), 2U);
  EXPECT_EQ(bones.strands[0].weights, (std::array<float, 4>{0.5F, 0.5F, 0, 0}));
  EXPECT_EQ(bones.strands[1].weights, (std::array<float, 4>{0.75F, 0.25F, 0, 0}));
  EXPECT_EQ(bones.strands[1].bones, (std::array<std::uint32_t, 4>{1, 0, 0, 0}));
  EXPECT_EQ(bones.farthest_sum, 0.5);
  EXPECT_TRUE(bones.repaired.empty());
}

TEST(TfxBone, RepairsWeightsThatAreNone) {
  for (const float bad : {NAN, -1.0F, 0.0F, HUGE_VALF}) {
    Bytes bytes = small_bones();
    test::put(bytes, kFirstStrand + 8, bad);
    const StrandBones mixed = parse_tfxbone(bytes, "x").strands[1];
    EXPECT_EQ(mixed.weights, (std::array<float, 4>{0, 1, 0, 0}));  // the other bone has it all
    test::put(bytes, kFirstStrand + 16, bad);
    const TfxBones bones = parse_tfxbone(bytes, "x");
    EXPECT_EQ(bones.repaired, std::vector<std::size_t>{1});
    EXPECT_EQ(bones.strands[1].bones[0], 1U);
    EXPECT_EQ(bones.strands[1].weights[0], 1.0F);
  }
}

TEST(TfxBone, RefusesIndicesAndCountsOutOfRange) {
  for (const std::int32_t bad : {-1, 2, 0x7FFF'FFFF, -0x7FFF'FFFF - 1}) {
    for (const std::size_t at : {std::size_t{4}, kFirstStrand, kFirstStrand + 4}) {
      Bytes bytes = small_bones();
      test::put(bytes, at, bad);
      EXPECT_THAT(refusal(bytes), HasSubstr("export it again")) << at;
    }
    for (const std::size_t count : {std::size_t{0}, std::size_t{8}, kFirstStrand - 4}) {
      Bytes bytes = small_bones();
      test::put(bytes, count, bad == 2 ? 100 : bad);
      EXPECT_THAT(refusal(bytes), HasSubstr("export it again")) << count;
    }
  }
  Bytes twice = small_bones();
  test::put(twice, kFirstStrand, std::int32_t{0});
  EXPECT_THAT(refusal(twice), HasSubstr("twice"));
  Bytes longer = small_bones();
  longer.push_back(std::byte{0});
  EXPECT_THAT(refusal(longer), HasSubstr("after the last strand"));
}

TEST(TfxBone, SurvivesTruncationAndFlips) {
  const Bytes whole = small_bones();
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_NE(refusal(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n))), "nothing was thrown") << n;
  std::mt19937 random(3);
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = whole;
    bytes[random() % bytes.size()] ^= std::byte(1U << (random() % 8));
    try {
      const TfxBones bones = parse_tfxbone(bytes, "x");
      for (const StrandBones& s : bones.strands) {
        ASSERT_NEAR(s.weights[0] + s.weights[1] + s.weights[2] + s.weights[3], 1.0F, 3e-7F);
        for (const std::uint32_t bone : s.bones) ASSERT_LT(bone, bones.names.size());
      }
    } catch (const InputError&) {
    }
  }
}

TEST(RealFiles, RatboyHangsOnHisBones) {
  const std::filesystem::path file = PELAGE_SOURCE_DIR "/../shared/data/ratboy/Ratboy_mohawk.tfxbone";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const std::string text = test::text_of(file);
  const TfxBones bones = parse_tfxbone(std::as_bytes(std::span(text)), file.string());
  EXPECT_EQ(bones.names.size(), 105U);
  EXPECT_NEAR(bones.farthest_sum, 0.92, 0.0005);
  EXPECT_EQ(bones.names[0], "frenchHornMonster_head_JNT");
  EXPECT_EQ(bones.strands.size(), 2'228U);
  EXPECT_TRUE(bones.repaired.empty());
  for (const StrandBones& s : bones.strands)
    ASSERT_NEAR(s.weights[0] + s.weights[1] + s.weights[2] + s.weights[3], 1.0F, 3e-7F);
}

}  // namespace
}  // namespace pelage::hair
