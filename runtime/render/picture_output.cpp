#include "pelage/render/picture_output.h"

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <vector>

namespace pelage {
namespace {

/// Maps the part (x0, y0, w, h) of a picture of W x H pixels (row 0 at the top) to the whole of clip space.
glm::mat4 part_matrix(int x0, int y0, int w, int h, int W, int H) {
  const auto f = [](int v) { return static_cast<float>(v); };
  const glm::vec3 scale{f(W) / f(w), f(H) / f(h), 1.0F};
  const float cx = (2.0F * f(x0) + f(w)) / f(W) - 1.0F;
  const float cy = 1.0F - (2.0F * f(y0) + f(h)) / f(H);
  return glm::translate(glm::scale(glm::mat4(1.0F), scale), glm::vec3(-cx, -cy, 0.0F));
}

}  // namespace

Image PictureOutput::render(const PictureSize& size, StageLedger& ledger, const Draw& draw, const TilesDone& told) {
  Image image(size.width, size.height);
  const int side = std::max(1, size.tile_samples / size.supersampling);
  const int w = std::min(size.width, side), h = std::min(size.height, side);
  Framebuffer target(w * size.supersampling, h * size.supersampling, format_, true);
  const int total = ((size.width + w - 1) / w) * ((size.height + h - 1) / h);
  int done = 0;
  if (told) told(0, total);
  for (int y = 0; y < size.height; y += h) {
    for (int x = 0; x < size.width; x += w) {
      {
        auto stage = ledger.run("draw");
        draw(part_matrix(x, y, w, h, size.width, size.height), target);
        glFinish();
      }
      {
        auto stage = ledger.run("read");
        read(target, size.supersampling, image, x, y);
      }
      if (told) told(++done, total);
    }
  }
  return image;
}

void PictureOutput::show(const PictureSize& size, const Presentation& as, StageLedger& ledger, const Draw& draw) {
  auto stage = ledger.run("draw");
  if (!window_target_ || window_target_->width() != size.width || window_target_->height() != size.height) {
    window_target_ = std::make_unique<Framebuffer>(size.width, size.height, format_, true);
  }
  draw(glm::mat4(1.0F), *window_target_);
  present(*window_target_, as);
}

void PictureOutput::read(Framebuffer& target, int supersampling, Image& out, int x0, int y0) {
  const int w = std::min(target.width() / supersampling, out.width - x0);
  const int h = std::min(target.height() / supersampling, out.height - y0);
  Framebuffer mean(target.width() / supersampling, target.height() / supersampling, GL_RGBA32F, false);
  mean.bind();
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(downsample_.id());
  glUniform1i(downsample_.at("supersampling"), supersampling);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, target.colour());
  glBindVertexArray(array_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  std::vector<float> rows(4U * static_cast<std::size_t>(mean.width()) * static_cast<std::size_t>(mean.height()));
  glReadPixels(0, 0, mean.width(), mean.height(), GL_RGBA, GL_FLOAT, rows.data());
  check_opengl("reading the picture");
  for (int y = 0; y < h; ++y) {
    // OpenGL's rows start at the bottom of the tile.
    const float* const from =
        rows.data() + 4U * static_cast<std::size_t>(mean.height() - 1 - y) * static_cast<std::size_t>(mean.width());
    std::copy_n(from, 4 * w, out.pixel(x0, y0 + y));
  }
}

void PictureOutput::present(Framebuffer& target, const Presentation& as) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, target.width(), target.height());
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(present_.id());
  glUniform1f(present_.at("exposure"), as.exposure);
  glUniform3fv(present_.at("background"), 1, glm::value_ptr(as.background));
  glUniform1i(present_.at("gradient"), as.backdrop == Backdrop::gradient ? 1 : 0);
  glUniform2f(present_.at("size"), static_cast<float>(target.width()), static_cast<float>(target.height()));
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, target.colour());
  glBindVertexArray(array_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  check_opengl("showing the picture");
}

}  // namespace pelage
