#include "pelage/simulate/moving_hair.h"

#include <algorithm>
#include <chrono>
#include <glm/gtc/quaternion.hpp>

namespace pelage {

MovingHair::MovingHair(const Strands& hair, const Mesh& head, const SimulationSettings& settings)
    : head_(head), hair_(hair), lines_(centre_lines(hair, settings.vertices)) {
  if (settings.detail)
    detail_.emplace(hair, lines_);
  else
    hair_ = lines_;
  if (settings.shape.curl.radius_m > 0) {
    curls_.emplace(hair_, settings.shape.curl);
    curled_ = curls_->rest();
  }
  if (settings.wisps > 0) wisps_.emplace(lines_, settings.wisps);
  guides_ = wisps_ ? wisps_->guides() : lines_;
  simulation_.emplace(guides_, head, settings);
  pose_ = {simulation_->pivot(), glm::dquat(1.0, 0.0, 0.0, 0.0)};
}

void MovingHair::advance(double frame_s, const RigidPose& head) {
  simulation_->advance(frame_s, head);
  moved_ = moved_ || simulation_->facts().moved;
  pose_ = head;
}

void MovingHair::teleport(const RigidPose& head) {
  simulation_->teleport(head);
  moved_ = true;
  pose_ = head;
}

void MovingHair::begin(const RigidPose& head, double settle_s, const std::function<void()>& told) {
  constexpr double kPiece_s = 1.0 / 60;
  teleport(head);
  reset();
  simulation_->set_time(-settle_s);
  for (double left_s = settle_s; left_s > 0; left_s -= kPiece_s) {
    if (told) told();
    advance(std::min(left_s, kPiece_s), head);
  }
}

void MovingHair::reset() {
  simulation_->reset();
  moved_ = true;
}

const Strands& MovingHair::hair() {
  hair_ms_ = 0;
  if (!moved_) return curls_ ? curled_ : hair_;
  moved_ = false;
  const auto begin = std::chrono::steady_clock::now();
  simulation_->positions(wisps_ ? guides_ : lines_);
  if (wisps_) wisps_->interpolate(guides_, turn(), lines_);
  if (detail_)
    detail_->apply(lines_, turn(), hair_);
  else
    hair_.vertices = lines_.vertices;
  if (curls_) curls_->apply(hair_, turn(), curled_);
  hair_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return curls_ ? curled_ : hair_;
}

Mesh MovingHair::head() const {
  Mesh moved = head_;
  for (glm::vec3& p : moved.vertices)
    p = glm::vec3(pose_.position + pose_.rotation * (glm::dvec3(p) - simulation_->pivot()));
  for (glm::vec3& n : moved.normals) n = glm::vec3(pose_.rotation * glm::dvec3(n));
  return moved;
}

}  // namespace pelage
