// What users of hair shadows know, to compare the density map with: pictures of opacity from the light, fine across the
// light and coarse along it. Both take directional lights only. They deposit what the density map does (a D len sin,
// segments cut to half a pixel, each piece into its pixel), read pixels bilinearly, and take exp(-depth).
//
// Opacity shadow maps [KimNeumann2001]: slices at even distances through the hair's box; each holds the opacity before
// it; between two, linear.
// Deep opacity maps [YukselKeyser2008]: each pixel's layers begin at its own first hair, and each is thicker than the
// one before by the first one's thickness, so that none is spent on empty space; read in each of the four pixels by
// that pixel's own layers.
#pragma once

#include <vector>

#include "pelage/shadow/depth_grid.h"
#include "pelage/shadow/hair_shadow.h"
#include "pelage/shadow/light_mapping.h"

namespace pelage {

class OpacityShadowMap final : public HairShadow {
 public:
  explicit OpacityShadowMap(const OpacityMapSettings& settings) : settings_(settings) {}
  void build(const Strands& strands, float opacity, const Light& light) override;
  void transmittance(std::span<const glm::vec3> points, std::span<float> out) const override;
  std::size_t bytes() const noexcept override { return grid_.bytes(); }
  BuildTimes times() const noexcept override { return times_; }

 private:
  OpacityMapSettings settings_;
  LightMapping mapping_;
  DepthGrid grid_;
  BuildTimes times_;
};

class DeepOpacityMap final : public HairShadow {
 public:
  explicit DeepOpacityMap(const OpacityMapSettings& settings) : settings_(settings) {}
  void build(const Strands& strands, float opacity, const Light& light) override;
  void transmittance(std::span<const glm::vec3> points, std::span<float> out) const override;
  std::size_t bytes() const noexcept override { return (first_.size() + depth_.size()) * sizeof(float); }
  BuildTimes times() const noexcept override { return times_; }

 private:
  std::size_t pixel(float y, float z) const noexcept;
  /// The layer that holds a distance behind the first hair, and how far through it.
  struct Place {
    std::size_t layer;
    float share;
  };
  Place place(float behind_m) const noexcept;
  float depth_at(std::size_t pixel, float x_m) const noexcept;

  OpacityMapSettings settings_;
  LightMapping mapping_;  // x in metres from the hair's first point, y and z in pixels
  int height_ = 1, width_ = 1;
  float thinnest_m_ = 1;      // the first layer
  std::vector<float> first_;  // [y][z] metres to the first hair; infinite: none
  std::vector<float> depth_;  // [y][z][layer] optical depth at the layer's far side
  BuildTimes times_;
};

}  // namespace pelage
