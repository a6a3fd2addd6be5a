// What a scene's method draws with, behind one interface for pictures and the window.
#pragma once

#include <glm/ext/quaternion_double.hpp>
#include <memory>
#include <string>

#include "pelage/app/prepare.h"
#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/stages.h"
#include "pelage/data_schema/strands.h"
#include "pelage/effects/plan.h"
#include "pelage/image/image.h"
#include "pelage/render/camera.h"

namespace pelage::app {

class Drawing {
 public:
  virtual ~Drawing() = default;
  /// The scene's picture as seen by `camera`, with the effects that it calls for: linear, premultiplied, over
  /// transparent black.
  Image render(const Scene& scene, const Camera& camera) { return draw(planned(scene, camera), camera); }
  /// On the window's framebuffer of this size. @throws UsageError where the method has no frames to show
  void show(const Scene& scene, const Camera& camera, int width, int height) {
    draw_in_window(planned(scene, camera), camera, width, height);
  }
  /// What was run of the last picture, and why.
  const EffectPlan& plan() const noexcept { return plan_; }
  /// What a simulation moves: the strands, or the control polygons of the clusters' centre lines.
  virtual Strands lines() const = 0;  ///< empty where nothing is to move
  virtual Mesh head() const = 0;
  /// The same hair with its lines, laid out as they were, and its head moved.
  /// @param turn  rotation of the head since rest
  virtual void move(const Strands& lines, const glm::dquat& turn, Mesh head) = 0;
  /// The next picture is made as if the hair had moved: what does not depend on that is kept. For measurements.
  virtual void refresh() {}
  virtual HairFacts facts() const = 0;
  virtual const StageLedger& ledger() const = 0;
  /// Of the truth: pictures of different seeds have independent noise. Others have none.
  virtual void set_seed(std::uint64_t) {}
  /// Records that were searched for so far; 0 where there are none.
  virtual std::uint64_t searches() const { return 0; }
  const std::string& name() const noexcept { return name_; }

 protected:
  explicit Drawing(std::string name) : name_(std::move(name)) {}

 private:
  virtual Image draw(const Scene& scene, const Camera& camera) = 0;
  virtual void draw_in_window(const Scene& scene, const Camera& camera, int width, int height) = 0;
  const Scene& planned(const Scene& scene, const Camera& camera);

  EffectPlan plan_;
  std::string name_;
};

/// Does the method draw with OpenGL? It needs a current context then.
bool needs_opengl(Method method) noexcept;

/// Reads the scene's hair and head and prepares what its method needs.
/// @param moving  lines() and move() will be asked for
std::unique_ptr<Drawing> make_drawing(const Scene& scene, bool moving = false);

/// The same for hair that is at hand already; not for satf.
std::unique_ptr<Drawing> make_strand_drawing(Method method, StrandHair hair, Mesh head);

}  // namespace pelage::app
