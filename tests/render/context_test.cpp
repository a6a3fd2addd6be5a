// OpenGL itself: a context without a display, shaders that do not compile, targets that are too large (hard case 30).
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "../data_schema/temporary.h"
#include "fixture.h"
#include "pelage/render/gl_objects.h"
#include "pelage/render/strand_frame.h"

namespace pelage {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class Context : public test::WithOpenGl {};

TEST_F(Context, IsModernAndRendersWithoutADisplay) {
  EXPECT_NO_THROW(require_opengl_43());
  EXPECT_FALSE(opengl_description().empty());
  Framebuffer target(3, 2, GL_RGBA32F, true);
  target.bind();
  glClearColor(0.25F, 0.5F, 1, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  float pixel[4] = {};
  glReadPixels(2, 1, 1, 1, GL_RGBA, GL_FLOAT, pixel);
  EXPECT_EQ(pixel[1], 0.5F);
  EXPECT_NO_THROW(check_opengl("clearing"));
}

TEST_F(Context, CanBeMadeAgain) {
  for (int i = 0; i < 3; ++i) {
    const HeadlessContext another;
    const Renderer renderer;
  }
}

TEST_F(Context, RefusesTargetsOutOfRange) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  for (const auto& [w, h] : {std::pair(0, 1), std::pair(1, -1), std::pair(most + 1, 1), std::pair(1, most + 1)}) {
    EXPECT_THAT(message_of<GraphicsError>([&] { Framebuffer(w, h, GL_RGBA16F, true); }),
                HasSubstr("is outside 1 to " + std::to_string(most)));
  }
}

TEST_F(Context, ReportsOpenGlErrorsByStep) {
  glEnable(GL_INVALID_ENUM);
  EXPECT_THAT(message_of<GraphicsError>([] { check_opengl("a wrong call"); }), HasSubstr("after a wrong call"));
}

TEST_F(Context, TheLargestTargetIsMadeOrRefused) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  const int side = std::min(most, 16384);
  try {
    const Framebuffer target(side, side, GL_R8, false);  // 256 MiB; in colour with depth, 3 GiB
    target.bind();
    GLint viewport[4] = {};
    glGetIntegerv(GL_VIEWPORT, viewport);
    EXPECT_EQ(viewport[2], side);
    EXPECT_EQ(viewport[3], side);
    check_opengl("making it");
  } catch (const GraphicsError& error) {  // memory that the driver does not have
    EXPECT_THAT(error.what(),
                AnyOf(HasSubstr(std::to_string(side) + " x " + std::to_string(side)), HasSubstr("out of memory")));
  }
  while (glGetError() != GL_NO_ERROR) {
  }
  Framebuffer(4, 4, GL_RGBA16F, true).bind();
  EXPECT_NO_THROW(check_opengl("a small one after it"));
}

/// While it lives, glGetError answers as a driver does that has lost the context (a reset of the GPU, or its memory).
class LostOpenGl {
 public:
  LostOpenGl() : real_(glGetError) {
    glGetError = []() -> GLenum { return GL_CONTEXT_LOST; };
  }
  ~LostOpenGl() { glGetError = real_; }
  LostOpenGl(const LostOpenGl&) = delete;
  LostOpenGl& operator=(const LostOpenGl&) = delete;

 private:
  decltype(glGetError) real_;
};

TEST_F(Context, LostInAPictureIsAnErrorNotAPicture) {
  const auto frame = test::frame_of(test::straight_lock());
  const FrameSettings settings = test::front_view();
  const Image before = frame->render(settings, 24, 24, 1);
  Strands strand;
  strand.diameter_m = 1e-3F;
  strand.append(std::vector<glm::vec3>{{0, 0.1F, 0}, {0, 0, 0}, {0, -0.1F, 0}});
  StrandFrame strands(strand, 0.6F, {});
  StrandFrameSettings of_strands;
  of_strands.camera = settings.camera;
  of_strands.lights = settings.lights;
  const Image strands_before = strands.render(of_strands, 24, 24, 1);
  {
    const LostOpenGl lost;
    EXPECT_THAT(message_of<GraphicsError>([&] { frame->render(settings, 24, 24, 1); }),
                AllOf(HasSubstr("context lost"), HasSubstr("after drawing")));
    EXPECT_THAT(message_of<GraphicsError>([&] { strands.render(of_strands, 24, 24, 1); }), HasSubstr("context lost"));
    EXPECT_THAT(message_of<GraphicsError>([] { Renderer(); }), HasSubstr("context lost"));
  }
  EXPECT_EQ(frame->render(settings, 24, 24, 1).rgba, before.rgba) << "what failed leaves nothing behind";
  EXPECT_EQ(strands.render(of_strands, 24, 24, 1).rgba, strands_before.rgba);
}

/// A folder with copies of all shaders, set as PELAGE_SHADER_DIR while it lives.
class ShaderFolder {
 public:
  ShaderFolder() {
    for (const auto& entry : std::filesystem::directory_iterator(PELAGE_SOURCE_DIR "/shaders"))
      std::filesystem::copy(entry.path(), folder_ / entry.path().filename().string());
    setenv("PELAGE_SHADER_DIR", (folder_ / "").c_str(), 1);
  }
  ~ShaderFolder() { unsetenv("PELAGE_SHADER_DIR"); }
  ShaderFolder(const ShaderFolder&) = delete;
  ShaderFolder& operator=(const ShaderFolder&) = delete;

  /// Puts a line that does not compile before line `line` (1-based).
  void damage(const std::string& name, int line) {
    std::istringstream in(test::text_of(folder_ / name));
    std::string text, each;
    for (int i = 1; std::getline(in, each); ++i) {
      if (i == line) text += "this is no GLSL;\n";
      text += each + "\n";
    }
    folder_.write(name, text);
  }
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Context, ShaderThatDoesNotCompileNamesFileAndLine) {
  ShaderFolder folder;
  EXPECT_NO_THROW(Renderer());
  folder.damage("head.frag", 5);
  // Compilers write "0:5" or "0(5)".
  EXPECT_THAT(message_of<GraphicsError>([] { Renderer(); }),
              AllOf(HasSubstr("shaders/head.frag does not compile"), ContainsRegex("0[:(]5")));
}

TEST_F(Context, LinesCountInTheFileThatIsWrong) {
  // An include and the lines of #define before it do not move the numbers of the file around them.
  ShaderFolder folder;
  folder.damage("hair_surface.frag", 20);
  EXPECT_THAT(message_of<GraphicsError>([] { Renderer(); }),
              AllOf(HasSubstr("hair_surface.frag"), ContainsRegex("0[:(]20")));
}

TEST_F(Context, ErrorInASharedBlockNamesTheBlock) {
  ShaderFolder folder;
  folder.damage("common_lobes.glsl", 7);
  EXPECT_THAT(message_of<GraphicsError>([] { Renderer(); }),
              AllOf(HasSubstr("common_lobes.glsl"), ContainsRegex("1[:(]7")));
}

TEST_F(Context, MissingShaderFileIsNamed) {
  const ShaderFolder folder;
  std::filesystem::remove(folder.file("head.vert"));
  EXPECT_THAT(message_of<GraphicsError>([] { Renderer(); }), AllOf(HasSubstr("cannot read"), HasSubstr("head.vert")));
}

}  // namespace
}  // namespace pelage
