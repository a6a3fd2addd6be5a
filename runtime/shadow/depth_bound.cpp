#include "pelage/shadow/depth_bound.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pelage/data_schema/errors.h"
#include "pelage/shadow/hair_pieces.h"
#include "pelage/shadow/hair_shadow.h"
#include "pelage/shadow/light_mapping.h"

namespace pelage {
namespace {

constexpr std::size_t kChunk = 8192;  // vertices between two looks at the sums
constexpr int kMargin = 2;            // columns around the hair, so that every three by three is inside

/// [y][z] depth of columns.
struct Columns {
  int y = 0, z = 0;
  std::vector<float> depth;

  Columns(int y_, int z_) : y(y_), z(z_), depth(static_cast<std::size_t>(y) * static_cast<std::size_t>(z)) {}
  std::size_t at(int row, int column) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(z) + static_cast<std::size_t>(column);
  }
  void add(const PieceBlock& block) noexcept {
    for (std::size_t i = 0; i < block.count; ++i) {
      const int row = std::clamp(static_cast<int>(block.y[i]), 1, y - 2);
      const int column = std::clamp(static_cast<int>(block.z[i]), 1, z - 2);
      depth[at(row, column)] += block.depth[i];
    }
  }
  float greatest() const noexcept { return *std::max_element(depth.begin(), depth.end()); }
  float greatest_of_nine() const noexcept {
    float most = 0;
    for (int row = 1; row + 1 < y; ++row) {
      for (int column = 1; column + 1 < z; ++column) {
        float sum = 0;
        for (int r = row - 1; r <= row + 1; ++r)
          for (int c = column - 1; c <= column + 1; ++c) sum += depth[at(r, c)];
        most = std::max(most, sum);
      }
    }
    return most;
  }
};

}  // namespace

float greatest_depth(const Strands& strands, float opacity, const Light& light, int resolution, float enough) {
  if (light.position) throw UsageError("a point light has no columns: there is no bound of its hair's depth");
  check_hair(strands, opacity);
  if (strands.vertices.empty()) return 0;
  LightMapping m;
  m.axes = light_axes(light.direction);
  m.centre = strands.vertices[0];
  const Box box = box_along(m.axes, m.centre, strands.vertices);
  const glm::vec3 extent = box.extent();
  const float cell = std::max({extent.x, extent.y, extent.z, 1e-6F}) / static_cast<float>(std::max(resolution, 1));
  m.cells_per_unit = glm::vec3(1 / cell);
  m.offset = -box.low / cell + static_cast<float>(kMargin);
  const auto columns = [&](float size_m) { return static_cast<int>(std::ceil(size_m / cell)) + 2 * kMargin; };
  Columns sums(columns(extent.y), columns(extent.z));
  Cutting cutting;
  cutting.opacity = opacity;
  cutting.cells = {columns(extent.x), sums.y, sums.z};
  for (std::size_t v = 0; v < strands.vertices.size(); v += kChunk) {
    const std::size_t end = std::min(v + kChunk, strands.vertices.size());
    cut_hair(strands, m, cutting, v, end, [&](PieceBlock& block) { sums.add(block); });
    if (sums.greatest() > enough) break;
  }
  return sums.greatest_of_nine();
}

}  // namespace pelage
