// No seams and no beads (DESIGN section 5 "Strands must run through"): maps out of an adapted database.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <complex>
#include <filesystem>

#include "fixture.h"
#include "pelage/bake/bake_pipeline.h"
#include "pelage/db/database_source.h"

namespace pelage::test {
namespace {

class Seams : public ::testing::Test {
 protected:
  static constexpr int kPerHsv = 8;  // samples of the surface along t per HSV

  void SetUp() override {
    Cluster cluster = straight_cluster(cross_section({.012F, .008F, .5F}));
    fill_disk(cluster, 110, 1.2F);  // strands turn by 70 degrees from root to tip: they cross sectors
    style_ = style_of(std::move(cluster), {4, 24, 24, 0.1F});
    bake_.sectors = 400;
    file_ = std::filesystem::temp_directory_path() / ("pelage-seams-" + std::to_string(::getpid()) + ".hrir");
    bake_database(bake_, &style_, file_, [](std::uint64_t, std::uint64_t) {});
    source_ = std::make_unique<DatabaseSource>(file_);
    model_ = make_model(style_, bake_, source_->samples());
    source_->attach(model_.sectors);
    texels_.resize(model_.texels());
    MapRequest request;
    request.eye = {0.4F, -0.1F, 0.5F};
    request.to_light = glm::normalize(glm::vec3(0.2F, 0.3F, 1));
    build_maps(model_, *source_, request, {}, texels_);
    views_ = plate_views(model_, request.eye);
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  float alpha(int layer, float x, float at) const {
    return sample_map(model_, texels_, 0, layer, x, at, true, views_).alpha;
  }

  BakeSettings bake_;
  Hairstyle style_;
  std::filesystem::path file_;
  std::unique_ptr<DatabaseSource> source_;
  SatfModel model_;
  std::vector<Texel> texels_;
  std::vector<glm::vec3> views_;
};

TEST_F(Seams, GradientAcrossSectorBordersIsThatInside) {
  // Borders: where a sector's window ends and where it peaks, every half spacing.
  double border = 0, inside = 0;
  long borders = 0, insides = 0;
  const int half = model_.samples / 4;
  for (int layer = 1; layer < 4; ++layer) {
    const int width = model_.layout.widths[static_cast<std::size_t>(layer)];
    for (int row = 1; row < 24; ++row) {
      for (int x = 0; x < width; ++x) {
        const auto texel = [&](int i) {
          return unpack_texel(texels_[model_.layout.texel(0, layer, row) + static_cast<std::size_t>(i % width)]).alpha;
        };
        const double gradient = static_cast<double>(std::abs(texel(x + 1) - texel(x)));
        const bool at_border = (x + 1) % half == 0;
        (at_border ? border : inside) += gradient;
        ++(at_border ? borders : insides);
      }
    }
  }
  const double ratio = (border / static_cast<double>(borders)) / (inside / static_cast<double>(insides));
  std::printf("alpha gradient around, at sector borders over inside: %.3f\n", ratio);
  EXPECT_LE(ratio, 1.2);
}

TEST_F(Seams, GradientAcrossPlatesIsThatInside) {
  double border = 0, inside = 0;
  long borders = 0, insides = 0;
  for (int layer = 1; layer < 4; ++layer) {
    const int width = model_.layout.widths[static_cast<std::size_t>(layer)];
    for (int x = 0; x < width; ++x) {
      for (int i = kPerHsv; i < 23 * kPerHsv; ++i) {
        // Steps of the size 1 / kPerHsv; those at borders straddle a plate.
        const float at = (static_cast<float>(i) - 0.5F) / kPerHsv;
        const float xf = static_cast<float>(x) + 0.5F;
        const double gradient =
            static_cast<double>(std::abs(alpha(layer, xf, at + 1.0F / kPerHsv) - alpha(layer, xf, at)));
        const bool at_border = i % kPerHsv == 0;
        (at_border ? border : inside) += gradient;
        ++(at_border ? borders : insides);
      }
    }
  }
  const double ratio = (border / static_cast<double>(borders)) / (inside / static_cast<double>(insides));
  std::printf("alpha gradient along t, at plates over inside: %.3f\n", ratio);
  EXPECT_LE(ratio, 1.2);
}

TEST_F(Seams, SpectrumAlongTheStrandsHasNoPeakAtThePlates) {
  // Power of alpha along t at the frequency of the plates against the median of the frequencies around it, over all
  // columns but those within 12 degrees of edge-on (2 % of the projected width): there the map passes from the layer's
  // outer to its inner surface, which no picture shows side by side. Beads would raise it by an order of magnitude: 2
  // is the spread of neighbouring bins (each a mean over ~1000 columns, so within 10 %) and their slope.
  constexpr int kSamples = 22 * kPerHsv;
  std::vector<double> power(kSamples / 2, 0.0);
  for (int layer = 1; layer < 4; ++layer) {
    const int width = model_.layout.widths[static_cast<std::size_t>(layer)];
    for (int x = 0; x < width; x += 2) {
      const float u = 2 * kPi * (static_cast<float>(x) + 0.5F) / static_cast<float>(width);
      if (std::abs(views_[12].x * std::cos(u) + views_[12].y * std::sin(u)) < 0.2F) continue;
      std::vector<double> line(kSamples);
      for (int i = 0; i < kSamples; ++i) {
        const float at = 1.0F + static_cast<float>(i) / kPerHsv;
        const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / kSamples);
        line[static_cast<std::size_t>(i)] =
            window * static_cast<double>(alpha(layer, static_cast<float>(x) + 0.5F, at));
      }
      for (int f = 16; f < 30; ++f) {
        std::complex<double> sum = 0;
        for (int i = 0; i < kSamples; ++i) {
          sum += line[static_cast<std::size_t>(i)] * std::polar(1.0, -2 * std::numbers::pi * f * i / kSamples);
        }
        power[static_cast<std::size_t>(f)] += std::norm(sum);
      }
    }
  }
  std::vector<double> around;
  for (int f = 16; f < 30; ++f) {
    if (std::abs(f - 22) > 2) around.push_back(power[static_cast<std::size_t>(f)]);
  }
  std::nth_element(around.begin(), around.begin() + static_cast<long>(around.size() / 2), around.end());
  const double ratio = power[22] / around[around.size() / 2];
  std::printf("power of alpha at the plate frequency over that around it: %.2f\n", ratio);
  EXPECT_LT(ratio, 2.0);
}

TEST_F(Seams, NoSearchAfterTheGeometryIsKnown) {
  const std::uint64_t before = source_->searches();
  EXPECT_GT(before, 0U);
  MapRequest request;
  for (int i = 0; i < 3; ++i) {
    request.eye = {std::cos(static_cast<float>(i)), 0, std::sin(static_cast<float>(i))};
    request.to_light = glm::normalize(glm::vec3(0.1F * static_cast<float>(i), 1, 1));
    build_maps(model_, *source_, request, {}, texels_);
  }
  EXPECT_EQ(source_->searches(), before);
}

}  // namespace
}  // namespace pelage::test
