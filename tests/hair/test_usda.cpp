// USD text: units and axes of the stage, interpolations of widths, the bases against their definitions, the tree around
// the curves, and the names that are written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "../data_schema/temporary.h"
#include "format_fixtures.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_file.h"

namespace pelage::hair {
namespace {

using test::bytes_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Strands read(const std::string& text, ReadReport* report = nullptr, ReadOptions options = {}) {
  return parse_hair(bytes_of(text), "x.usda", options, report);
}

std::string refusal(const std::string& text) {
  return test::message_of<InputError>([&] { read(text); });
}

/// A prim in a stage of metres.
std::string curves(const std::string& body) {
  return "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"c\"\n{\n" + body + "}\n";
}

/// Control points on a line, unevenly spaced.
std::string line(int n) {
  std::string text = "int[] curveVertexCounts = [" + std::to_string(n) + "]\npoint3f[] points = [";
  for (int k = 0; k < n; ++k) text += "(0, " + std::to_string(0.1 * k + 0.01 * k * k) + ", 0), ";
  return text + "]\n";
}
float at(int k) {
  return std::stof(std::to_string(0.1 * k + 0.01 * k * k));
}

TEST(Usda, ObeysTheUnitAndAxisOfTheStage) {
  std::string text = test::kUsdaText;
  text.replace(text.find("0.5\n"), 3, "0.01");
  text.replace(text.find("\"Y\""), 3, "\"Z\"");
  const Strands s = read(text, nullptr, {.check_unit = false});
  EXPECT_NEAR(s.vertices[0].z, -0.02F, 1e-9F);
  EXPECT_EQ(s.vertices[0].y, 0.0F);
  ReadReport report;
  read(text, &report, {.metres_per_unit = 0.001, .up = UpAxis::x, .curve = Curve::b_spline, .check_unit = false});
  EXPECT_EQ(report.metres_per_unit, 0.01);
  EXPECT_THAT(report.notes, testing::IsSupersetOf({HasSubstr("--unit ignored"), HasSubstr("--up ignored"),
                                                   HasSubstr("--curve ignored")}));
  EXPECT_THAT(refusal(text), HasSubstr("correct it there"));  // 3 mm of hair
}

TEST(Usda, TheOptionsSayWhatTheStageDoesNot) {
  const std::string text =
      "#usda 1.0\ndef BasisCurves \"c\" {\nuniform token type = \"linear\"\n"
      "int[] curveVertexCounts = [2]\npoint3f[] points = [(0, 0, 10), (0, 0, 20)]\n}\n";
  EXPECT_THAT(refusal(text), HasSubstr("--unit cm"));
  const Strands s = read(text, nullptr, {.metres_per_unit = 0.01, .up = UpAxis::z});
  EXPECT_FLOAT_EQ(s.vertices[1].y, 0.2F);
}

TEST(Usda, WidthsOfEveryInterpolation) {
  const std::string points =
      "uniform token type = \"linear\"\nint[] curveVertexCounts = [2, 3]\n"
      "point3f[] points = [(0,0,0), (0,.1,0), (1,0,0), (1,.1,0), (1,.2,0)]\n";
  const auto widths = [&](const std::string& values, const std::string& interpolation) {
    return read(
        curves(points + "float[] widths = [" + values + "] (\n interpolation = \"" + interpolation + "\"\n)\n"));
  };
  EXPECT_EQ(widths("1e-4", "constant").diameter_m, 1e-4F);
  EXPECT_EQ(widths("1e-4, 2e-4", "uniform").diameters_m, (std::vector<float>{1e-4F, 1e-4F, 2e-4F, 2e-4F, 2e-4F}));
  const std::vector<float> each{1e-4F, 2e-4F, 3e-4F, 4e-4F, 5e-4F};
  EXPECT_EQ(widths("1e-4, 2e-4, 3e-4, 4e-4, 5e-4", "vertex").diameters_m, each);
  EXPECT_EQ(widths("1e-4, 2e-4, 3e-4, 4e-4, 5e-4", "varying").diameters_m, each);
  EXPECT_EQ(read(curves(points + "float[] widths = [1e-4, 2e-4, 3e-4, 4e-4, 5e-4]\n")).diameters_m, each);
  ReadReport report;  // one value, and no word: the fallback is vertex, which does not fit
  EXPECT_EQ(read(curves(points + "float[] widths = [1e-4]\n"), &report).diameter_m, 1e-4F);
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("widths taken as constant")));
  EXPECT_EQ(read(curves(points + "float[] widths = [1, 2, 3, 4]\n"), &report).diameter_m, 0.0F);
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("widths ignored")));
  const Strands primvar = read(curves(points + "float[] widths = [1e-4]\nfloat[] primvars:widths = [3e-4]\n"));
  EXPECT_EQ(primvar.diameter_m, 3e-4F);  // the primvar goes first, its fallback is constant
}

TEST(Usda, ColoursAndOpacity) {
  const std::string points =
      "uniform token type = \"linear\"\nint[] curveVertexCounts = [2, 2]\n"
      "point3f[] points = [(0,0,0), (0,.1,0), (1,0,0), (1,.1,0)]\n";
  const auto colours = [&](const std::string& declaration) { return read(curves(points + declaration)).colours; };
  const glm::vec3 a(0.25F, 0.5F, 1), b(0.75F, 0.5F, 1);
  EXPECT_EQ(colours("color3f[] primvars:displayColor = [(.25, .5, 1)]\n"), (std::vector<glm::vec3>{a, a}));
  EXPECT_EQ(colours("color3f[] primvars:displayColor = [(.25, .5, 1), (.75, .5, 1)] (interpolation = \"uniform\")\n"),
            (std::vector<glm::vec3>{a, b}));
  EXPECT_EQ(colours("float3[] primvars:groom_color = [(0, 0, 1), (.5, 1, 1), (.75, .5, 1), (.75, .5, 1)] "
                    "(interpolation = \"vertex\")\n"),
            (std::vector<glm::vec3>{a, b}));
  EXPECT_THAT(colours("color3f[] primvars:displayColor = [(.25, .5, 1)]\nint[] primvars:displayColor:indices = [0]\n"),
              IsEmpty());
  ReadReport report;
  read(curves(points + "float[] primvars:displayOpacity = [0.5]\n"), &report);
  EXPECT_EQ(report.opacity, 0.5F);
}

/// The four basis functions of a span at parameter u, from the defining matrices.
glm::dvec4 weights(const std::string& basis, double u) {
  const double v = 1 - u;
  if (basis == "bezier") return {v * v * v, 3 * u * v * v, 3 * u * u * v, u * u * u};
  if (basis == "bspline")
    return glm::dvec4(1 - 3 * u + 3 * u * u - u * u * u, 4 - 6 * u * u + 3 * u * u * u,
                      1 + 3 * u + 3 * u * u - 3 * u * u * u, u * u * u) /
           6.0;
  return glm::dvec4(-u + 2 * u * u - u * u * u, 2 - 5 * u * u + 3 * u * u * u, u + 4 * u * u - 3 * u * u * u,
                    -u * u + u * u * u) /
         2.0;
}

TEST(Usda, EvaluatesEveryBasis) {
  for (const std::string basis : {"bezier", "bspline", "catmullRom"}) {
    const Strands s = read(curves("uniform token basis = \"" + basis + "\"\n" + line(7)));
    const int step = basis == "bezier" ? 3 : 1, spans = basis == "bezier" ? 2 : 4;
    ASSERT_EQ(s.vertices.size(), 14U) << basis;
    for (int k = 0; k < 14; ++k) {
      const double x = k * spans / 13.0;
      const int span = std::min(static_cast<int>(x), spans - 1);
      const glm::dvec4 w = weights(basis, x - span);
      double y = 0;
      for (int i = 0; i < 4; ++i) y += w[i] * static_cast<double>(at(step * span + i));
      EXPECT_NEAR(static_cast<double>(s.vertices[static_cast<std::size_t>(k)].y), y, 5e-7) << basis << " " << k;
    }
  }
}

TEST(Usda, BezierIsTheFallbackAndPinnedReachesTheEnds) {
  const Strands s = read(curves(line(4)));
  EXPECT_EQ(s.vertices.front().y, at(0));
  EXPECT_EQ(s.vertices.back().y, at(3));
  for (const std::string basis : {"bspline", "catmullRom"}) {
    for (const int n : {2, 3, 5}) {
      const Strands p =
          read(curves("uniform token basis = \"" + basis + "\"\nuniform token wrap = \"pinned\"\n" + line(n)));
      ASSERT_EQ(p.vertices.size(), 2U * static_cast<unsigned>(n + 2));
      EXPECT_NEAR(p.vertices.front().y, at(0), 1e-7F) << basis << n;
      EXPECT_NEAR(p.vertices.back().y, at(n - 1), 1e-7F) << basis << n;
    }
  }
}

TEST(Usda, BSplineAgreesWithTheCurveOptionOfOtherFormats) {
  test::Bytes hair = test::hair_header(1, 5, 2, 4);
  for (int k = 0; k < 5; ++k) test::append_point(hair, 0, at(k), 0);
  EXPECT_EQ(read(curves("uniform token basis = \"bspline\"\n" + line(5))).vertices,
            parse_hair(hair, "x.hair", {.curve = Curve::b_spline}).vertices);
}

TEST(Usda, VaryingWidthsOfCurvesAreLinearAlongTheSpans) {
  const Strands s = read(curves(line(7) + "float[] widths = [1e-4, 3e-4, 2e-4] (interpolation = \"varying\")\n"));
  ASSERT_EQ(s.diameters_m.size(), 14U);
  EXPECT_EQ(s.diameters_m.front(), 1e-4F);
  EXPECT_EQ(s.diameters_m.back(), 2e-4F);
  EXPECT_NEAR(s.diameters_m[3], 1e-4 + 2e-4 * 6 / 13, 1e-10);
  EXPECT_NEAR(s.diameters_m[10], 3e-4 - 1e-4 * 7 / 13, 1e-10);
}

TEST(Usda, ShortAndRaggedCubicCurvesAreRepaired) {
  ReadReport report;
  EXPECT_EQ(read(curves(line(3)), &report).vertices.size(), 3U);  // no span: a polyline
  EXPECT_THAT(report.issues, IsEmpty());
  EXPECT_EQ(read(curves(line(6)), &report).vertices.size(), 8U);  // one span of four, two over
  ASSERT_EQ(report.repaired(), 1U);
  EXPECT_THAT(report.issues[0].reason, HasSubstr("2 control points"));
}

TEST(Usda, TakesTheCurvesOfAllPrimsAndNothingElse) {
  const std::string body =
      "{ uniform token type = \"linear\"\n int[] curveVertexCounts = [2]\n"
      "point3f[] points = [(0,0,0), (0,.1,0)]\n";
  const std::string text =
      "#usda 1.0\n(metersPerUnit = 1)\ndef Scope \"s\" {\n variantSet \"v\" = { \"a\" { def BasisCurves \"n\" " + body +
      "} } }\n class BasisCurves \"k\" " + body + "}\n def Camera \"cam\" { matrix4d xformOp:transform = ((1)) }\n" +
      " over BasisCurves \"a\" " + body +
      "float[] widths = [1e-4] (interpolation = \"constant\") }\n}\ndef BasisCurves \"b\" " + body + "}\n";
  ReadReport report;
  const Strands s = read(text, &report);
  EXPECT_EQ(s.count(), 2U);
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("variants ignored")));  // the camera's transform is no concern
  EXPECT_EQ(report.repaired(), 1U);                                       // b has no widths: the mean of a's
  EXPECT_EQ(s.diameter_m, 1e-4F);
}

TEST(Usda, PrimsThatSayLessAreRepairedFromTheOthersInAnyOrder) {
  const std::string body =
      "{ uniform token type = \"linear\"\n int[] curveVertexCounts = [2]\n"
      "point3f[] points = [(0,0,0), (0,.1,0)]\n";
  const std::string rich = "def BasisCurves \"r\" " + body +
                           "color3f[] primvars:displayColor = [(.25, .5, 1)]\n"
                           "float[] widths = [0.0001220703125, 0.0003662109375] }\n";
  const std::string poor = "def BasisCurves \"p\" " + body + "}\n";
  for (const std::string& text : {rich + poor + poor, poor + rich + poor, poor + poor + rich}) {
    ReadReport report;
    const Strands s = read("#usda 1.0\n(metersPerUnit = 1)\n" + text, &report);
    EXPECT_EQ(s.colours, std::vector<glm::vec3>(3, glm::vec3(0.25F, 0.5F, 1)));
    std::vector<float> diameters = s.diameters_m;
    std::sort(diameters.begin(), diameters.end());
    constexpr float d = 1.0F / 8192;  // exact, and so is the mean
    EXPECT_EQ(diameters, (std::vector<float>{d, 2 * d, 2 * d, 2 * d, 2 * d, 3 * d}));
    EXPECT_EQ(report.repaired(), 4U);  // two strands, twice
  }
}

TEST(Usda, ValuesStayWithThePrimThatHasThem) {
  const auto prim = [](const char* x, const std::string& values) {
    const std::string p = std::string("(") + x;
    return "def BasisCurves \"c\" { uniform token type = \"linear\"\nint[] curveVertexCounts = [2]\npoint3f[] points = "
           "[" +
           p + ",0,0), " + p + ",.1,0)]\n" + values + "}\n";
  };
  const std::string values =
      "color3f[] primvars:displayColor = [(.25, .5, 1)]\nfloat[] widths = [0.0001220703125, 0.0003662109375]\n";
  const auto diameters_at = [](const Strands& s, float x) {
    for (std::size_t i = 0; i < s.count(); ++i)
      if (s.strand(i)[0].x == x)
        return std::vector<float>(s.diameters_m.begin() + s.offsets[i], s.diameters_m.begin() + s.offsets[i + 1]);
    return std::vector<float>{};
  };
  constexpr float d = 1.0F / 8192;
  for (const bool first : {true, false}) {
    const std::string text =
        "#usda 1.0\n(metersPerUnit = 1)\n" + prim("1", first ? values : "") + prim("2", first ? "" : values);
    ReadReport report;
    const Strands s = read(text, &report);
    EXPECT_EQ(diameters_at(s, first ? 1 : 2), (std::vector<float>{d, 3 * d})) << text;
    EXPECT_EQ(diameters_at(s, first ? 2 : 1), (std::vector<float>{2 * d, 2 * d})) << text;  // the mean
    ASSERT_EQ(report.repaired(), 2U);
    for (const StrandIssue& issue : report.issues) EXPECT_EQ(issue.strand, first ? 1U : 0U);
  }
}

TEST(Usda, ReadsNumbersWithAPlusAndRefusesWhatIsNone) {
  const std::string end =
      ")\ndef BasisCurves \"c\" {\nuniform token type = \"linear\"\n"
      "int[] curveVertexCounts = [+2]\npoint3f[] points = [(0, 0, +10), (+0, 0, 2e+1)]\n}\n";
  ReadReport report;
  EXPECT_FLOAT_EQ(read("#usda 1.0\n(metersPerUnit = +0.01" + end, &report).vertices[1].z, 0.2F);
  EXPECT_EQ(report.metres_per_unit, 0.01);
  for (const char* bad : {"+-1", "++1", "+", "-+1", "1x", "0", "-1", "nan", "1e-300", "1e7"})
    EXPECT_THAT(refusal(std::string("#usda 1.0\n(metersPerUnit = ") + bad + end), HasSubstr("metersPerUnit")) << bad;
  for (const char* bad : {"(0, +-1, 0)", "(0, ++1, 0)", "(0, +, 0)"})
    EXPECT_THAT(refusal(curves(std::string("point3f[] points = [") + bad + "]\n")), HasSubstr("is no number")) << bad;
}

TEST(Usda, TellsWhatIsAveragedOrNotRead) {
  const std::string points =
      "uniform token type = \"linear\"\nint[] curveVertexCounts = [2, 2]\n"
      "point3f[] points = [(0,0,0), (0,.1,0), (1,0,0), (1,.1,0)]\n";
  ReadReport report;
  read(curves(points + "color3f[] primvars:displayColor = [(0,0,0), (.5,0,0), (1,1,1), (1,1,1)] "
                       "(interpolation = \"vertex\")\ntexCoord2f[] primvars:st = [(0,0), (0,1)]\n"
                       "float2[] primvars:groom_root_uv = [(0,0), (0,1)]\n"
                       "float[] primvars:displayOpacity = [1, 0.5] (interpolation = \"uniform\")\n"),
       &report);
  EXPECT_THAT(report.notes,
              testing::UnorderedElementsAre(HasSubstr("averaged to one per strand: they vary along 1 strand"),
                                            HasSubstr("texture coordinates not read"), HasSubstr("opacity")));
  read(curves(points + "color3f[] primvars:displayColor = [(0,0,0), (0,0,0), (1,1,1), (1,1,1)] "
                       "(interpolation = \"vertex\")\n"),
       &report);
  EXPECT_THAT(report.notes, IsEmpty());
}

TEST(Usda, QuotesHideWhatIsInThem) {
  const std::string text = curves(
      "string a = \"x \\\" } ( # \"\nstring b = '} \\' \"'\nasset c = @} (@\n"
      "string d = \"\"\"\"} \\\"\"\" {\"\"\"\nstring e = \"\"\n# }\nrel f = </x{>\n" +
      line(4));
  EXPECT_EQ(read(text).count(), 1U) << text;
}

TEST(Usda, TakesTheFirstTimeSample) {
  ReadReport report;
  const Strands s =
      read(curves("uniform token type = \"linear\"\nint[] curveVertexCounts = [2]\n"
                  "point3f[] points.timeSamples = {\n 1: [(0,0,0), (0,.1,0)],\n 2: [(9,9,9), (8,8,8)],\n}\n"),
           &report);
  EXPECT_EQ(s.vertices, (std::vector<glm::vec3>{{0, 0, 0}, {0, 0.1F, 0}}));
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("first time sample")));
}

TEST(Usda, RefusesWithTheReason) {
  EXPECT_THAT(refusal("#usda 1.0\ndef Xform \"a\" {}\n"), HasSubstr("no BasisCurves"));
  EXPECT_THAT(refusal("usda"), HasSubstr("#usda"));
  EXPECT_THAT(refusal(curves(line(4) + "uniform token wrap = \"periodic\"\n")), HasSubstr("closed"));
  EXPECT_THAT(refusal(curves(line(4) + "uniform token basis = \"hermite\"\n")), HasSubstr("hermite"));
  EXPECT_THAT(refusal(curves(line(4) + "uniform token type = \"quintic\"\n")), HasSubstr("quintic"));
  EXPECT_THAT(refusal(curves("int[] curveVertexCounts = [3]\npoint3f[] points = [(0,0,0)]\n")), HasSubstr("need 3"));
  EXPECT_THAT(refusal(curves("int[] curveVertexCounts = [2]\npoint3f[] points = [(0,0,0), (0,1,0), (0,2,0)]\n")),
              HasSubstr("need 2"));
  EXPECT_THAT(refusal(curves("int[] curveVertexCounts = [1]\npoint3f[] points = [(0,0)]\n")), HasSubstr("triples"));
  EXPECT_THAT(refusal(curves("point3f[] points = [(0,x,0)]\n")), HasSubstr("line 8"));
  EXPECT_THAT(refusal("#usda 1.0\n(metersPerUnit = 0)"), HasSubstr("metersPerUnit"));
  EXPECT_THAT(refusal("#usda 1.0\n(upAxis = \"W\")"), HasSubstr("upAxis"));
  EXPECT_THAT(refusal("#usda 1.0\n}"), HasSubstr("too many"));
  EXPECT_THAT(refusal(curves("def BasisCurves \"inner\" {}\n")), HasSubstr("inside BasisCurves"));
}

TEST(Usda, WritesTheNamesThatUnrealReads) {
  Strands strands;
  strands.append(std::vector<glm::vec3>{{0, 0, 0}, {-0.0F, 0.1F, 0}});
  strands.colours = {{0.25F, 0.5F, 1}};
  strands.diameter_m = 1e-4F;
  EXPECT_EQ(format_strands(strands, "x.usda", 0.5F),
            "#usda 1.0\n(\n    defaultPrim = \"hair\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n"
            "def BasisCurves \"hair\" (\n    prepend apiSchemas = [\"GroomAPI\"]\n)\n{\n"
            "    uniform token type = \"linear\"\n    uniform token wrap = \"nonperiodic\"\n"
            "    int[] curveVertexCounts = [2]\n"
            "    point3f[] points = [(0, 0, 0), (-0, 0.1, 0)]\n"
            "    float3[] extent = [(-5e-05, -5e-05, -5e-05), (5e-05, 0.10005, 5e-05)]\n"
            "    float[] widths = [1e-04] (\n        interpolation = \"constant\"\n    )\n"
            "    int[] primvars:groom_id = [0] (\n        interpolation = \"uniform\"\n    )\n"
            "    color3f[] primvars:displayColor = [(0.25, 0.5, 1)] (\n        interpolation = \"uniform\"\n    )\n"
            "    float3[] primvars:groom_color = [(0.25, 0.5, 1), (0.25, 0.5, 1)] (\n"
            "        interpolation = \"vertex\"\n    )\n"
            "    float[] primvars:displayOpacity = [0.5] (\n        interpolation = \"constant\"\n    )\n"
            "    custom int userProperties:groom_version_major = 1\n"
            "    custom int userProperties:groom_version_minor = 5\n"
            "    custom string userProperties:groom_tool = \"Pelage\"\n}\n");
}

}  // namespace
}  // namespace pelage::hair
