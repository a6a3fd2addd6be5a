// A window with an OpenGL 4.3 context and the mouse and keys that the viewer needs. GLFW stays behind this header.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

namespace pelage {

class Window {
 public:
  /// Opens the window and makes its context current. @throws GraphicsError with a hint where there is no display
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// What happened since the last poll.
  struct Input {
    glm::vec2 drag{0.0F};        // left button [pixels]
    glm::vec2 light_drag{0.0F};  // right button, or left with Shift [pixels]
    float scroll = 0.0F;         // notches
    std::vector<char> keys;      // upper-case letters, digits and ' ' that were pressed
  };
  Input poll();

  bool should_close() const noexcept;
  glm::ivec2 size() const noexcept;  ///< of the framebuffer [pixels], at least 1 x 1
  void set_title(const std::string& title) noexcept;
  void swap() noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelage
