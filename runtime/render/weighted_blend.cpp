#include "pelage/render/weighted_blend.h"

#include <array>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {

WeightedBlend::WeightedBlend() {
  glGenFramebuffers(1, &framebuffer_);
}

WeightedBlend::~WeightedBlend() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(2, textures_);
}

void WeightedBlend::bind(const Program& p, float nearest_m) {
  glUniform1f(p.at("nearest_m"), nearest_m);
  glUniform1f(p.at("weight_depth_m"), kWeightDepth_m);
}

/// Sums of the target's size, tested against its depth.
void WeightedBlend::fit(const Framebuffer& target) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (width_ != target.width() || height_ != target.height()) {
    width_ = target.width();
    height_ = target.height();
    glDeleteTextures(2, textures_);
    glGenTextures(2, textures_);
    for (GLuint i = 0; i < 2; ++i) {
      glBindTexture(GL_TEXTURE_2D, textures_[i]);
      glTexStorage2D(GL_TEXTURE_2D, 1, i == 0 ? GL_RGBA32F : GL_R32F, width_, height_);
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_TEXTURE_2D, textures_[i], 0);
    }
    constexpr std::array<GLenum, 2> kBoth{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glDrawBuffers(2, kBoth.data());
  }
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw GraphicsError("the driver refuses the sums of the weighted order at " + std::to_string(width_) + " x " +
                        std::to_string(height_) + "; use another --order");
  }
}

void WeightedBlend::blend(Framebuffer& target, const std::function<void()>& draw) {
  fit(target);
  constexpr std::array<float, 4> kColour{0, 0, 0, 1}, kAlpha{0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, kColour.data());
  glClearBufferfv(GL_COLOR, 1, kAlpha.data());
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_ONE, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
  draw();
  target.bind();
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(resolve_.id());
  glUniform1i(resolve_.at("weighted_colour"), 0);
  glUniform1i(resolve_.at("weighted_alpha"), 1);
  for (GLuint i = 0; i < 2; ++i) {
    glActiveTexture(GL_TEXTURE0 + i);
    glBindTexture(GL_TEXTURE_2D, textures_[i]);
  }
  glBindVertexArray(array_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace pelage
