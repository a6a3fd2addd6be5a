// Owners of OpenGL objects: buffers, programs, framebuffers. Need a current context for their whole life.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace pelage {

class Buffer {
 public:
  Buffer() { glGenBuffers(1, &id_); }
  ~Buffer() { glDeleteBuffers(1, &id_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  GLuint id() const noexcept { return id_; }
  std::size_t bytes() const noexcept { return bytes_; }

  /// Replaces the content; storage is kept when the size does not change.
  template <class T>
  void upload(GLenum target, std::span<const T> data, GLenum usage) {
    upload_bytes(target, data.data(), data.size_bytes(), usage);
  }
  void allocate(GLenum target, std::size_t bytes, GLenum usage) { upload_bytes(target, nullptr, bytes, usage); }

 private:
  void upload_bytes(GLenum target, const void* data, std::size_t bytes, GLenum usage);
  GLuint id_ = 0;
  std::size_t bytes_ = 0;
};

class VertexArray {
 public:
  VertexArray() { glGenVertexArrays(1, &id_); }
  ~VertexArray() { glDeleteVertexArrays(1, &id_); }
  VertexArray(const VertexArray&) = delete;
  VertexArray& operator=(const VertexArray&) = delete;
  GLuint id() const noexcept { return id_; }

 private:
  GLuint id_ = 0;
};

/// A linked program of embedded shaders (or files of PELAGE_SHADER_DIR), with #include "file" resolved.
class Program {
 public:
  /// @param defines  lines put after #version, e.g. "#define X"
  /// @throws GraphicsError with file name and the compiler's log
  Program(std::string_view vertex, std::string_view fragment, std::string_view defines = "");
  explicit Program(std::string_view compute);
  ~Program() { glDeleteProgram(id_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  GLuint id() const noexcept { return id_; }
  GLint at(const char* uniform) const noexcept { return glGetUniformLocation(id_, uniform); }

 private:
  void attach(GLenum stage, std::string_view file, std::string_view defines);
  void link();
  GLuint id_;
};

/// Colour (and depth) target.
class Framebuffer {
 public:
  /// @param format  GL_RGBA16F or GL_RGBA32F    @throws GraphicsError when it is too large or incomplete
  Framebuffer(int width, int height, GLenum format, bool with_depth);
  ~Framebuffer();
  Framebuffer(const Framebuffer&) = delete;
  Framebuffer& operator=(const Framebuffer&) = delete;
  void bind() const noexcept;  ///< also sets the viewport
  GLuint colour() const noexcept { return colour_; }
  GLuint depth() const noexcept { return depth_; }  ///< renderbuffer, 0 without depth
  int width() const noexcept { return width_; }
  int height() const noexcept { return height_; }

 private:
  GLuint id_ = 0, colour_ = 0, depth_ = 0;
  int width_, height_;
};

/// @throws GraphicsError naming the step when OpenGL reports an error
void check_opengl(const char* step);

}  // namespace pelage
