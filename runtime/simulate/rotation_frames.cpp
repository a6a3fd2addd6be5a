#include "pelage/simulate/rotation_frames.h"

#include <algorithm>
#include <cstddef>

namespace pelage {
namespace {

using glm::quat;
using glm::vec3;

constexpr std::size_t kWide = kFrameLanes;
constexpr float kStandstill_m2 = 1e-18F;  // squares of shorter steps leave float's normal range before long
// Of |v2|^2, which is 4 on a straight line, and of 1 + cos of a turn: below it the axis of the turn is rounding's.
constexpr float kNoAxis = 1e-9F;

/// p q, p in the half-space of w >= 0, scaled to unit length: the turn p after the frame q.
quat turned_by(float w, const vec3& v, const quat& q) noexcept {
  const quat r(w * q.w - v.x * q.x - v.y * q.y - v.z * q.z, w * q.x + v.x * q.w + v.y * q.z - v.z * q.y,
               w * q.y - v.x * q.z + v.y * q.w + v.z * q.x, w * q.z + v.x * q.y - v.y * q.x + v.z * q.w);
  const float length = std::sqrt(r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z);
  const float scale = (w < 0 ? -1.0F : 1.0F) / length;
  return {scale * r.w, scale * r.x, scale * r.y, scale * r.z};
}

/// One float of each line.
struct alignas(32) Wide {
  float v[kWide];
};
struct Wide3 {
  Wide x, y, z;
  void set(std::size_t lane, const vec3& p) noexcept { x.v[lane] = p.x, y.v[lane] = p.y, z.v[lane] = p.z; }
};
struct WideFrames {
  Wide w, x, y, z;  // of the frame
  Wide3 tangent;    // where the line goes; that before where it stands still
};

/// From one vertex to the next: `chord` between them, `across` from the one's to the other's far neighbour.
/// Three turns, of which the first that has an axis counts: Wang's two reflections, the smallest turn, half a turn
/// about the normal; then the rest of rounding is turned away.
__attribute__((target_clones("avx2", "default"))) void step(WideFrames& frames, const Wide3& chord,
                                                            const Wide3& across) noexcept {
  for (std::size_t l = 0; l < kWide; ++l) {
    const float ax = across.x.v[l], ay = across.y.v[l], az = across.z.v[l];
    const float aa = ax * ax + ay * ay + az * az;
    const bool goes = aa > kStandstill_m2;
    const float per_length = 1.0F / std::sqrt(goes ? aa : 1.0F);
    const float tx = goes ? ax * per_length : frames.tangent.x.v[l],
                ty = goes ? ay * per_length : frames.tangent.y.v[l],
                tz = goes ? az * per_length : frames.tangent.z.v[l];
    const float qw = frames.w.v[l], qx = frames.x.v[l], qy = frames.y.v[l], qz = frames.z.v[l];
    const float fx = 2 * (qx * qz + qw * qy), fy = 2 * (qy * qz - qw * qx), fz = 1 - 2 * (qx * qx + qy * qy);
    const float cx = chord.x.v[l], cy = chord.y.v[l], cz = chord.z.v[l];
    const float cc = cx * cx + cy * cy + cz * cz;
    const float k = 2 * (cx * fx + cy * fy + cz * fz) / (cc > kStandstill_m2 ? cc : 1.0F);
    const float vx = tx - fx + k * cx, vy = ty - fy + k * cy, vz = tz - fz + k * cz;
    const bool reflects = (cc > kStandstill_m2) & (vx * vx + vy * vy + vz * vz > kNoAxis);
    const float sx = fx + tx, sy = fy + ty, sz = fz + tz, ww = 0.5F * (sx * sx + sy * sy + sz * sz);  // 1 + cos
    const bool turns = ww > kNoAxis;
    const float nx = 1 - 2 * (qy * qy + qz * qz), ny = 2 * (qx * qy + qw * qz), nz = 2 * (qx * qz - qw * qy);
    const float pw = reflects ? cx * vx + cy * vy + cz * vz : (turns ? ww : 0.0F);
    const float px = reflects ? cy * vz - cz * vy : (turns ? fy * tz - fz * ty : nx);
    const float py = reflects ? cz * vx - cx * vz : (turns ? fz * tx - fx * tz : ny);
    const float pz = reflects ? cx * vy - cy * vx : (turns ? fx * ty - fy * tx : nz);
    float rw = pw * qw - px * qx - py * qy - pz * qz, rx = pw * qx + px * qw + py * qz - pz * qy,
          ry = pw * qy - px * qz + py * qw + pz * qx, rz = pw * qz + px * qy - py * qx + pz * qw;
    const float unit = (pw < 0 ? -1.0F : 1.0F) / std::sqrt(rw * rw + rx * rx + ry * ry + rz * rz);
    rw *= unit, rx *= unit, ry *= unit, rz *= unit;
    const float gx = 2 * (rx * rz + rw * ry), gy = 2 * (ry * rz - rw * rx), gz = 1 - 2 * (rx * rx + ry * ry);
    const float ew = 1 + gx * tx + gy * ty + gz * tz;
    const float ex = gy * tz - gz * ty, ey = gz * tx - gx * tz, ez = gx * ty - gy * tx;
    const float ow = ew * rw - ex * rx - ey * ry - ez * rz, ox = ew * rx + ex * rw + ey * rz - ez * ry,
                oy = ew * ry - ex * rz + ey * rw + ez * rx, oz = ew * rz + ex * ry - ey * rx + ez * rw;
    const float one = 1.0F / std::sqrt(ow * ow + ox * ox + oy * oy + oz * oz);
    frames.w.v[l] = one * ow, frames.x.v[l] = one * ox, frames.y.v[l] = one * oy, frames.z.v[l] = one * oz;
    frames.tangent.x.v[l] = tx, frames.tangent.y.v[l] = ty, frames.tangent.z.v[l] = tz;
  }
}

}  // namespace

quat carried_to(const quat& frame, const vec3& tangent) noexcept {
  const vec3 from = frame_tangent(frame), sum = from + tangent;
  const float w = 0.5F * glm::dot(sum, sum);  // 1 + cos, exact where that cancels
  const quat turn =
      w > kNoAxis ? turned_by(w, glm::cross(from, tangent), frame) : turned_by(0, frame_normal(frame), frame);
  const vec3 now = frame_tangent(turn);
  return turned_by(1 + glm::dot(now, tangent), glm::cross(now, tangent), turn);
}

vec3 first_direction(std::span<const vec3> line, const vec3& otherwise) noexcept {
  for (std::size_t i = 1; i < line.size(); ++i) {
    const vec3 d = line[i] - line[i - 1];
    const float dd = glm::dot(d, d);
    if (dd > kStandstill_m2) return d / std::sqrt(dd);
  }
  return otherwise;
}

quat first_frame(std::span<const vec3> line) noexcept {
  return carried_to(quat(1, 0, 0, 0), first_direction(line, {0, 0, 1}));
}

void rotation_frames(std::span<const vec3> line, const quat& first, std::span<quat> frames) noexcept {
  rotation_frames({&line, 1}, {&first, 1}, frames, line.size());
}

void rotation_frames(std::span<const std::span<const vec3>> lines, std::span<const quat> first, std::span<quat> frames,
                     std::size_t stride) noexcept {
  WideFrames now{};
  Wide3 chord{}, across{};
  std::size_t longest = 0;
  for (std::size_t l = 0; l < kWide; ++l) {
    now.w.v[l] = 1, now.tangent.z.v[l] = 1;  // lanes without a line
    if (l >= lines.size() || lines[l].empty()) continue;
    const vec3 tangent = first_direction(lines[l], frame_tangent(first[l]));
    const quat q = carried_to(first[l], tangent);
    frames[l * stride] = q;
    now.w.v[l] = q.w, now.x.v[l] = q.x, now.y.v[l] = q.y, now.z.v[l] = q.z;
    now.tangent.set(l, tangent);
    longest = std::max(longest, lines[l].size());
  }
  for (std::size_t i = 1; i < longest; ++i) {
    for (std::size_t l = 0; l < lines.size(); ++l) {
      const std::span<const vec3> line = lines[l];
      const bool there = i < line.size();  // beyond its end a line stands still
      chord.set(l, there ? line[i] - line[i - 1] : vec3(0));
      across.set(l, there ? line[std::min(i + 1, line.size() - 1)] - line[i - 1] : vec3(0));
    }
    step(now, chord, across);
    for (std::size_t l = 0; l < lines.size(); ++l) {
      if (i < lines[l].size()) frames[l * stride + i] = quat(now.w.v[l], now.x.v[l], now.y.v[l], now.z.v[l]);
    }
  }
}

}  // namespace pelage
