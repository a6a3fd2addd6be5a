// Real hair files, where the shared data are: rendered without an error, and covering a plausible part of the picture.
#include <gmock/gmock.h>

#include "child.h"
#include "pelage/image/image_file.h"

namespace pelage::test {
namespace {

const std::string kData = PELAGE_SOURCE_DIR "/../shared/data/";

/// Share of the picture that hair (and head) cover.
double rendered_coverage(std::vector<std::string> input) {
  const TemporaryFolder folder;
  input.insert(input.begin(), "render");
  for (const char* option : {"-o",           "@a.exr",      "--size",     "160x120", "--supersampling", "1",
                             "--background", "transparent", "--clusters", "40",      "--layers",        "3",
                             "--sectors",    "12",          "--plates",   "12",      "--bake-sectors",  "120",
                             "--progress",   "never"})
    input.emplace_back(option);
  const Result result = run(folder, input);
  if (result.code == 5) return -1;
  EXPECT_EQ(result.code, 0) << result.err;
  if (result.code != 0) return -1;
  EXPECT_THAT(result.err, ::testing::Not(::testing::HasSubstr("not finite")));
  const Image image = read_image(folder / "a.exr");
  std::size_t n = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) n += image.rgba[i] > 0.02F;
  return 4.0 * double(n) / double(image.rgba.size());
}

void expect_plausible(const std::string& file, std::vector<std::string> options, double least, double most) {
  if (!std::filesystem::exists(kData + file)) GTEST_SKIP() << kData + file << " is not there";
  options.insert(options.begin(), kData + file);
  const double coverage = rendered_coverage(options);
  if (coverage < 0 && !::testing::Test::HasFailure()) GTEST_SKIP() << "no OpenGL";
  std::printf("%s: %.1f %% covered\n", file.c_str(), 100 * coverage);
  EXPECT_GT(coverage, least);
  EXPECT_LT(coverage, most);
}

// The framed camera fills about two thirds of the height; the bob is about as wide as high.
TEST(RealFiles, SintelOnHerHead) {
  expect_plausible("sintel/sintel_hair_16points.tfx", {"--head", kData + "sintel/sintel.obj"}, 0.1, 0.6);
}
TEST(RealFiles, RatBoy) {
  expect_plausible("ratboy/Ratboy_mohawk.tfx", {}, 0.05, 0.7);
}
TEST(RealFiles, Fur) {
  expect_plausible("fur/fur.hair", {}, 0.05, 0.8);
}

// Every real groom by every method that draws strand by strand; fur.hair as what it is meant to be.
TEST(RealFiles, StrandByStrand) {
  const std::vector<std::vector<std::string>> grooms{
      {"sintel/sintel_hair_16points.tfx", "--head", kData + "sintel/sintel.obj"},
      {"sintel_guides/sintel_guides_32points.tfx", "--unit", "cm"},
      {"ratboy/Ratboy_mohawk.tfx"},
      {"fur/fur.hair", "--curve", "bspline"}};
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << kData << " is not there";
  for (const auto& groom : grooms) {
    for (const std::string method : {"unshadowed", "density-map", "deep-opacity", "opacity-shadow", "truth"}) {
      std::vector<std::string> input = groom;
      input[0] = kData + input[0];
      input.insert(input.end(), {"--method", method, "--samples", "1"});
      const double coverage = rendered_coverage(input);
      if (coverage < 0 && !::testing::Test::HasFailure()) GTEST_SKIP() << "no OpenGL";
      EXPECT_GT(coverage, 0.01) << groom[0] << " by " << method;
      EXPECT_LT(coverage, 0.9) << groom[0] << " by " << method;
    }
  }
}

}  // namespace
}  // namespace pelage::test
