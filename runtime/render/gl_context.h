// A headless OpenGL 4.3+ core context through EGL: surfaceless Mesa first (software or GPU), then EGL devices (vendors'
// drivers without a display). Without a default framebuffer: draw into framebuffer objects and set the viewport.
#pragma once

#include <memory>
#include <string>

namespace pelage {

class HeadlessContext {
 public:
  /// Creates the context and makes it current. @throws GraphicsError saying what was tried and what to install
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

/// GL_VERSION and GL_RENDERER of the current context.
std::string opengl_description();

/// @throws GraphicsError when the current context is older than 4.3
void require_opengl_43();

}  // namespace pelage
