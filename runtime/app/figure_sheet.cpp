#include "pelage/app/figure_sheet.h"

#include <algorithm>

#include "pelage/app/framing.h"
#include "pelage/app/picture.h"
#include "pelage/console/program.h"
#include "pelage/hair/head.h"
#include "pelage/image/draw.h"

namespace pelage::app {
namespace {

constexpr draw::Colour kInk{.12F, .12F, .14F}, kPaper{.95F, .95F, .95F};
constexpr int kText = 15, kLine = 20, kGap = 8;

}  // namespace

Sheet::Sheet(glm::ivec2 grid, glm::ivec2 picture)
    : picture_(picture),
      image_(grid.x * (picture.x + kGap) + kGap, grid.y * (picture.y + 2 * kLine + 2 * kGap) + kGap) {
  draw::fill(image_, {0, 0}, {image_.width, image_.height}, kPaper);
}

void Sheet::put(glm::ivec2 cell, const Image& picture, const std::string& title, const std::string& detail) {
  const glm::ivec2 at = kGap + cell * (picture_ + glm::ivec2(kGap, 2 * kLine + 2 * kGap));
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.pixel(0, y), 4 * picture.width, image_.pixel(at.x, at.y + y));
  draw::text(image_, at + glm::ivec2(2, picture_.y + kLine - 2), title, kText, kInk);
  draw::text(image_, at + glm::ivec2(2, picture_.y + 2 * kLine - 2), detail, kText - 1, kInk);
}

Subject subject_of(const Scene& scene, hair::GroomStyle style, std::uint32_t strands) {
  if (!scene.hair.empty()) return {prepare_strands(scene), prepare_head(scene)};
  hair::GroomSettings groom;
  groom.style = style;
  groom.strands = strands;
  Subject subject{{"groom", hair::groom(groom)}, hair::parametric_head(groom.head)};
  subject.hair.strands.diameter_m = default_diameter_m(subject.hair.strands.count());
  return subject;
}

Image picture_of(Drawing& drawing, const Scene& scene) {
  Image image = drawing.render(scene, camera_of(scene, drawing));
  console::throw_if_interrupted();
  ImageSettings settings = scene.image;
  if (!settings.background) settings.background = ImageSettings{}.background;
  return finished(std::move(image), settings);
}

glm::ivec2 size_of(const Scene& scene) {
  return {scene.image.width, scene.image.height};
}

}  // namespace pelage::app
