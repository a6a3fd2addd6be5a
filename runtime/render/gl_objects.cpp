#include "pelage/render/gl_objects.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "pelage/data_schema/errors.h"
#include "shader_sources.h"

namespace pelage {
namespace {

const std::map<std::string_view, std::string_view>& embedded_shaders() {
  static const std::map<std::string_view, std::string_view> files{
      {"common_depth_map.glsl", shaders::common_depth_map_glsl},
      {"common_head.glsl", shaders::common_head_glsl},
      {"common_lights.glsl", shaders::common_lights_glsl},
      {"common_lobes.glsl", shaders::common_lobes_glsl},
      {"common_output.glsl", shaders::common_output_glsl},
      {"hair_surface.vert", shaders::hair_surface_vert},
      {"hair_surface.frag", shaders::hair_surface_frag},
      {"hair_list_resolve.frag", shaders::hair_list_resolve_frag},
      {"head.vert", shaders::head_vert},
      {"head.frag", shaders::head_frag},
      {"screen.vert", shaders::screen_vert},
      {"downsample.frag", shaders::downsample_frag},
      {"present.frag", shaders::present_frag},
      {"strands.vert", shaders::strands_vert},
      {"strands.frag", shaders::strands_frag},
      {"weighted_resolve.frag", shaders::weighted_resolve_frag},
      {"test_twins.comp", shaders::test_twins_comp}};
  return files;
}

std::string shader_text(std::string_view file) {
  if (const char* const folder = std::getenv("PELAGE_SHADER_DIR")) {
    std::ifstream in(std::string(folder) + "/" + std::string(file));
    if (!in) throw GraphicsError("PELAGE_SHADER_DIR: cannot read " + std::string(folder) + "/" + std::string(file));
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  const auto it = embedded_shaders().find(file);
  if (it == embedded_shaders().end()) throw GraphicsError("no embedded shader is called " + std::string(file));
  return std::string(it->second);
}

struct ShaderSource {
  std::string text;
  std::string files;  // "0 = hair_surface.frag, 1 = common_lobes.glsl": what the compiler's source numbers mean
};

/// The file with its includes in place (one level; shared blocks include nothing) and the defines after #version.
/// Lines keep the numbers that they have in their files.
ShaderSource resolved_source(std::string_view file, std::string_view defines) {
  std::istringstream in{shader_text(file)};
  ShaderSource out{"", "0 = " + std::string(file)};
  std::string line;
  int included = 0;
  for (int number = 1; std::getline(in, line); ++number) {
    constexpr std::string_view kInclude = "#include \"";
    const std::string back = "#line " + std::to_string(number + 1) + " 0\n";
    if (line.starts_with(kInclude)) {
      const std::string name = line.substr(kInclude.size(), line.rfind('"') - kInclude.size());
      const std::string index = std::to_string(++included);
      out.files += ", " + index + " = " + name;
      out.text += "#line 1 " + index + "\n" + shader_text(name) + "\n" + back;
    } else {
      out.text += line + "\n";
    }
    if (line.starts_with("#version")) out.text += std::string(defines) + "\n" + back;
  }
  return out;
}

}  // namespace

void Buffer::upload_bytes(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
  glBindBuffer(target, id_);
  if (bytes == bytes_ && data != nullptr) {
    glBufferSubData(target, 0, static_cast<GLsizeiptr>(bytes), data);
  } else if (bytes != bytes_) {
    glBufferData(target, static_cast<GLsizeiptr>(bytes), data, usage);
  }
  bytes_ = bytes;
}

Program::Program(std::string_view vertex, std::string_view fragment, std::string_view defines)
    : id_(glCreateProgram()) {
  attach(GL_VERTEX_SHADER, vertex, defines);
  attach(GL_FRAGMENT_SHADER, fragment, defines);
  link();
}

Program::Program(std::string_view compute) : id_(glCreateProgram()) {
  attach(GL_COMPUTE_SHADER, compute, "");
  link();
}

void Program::attach(GLenum stage, std::string_view file, std::string_view defines) {
  const ShaderSource resolved = resolved_source(file, defines);
  const char* const source = resolved.text.c_str();
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good != GL_TRUE) {
    std::vector<char> log(8192, '\0');
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glDeleteShader(shader);
    glDeleteProgram(id_);
    throw GraphicsError("shaders/" + std::string(file) + " does not compile on " +
                        reinterpret_cast<const char*>(glGetString(GL_RENDERER)) + " (sources: " + resolved.files +
                        "):\n" + log.data());
  }
  glAttachShader(id_, shader);
  glDeleteShader(shader);
}

void Program::link() {
  glLinkProgram(id_);
  GLint good = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return;
  std::vector<char> log(8192, '\0');
  glGetProgramInfoLog(id_, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteProgram(id_);
  throw GraphicsError(std::string("a shader program does not link:\n") + log.data());
}

Framebuffer::Framebuffer(int width, int height, GLenum format, bool with_depth) : width_(width), height_(height) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (width < 1 || height < 1 || width > most || height > most) {
    throw GraphicsError("a target of " + std::to_string(width) + " x " + std::to_string(height) +
                        " pixels is outside 1 to " + std::to_string(most));
  }
  glGenFramebuffers(1, &id_);
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glGenTextures(1, &colour_);
  glBindTexture(GL_TEXTURE_2D, colour_);
  glTexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_, 0);
  if (with_depth) {
    glGenRenderbuffers(1, &depth_);
    glBindRenderbuffer(GL_RENDERBUFFER, depth_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw GraphicsError("the driver refuses a floating-point target of " + std::to_string(width) + " x " +
                        std::to_string(height));
  }
}

Framebuffer::~Framebuffer() {
  glDeleteFramebuffers(1, &id_);
  glDeleteTextures(1, &colour_);
  glDeleteRenderbuffers(1, &depth_);
}

void Framebuffer::bind() const noexcept {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glViewport(0, 0, width_, height_);
}

void check_opengl(const char* step) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  const char* const name = error == GL_OUT_OF_MEMORY       ? "out of memory"
                           : error == GL_INVALID_OPERATION ? "invalid operation"
                           : error == GL_CONTEXT_LOST      ? "context lost"
                                                           : "error";
  throw GraphicsError(std::string("OpenGL reports ") + name + " (" + std::to_string(error) + ") after " + step);
}

}  // namespace pelage
