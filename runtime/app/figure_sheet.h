// What figures share: a sheet of pictures with text under each, and what is drawn on them.
#pragma once

#include <glm/vec2.hpp>
#include <string>

#include "pelage/app/drawing.h"
#include "pelage/app/prepare.h"
#include "pelage/data_schema/scene.h"
#include "pelage/hair/groom.h"
#include "pelage/image/image.h"

namespace pelage::app {

/// Pictures of one size in rows, two lines of text under each.
class Sheet {
 public:
  Sheet(glm::ivec2 grid, glm::ivec2 picture);
  void put(glm::ivec2 cell, const Image& picture, const std::string& title, const std::string& detail);
  const Image& image() const noexcept { return image_; }

 private:
  glm::ivec2 picture_;
  Image image_;
};

/// The scene's hair or, where none is named, a groom of our own.
Subject subject_of(const Scene& scene, hair::GroomStyle style, std::uint32_t strands);
/// Exposed and over the scene's background. @throws Interrupted
Image picture_of(Drawing& drawing, const Scene& scene);
glm::ivec2 size_of(const Scene& scene);

}  // namespace pelage::app
