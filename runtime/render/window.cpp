#include "pelage/render/window.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/render/gl_context.h"

namespace pelage {

struct Window::State {
  GLFWwindow* window = nullptr;
  Input input;
  glm::vec2 cursor{0.0F};

  static State& of(GLFWwindow* w) { return *static_cast<State*>(glfwGetWindowUserPointer(w)); }
};

namespace {

std::string glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "unknown reason" : text;
}

}  // namespace

Window::Window(int width, int height, const std::string& title) : state_(std::make_unique<State>()) {
  const char* const hint = "; `pelage render` needs no display, or use xvfb-run for a virtual one";
  if (glfwInit() != GLFW_TRUE) throw GraphicsError("no display (" + glfw_error() + ")" + hint);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  state_->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (state_->window == nullptr) {
    const std::string why = glfw_error();
    glfwTerminate();
    throw GraphicsError("no window with OpenGL 4.3 (" + why + ")" + hint);
  }
  glfwMakeContextCurrent(state_->window);
  require_opengl_43();
  glfwSetWindowUserPointer(state_->window, state_.get());
  glfwSetScrollCallback(state_->window,
                        [](GLFWwindow* w, double, double y) { State::of(w).input.scroll += static_cast<float>(y); });
  glfwSetKeyCallback(state_->window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(w, GLFW_TRUE);
    if (key >= ' ' && key <= 'Z') State::of(w).input.keys.push_back(static_cast<char>(key));
  });
  glfwSetCursorPosCallback(state_->window, [](GLFWwindow* w, double x, double y) {
    State& s = State::of(w);
    const glm::vec2 now{static_cast<float>(x), static_cast<float>(y)};
    const bool shift = glfwGetKey(w, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
    const bool left = glfwGetMouseButton(w, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
    const bool right = glfwGetMouseButton(w, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
    if (right || (left && shift))
      s.input.light_drag += now - s.cursor;
    else if (left)
      s.input.drag += now - s.cursor;
    s.cursor = now;
  });
}

Window::~Window() {
  glfwDestroyWindow(state_->window);
  glfwTerminate();
}

Window::Input Window::poll() {
  glfwPollEvents();
  return std::exchange(state_->input, Input{});
}

bool Window::should_close() const noexcept {
  return glfwWindowShouldClose(state_->window) == GLFW_TRUE;
}

glm::ivec2 Window::size() const noexcept {
  glm::ivec2 size{1};
  glfwGetFramebufferSize(state_->window, &size.x, &size.y);
  return {std::max(size.x, 1), std::max(size.y, 1)};
}

void Window::set_title(const std::string& title) noexcept {
  glfwSetWindowTitle(state_->window, title.c_str());
}

void Window::swap() noexcept {
  glfwSwapBuffers(state_->window);
}

}  // namespace pelage
