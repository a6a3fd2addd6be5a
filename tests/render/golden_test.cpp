// One small picture against a stored one, on Mesa's llvmpipe only: other drivers round otherwise. After an intended
// change of the looks: PELAGE_UPDATE_GOLDEN=1, look at the picture, commit it.
#include <epoxy/gl.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "fixture.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/image/image_file.h"
#include "strands.h"

namespace pelage {
namespace {

class Golden : public test::WithOpenGl {
 protected:
  void SetUp() override {
    test::WithOpenGl::SetUp();
    if (IsSkipped()) return;
    const std::string renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    if (renderer.find("llvmpipe") == std::string::npos)
      GTEST_SKIP() << "golden pictures are llvmpipe's, not " << renderer;
  }
};

/// Of 255: a value off by more than the soft limit may occur in this share of all values, by more than the hard limit
/// never. llvmpipe's vector width depends on the CPU and changes single samples on edges.
constexpr int kSoft = 3, kHard = 48;
constexpr double kShare = 0.005;

void expect_like_golden(const Image& image, const std::string& name) {
  const std::filesystem::path golden = std::filesystem::path(PELAGE_SOURCE_DIR) / "tests/golden" / (name + ".png");
  if (std::getenv("PELAGE_UPDATE_GOLDEN") != nullptr) {
    write_image(image, golden, {});
    GTEST_SKIP() << golden << " written";
  }
  ASSERT_TRUE(std::filesystem::exists(golden)) << golden << ": make it with PELAGE_UPDATE_GOLDEN=1";
  const Image expected = read_image(golden);
  ASSERT_EQ(expected.width, image.width);
  ASSERT_EQ(expected.height, image.height);
  const auto a = to_srgb8(image), b = to_srgb8(expected);
  Image diff(image.width, image.height);
  std::size_t over = 0;
  int most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int d = std::abs(int(a[i]) - int(b[i]));
    over += d > kSoft;
    most = std::max(most, d);
    diff.rgba[i] = i % 4 == 3 ? 1.0F : float(d) / 64;
  }
  const double share = double(over) / double(a.size());
  std::printf("%s: largest difference %d of 255, %.3g %% over %d\n", name.c_str(), most, 100 * share, kSoft);
  if (share <= kShare && most <= kHard) return;
  const std::filesystem::path folder = std::filesystem::path(PELAGE_BINARY_DIR) / "golden";
  std::filesystem::create_directories(folder);
  write_image(image, folder / (name + ".png"), {});
  write_image(diff, folder / (name + "_diff.png"), {});
  ADD_FAILURE() << name << ": largest difference " << most << " (limit " << kHard << "), " << 100 * share << " % over "
                << kSoft << " (limit " << 100 * kShare << " %); picture and difference are in " << folder;
}

/// Written out, so that new defaults leave the pictures alone.
HairMaterial golden_material() {
  return {"golden",     glm::vec3(0.2F, 0.1F, 0.05F),
          glm::vec3(1), glm::vec3(0.3F, 0.15F, 0.08F),
          1.0F,         0.25F,
          0.35F,        80,
          20,           0.12F,
          0.2F,         0.12F};
}

TEST_F(Golden, Lock) {
  Hairstyle style = load_hairstyle(PELAGE_SOURCE_DIR "/data_schema/examples/lock.hairstyle.json");
  style.division = {3, 12, 16, 0.1F};
  FrameSettings frame = test::front_view();
  frame.camera.eye = {0.1F, 0.15F, 0.55F};
  frame.camera.target = {0, 0.1F, 0};
  frame.lights = {{{0.5F, 0.8F, 0.7F}, {}, glm::vec3(1), 2.0F}, {{-0.8F, 0.2F, -0.4F}, {}, {0.8F, 0.9F, 1}, 0.6F}};
  frame.material = golden_material();
  Image image = test::frame_of(style)->render(frame, 120, 160, 2);
  compose_over(image, glm::vec3(0.85F));
  expect_like_golden(test::checked(std::move(image)), "lock");
}

/// Wavy strands over a wall, a light from the side and a lamp beside them.
Image strand_picture(StrandSettings strands) {
  strands.azimuth = false;
  StrandFrameSettings frame = test::strands_from_the_front();
  frame.camera.eye = {0.1F, 0.05F, 0.5F};
  frame.lights = {{{0.5F, 0.8F, 0.7F}, {}, glm::vec3(1), 2.0F},
                  {{}, glm::vec3(-0.2F, 0, 0.1F), {0.8F, 0.9F, 1}, 0.03F}};
  frame.material = golden_material();
  frame.strands = strands;
  frame.shadow.density_map.resolution = 32;
  frame.shadow.density_map.footprint_m = 0.002F;
  frame.shadow.density_map.trilinear_deposit = true;
  StrandFrame hair(test::strand_lock(400, 12), 0.6F, test::wall());
  Image image = hair.render(frame, 100, 140, 2);
  compose_over(image, glm::vec3(0.85F));
  return test::checked(std::move(image));
}

TEST_F(Golden, Strands) {
  StrandSettings strands;
  strands.smoothing = 3;
  expect_like_golden(strand_picture(strands), "strands");
}

TEST_F(Golden, StrandLines) {
  StrandSettings strands;
  strands.shape = StrandShape::lines;
  strands.order = StrandOrder::weighted;
  strands.lobes = StrandLobes::kajiya_kay;
  expect_like_golden(strand_picture(strands), "strand_lines");
}

}  // namespace
}  // namespace pelage
