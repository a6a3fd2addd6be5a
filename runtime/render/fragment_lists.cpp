#include "pelage/render/fragment_lists.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

/// Bytes of one fragment, and of the counter before them (common_output.glsl).
constexpr std::size_t kFragmentBytes = 16, kListHeader = 16;
/// Fragments that the lists hold at first.
constexpr std::size_t kFirstCapacity = 2'000'000;
constexpr std::uint32_t kEnd = 0;

}  // namespace

FragmentLists::FragmentLists(std::size_t most_bytes) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  limit_ = (std::min(static_cast<std::size_t>(most), most_bytes) - kListHeader) / kFragmentBytes;
  capacity_ = std::min(kFirstCapacity, limit_);
}

void FragmentLists::bind(const Program& p) const {
  glUniform1ui(p.at("fragment_capacity"), static_cast<GLuint>(capacity_));
  glUniform1ui(p.at("heads_width"), static_cast<GLuint>(width_));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, fragments_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, heads_.id());
}

/// Fragments of these rows, more than the lists hold if they did not fit.
std::size_t FragmentLists::fill(int first_row, int rows, const std::function<void()>& draw) {
  fragments_.allocate(GL_SHADER_STORAGE_BUFFER, kListHeader + capacity_ * kFragmentBytes, GL_STREAM_COPY);
  std::uint32_t used = 0;
  glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof used, &used);
  const auto row_bytes = static_cast<GLintptr>(sizeof kEnd) * width_;
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, heads_.id());
  glClearBufferSubData(GL_SHADER_STORAGE_BUFFER, GL_R32UI, first_row * row_bytes, rows * row_bytes, GL_RED_INTEGER,
                       GL_UNSIGNED_INT, &kEnd);
  glScissor(0, first_row, width_, rows);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, fragments_.id());
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof used, &used);
  return used;
}

void FragmentLists::resolve() {
  glUseProgram(resolve_.id());
  glUniform1ui(resolve_.at("heads_width"), static_cast<GLuint>(width_));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, fragments_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, heads_.id());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(array_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

void FragmentLists::blend(Framebuffer& target, const std::function<void()>& draw) {
  width_ = target.width();
  heads_.allocate(GL_SHADER_STORAGE_BUFFER,
                  sizeof kEnd * static_cast<std::size_t>(width_) * static_cast<std::size_t>(target.height()),
                  GL_STREAM_COPY);
  glEnable(GL_SCISSOR_TEST);
  for (int row = 0; row < target.height();) {
    const int rows = std::min(rows_at_once_, target.height() - row);
    const std::size_t used = fill(row, rows, draw);
    if (used <= capacity_) {
      resolve();
      row += rows;
      if (2 * used < limit_) rows_at_once_ = std::min(2 * rows_at_once_, 1 << 14);
    } else if (used <= limit_) {
      capacity_ = std::min(limit_, used + used / 4);
    } else if (rows > 1) {
      capacity_ = limit_;
      // A quarter of room: fragments are not spread evenly over the rows.
      const double share = 0.75 * static_cast<double>(limit_) / static_cast<double>(used);
      rows_at_once_ = std::max(1, static_cast<int>(share * rows));
    } else {
      glDisable(GL_SCISSOR_TEST);
      throw GraphicsError("exact order: a row of " + std::to_string(width_) + " samples has " + std::to_string(used) +
                          " fragments, this driver holds " + std::to_string(limit_) +
                          ": use a smaller --size or another --order");
    }
  }
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace pelage
