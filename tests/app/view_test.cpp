// `pelage view` without a display, and under a virtual one.
#include <gmock/gmock.h>

#include "child.h"

namespace pelage::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<std::string> view(const std::string& frames) {
  return {"view", kExamples + "lock.scene.json", "--size", "64x48", "--bake-sectors", "60", "--frames", frames};
}

TEST(View, WithoutADisplayExitsFiveWithAHint) {
  const TemporaryFolder folder;
  const Result result = run(folder, view("1"), {"DISPLAY", "WAYLAND_DISPLAY"});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("no display"), HasSubstr("pelage render"), HasSubstr("xvfb-run")));
}

class ViewBy : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, ViewBy, ::testing::Values("satf", "density-map"));

TEST_P(ViewBy, DrawsFramesAndCloses) {
  if (std::system("command -v xvfb-run > /dev/null 2>&1") != 0) GTEST_SKIP() << "no xvfb-run";
  const TemporaryFolder folder;
  std::vector<std::string> arguments = view("3");
  arguments.insert(arguments.end(), {"--method", GetParam()});
  arguments.insert(arguments.begin(), {"-a", "-s", "-screen 0 640x480x24", PELAGE_PROGRAM});
  const Result result = Child(folder, arguments, {}, "xvfb-run").wait();
  EXPECT_EQ(result.code, 0) << result.err;
}

}  // namespace
}  // namespace pelage::test
