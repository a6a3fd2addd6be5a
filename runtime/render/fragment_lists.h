// Exact order of transparent fragments: every pixel keeps a linked list, which is then blended by depth [Xu2006 eq.
// 14].
//
// Memory is bounded: lists grow to the driver's largest storage block (at most kMostListBytes); where a target needs
// more it is drawn in strips of rows. No fragment is dropped: the resolving pass takes the nearest ones in batches
// until the list ends or less than 2^-12 of what is behind shines through. Fragments of equal depth are ordered by
// their colours, so that the picture does not depend on the order of drawing.
#pragma once

#include <cstddef>
#include <functional>

#include "pelage/render/gl_objects.h"

namespace pelage {

class FragmentLists {
 public:
  static constexpr std::size_t kMostListBytes = std::size_t{512} << 20;
  /// Defines of a program whose fragment shader ends in common_output.glsl's put_fragment().
  static constexpr const char* kDefine = "#define PELAGE_PER_PIXEL_LISTS";

  /// @param most_bytes  of the lists; tests make it small
  explicit FragmentLists(std::size_t most_bytes = kMostListBytes);

  /// Blends what `draw` draws over the target, which is bound, with its depth test. `draw` uses a program made with
  /// kDefine, calls bind() for it, and is called at least once for each strip.
  /// @throws GraphicsError when one row of the target has more fragments than fit
  void blend(Framebuffer& target, const std::function<void()>& draw);
  void bind(const Program& program) const;

 private:
  std::size_t fill(int first_row, int rows, const std::function<void()>& draw);
  void resolve();

  Program resolve_{"screen.vert", "hair_list_resolve.frag"};
  VertexArray array_;
  Buffer fragments_, heads_;
  std::size_t limit_, capacity_;  // fragments
  int width_ = 0, rows_at_once_ = 1 << 14;
};

}  // namespace pelage
