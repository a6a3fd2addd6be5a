#include "pelage/render/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <vector>

#include "pelage/data_schema/errors.h"

namespace pelage {

struct HeadlessContext::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

namespace {

std::vector<EGLDisplay> candidate_displays() {
  std::vector<EGLDisplay> displays;
  const char* const client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (client == nullptr) return {eglGetDisplay(EGL_DEFAULT_DISPLAY)};
  const auto has = [&](const char* name) { return epoxy_extension_in_string(client, name); };
  if (has("EGL_EXT_platform_base") && has("EGL_EXT_device_enumeration") && has("EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
      for (EGLint i = 0; i < count; ++i) {
        displays.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
      }
    }
  }
  if (has("EGL_MESA_platform_surfaceless")) {
    displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  return displays;
}

/// A current 4.3 core context on this display, or EGL_NO_CONTEXT and the reason.
EGLContext context_on(EGLDisplay display, std::string& why) {
  EGLint major = 0, minor = 0;
  if (display == EGL_NO_DISPLAY || eglInitialize(display, &major, &minor) != EGL_TRUE) {
    why += " eglInitialize failed;";
    return EGL_NO_CONTEXT;
  }
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
    why += " no desktop OpenGL;";
    eglTerminate(display);
    return EGL_NO_CONTEXT;
  }
  constexpr std::array<EGLint, 7> kAttributes{
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
  if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE)
    return context;
  why += " no OpenGL 4.3 core context;";
  if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  eglTerminate(display);
  return EGL_NO_CONTEXT;
}

}  // namespace

HeadlessContext::HeadlessContext() : handles_(std::make_unique<Handles>()) {
  std::string why;
  for (const EGLDisplay display : candidate_displays()) {
    handles_->context = context_on(display, why);
    if (handles_->context == EGL_NO_CONTEXT) continue;
    handles_->display = display;
    return;
  }
  throw GraphicsError("no headless OpenGL:" + (why.empty() ? " no EGL platform;" : why) +
                      " install libegl1 and libgl1-mesa-dri (software rendering needs no GPU)");
}

HeadlessContext::~HeadlessContext() {
  eglMakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(handles_->display, handles_->context);
  eglTerminate(handles_->display);
}

std::string opengl_description() {
  const auto text = [](GLenum name) {
    const GLubyte* const s = glGetString(name);
    return s == nullptr ? std::string("unknown") : std::string(reinterpret_cast<const char*>(s));
  };
  return text(GL_VERSION) + ", " + text(GL_RENDERER);
}

void require_opengl_43() {
  if (epoxy_gl_version() >= 43) return;
  throw GraphicsError("OpenGL 4.3 is needed, this is " + opengl_description() +
                      "; update the driver, or use Mesa's software "
                      "renderer (LIBGL_ALWAYS_SOFTWARE=1)");
}

}  // namespace pelage
