// Drawing into an Image: what diagrams need. Pixel coordinates, origin at the top left, pixel (x, y) covers
// [x, x + 1) x [y, y + 1); colours are sRGB triples in [0, 1] as a person names them. Whatever lies outside is left
// out.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "pelage/image/image.h"

namespace pelage::draw {

using Colour = glm::vec3;  // sRGB, [0, 1]

void fill(Image& image, glm::ivec2 corner, glm::ivec2 size, Colour colour);
/// An anti-aliased disc over what is there.
void disc(Image& image, glm::vec2 centre, float radius, Colour colour, float opacity = 1);
/// The outline of a rectangle, one pixel wide.
void frame(Image& image, glm::ivec2 corner, glm::ivec2 size, Colour colour);
/// A line of text, its baseline starting at `at`. Returns its width in pixels; 0 and nothing drawn where the system
/// has no font (Debian: fonts-dejavu-core).
int text(Image& image, glm::ivec2 at, const std::string& line, int height_px, Colour colour);

/// Perceptually even from dark blue (0) over green to yellow (1), after the look of viridis; clamped.
Colour ramp(float value);

}  // namespace pelage::draw
