// USD text (.usda), the subset that holds hair: BasisCurves prims wherever they stand in the tree, their
// curveVertexCounts, points, widths (constant, uniform, varying or vertex), type linear or cubic with basis bezier,
// bspline or catmullRom (evaluated: curve_basis.h), wrap nonperiodic or pinned, displayColor or groom_color, constant
// displayOpacity; metersPerUnit and upAxis of the stage. Of animated values the first sample is taken; transforms and
// variants are not followed; both are told. Sublayers, references and payloads are other files, and not looked at.
//
// Written: one linear BasisCurves prim, named as Unreal's groom importer wants it (Epic, "Alembic for Grooms
// Specification", version 1.5; the USD importer reads the same names from primvars, the version from userProperties,
// and takes widths in the stage's unit, so that groom_width, which it does not scale, is left out).
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/input_file.h"
#include "pelage/hair/text_words.h"
#include "pelage/hair/usda_curves.h"
#include "pelage/hair/usda_lexer.h"

namespace pelage::hair {
namespace {

class UsdaParser {
  struct Scope {
    bool curves;  // a BasisCurves prim
    bool moved;   // by an xformOp of its own
  };

 public:
  UsdaParser(std::string_view text, const std::string& where) : lexer_(text, where), where_(where) {}

  RawHair run() {
    raw_.format = "USD text";
    raw_.says_curve = true;
    if (lexer_.peek().is('(')) parse_stage();
    while (lexer_.peek().kind != UsdaToken::end) parse_statement();
    if (!scopes_.empty()) lexer_.refuse("ends inside a prim");
    if (!any_curves_) {
      throw InputError(where_,
                       "no BasisCurves prim in it (references, payloads and NurbsCurves are not read): flatten the "
                       "stage, or export the curves as BasisCurves");
    }
    if (moved_prims_ > 0)
      raw_.notes.push_back("transforms (xformOp) of " + std::to_string(moved_prims_) +
                           " BasisCurves prims ignored: freeze them before the export");
    if (animated_) raw_.notes.push_back("animated: its first time sample is taken");
    if (variants_) raw_.notes.push_back("variants ignored");
    if (textured_ > 0) raw_.notes.push_back(texture_note(textured_));
    return std::move(raw_);
  }

 private:
  void parse_stage() {
    lexer_.next();
    for (std::size_t depth = 1; depth > 0;) {
      const UsdaToken token = lexer_.next_inside();
      depth += token.opens() ? 1U : 0U;
      depth -= token.closes() ? 1U : 0U;
      if (depth != 1 || !lexer_.peek().is('=')) continue;
      if (token.is_word("metersPerUnit")) parse_unit();
      if (token.is_word("upAxis")) parse_up();
    }
  }

  void parse_unit() {
    lexer_.next();
    const std::optional<double> metres = parse_double(lexer_.next().text);  // 0.01 is no float
    if (!metres || !is_unit(*metres)) lexer_.refuse("metersPerUnit is no plausible number");
    raw_.metres_per_unit = *metres;
  }

  void parse_up() {
    lexer_.next();
    const std::string_view axis = lexer_.next().text;
    if (axis == "Y")
      raw_.up = UpAxis::y;
    else if (axis == "Z")
      raw_.up = UpAxis::z;
    else if (axis == "X")
      raw_.up = UpAxis::x;
    else
      lexer_.refuse("upAxis \"" + std::string(axis) + "\" is none");
  }

  void parse_statement() {
    const UsdaToken token = lexer_.next();
    if (token.is('}')) return close_prim();
    if (token.is(';')) return;
    if (token.kind != UsdaToken::word) lexer_.refuse("\"" + std::string(token.text) + "\" is not expected here");
    if (token.text == "def" || token.text == "over" || token.text == "class") return open_prim(token);
    if (scopes_.empty()) lexer_.refuse("\"" + std::string(token.text) + "\" is not expected outside a prim");
    if (token.text == "variantSet") {
      variants_ = true;
      lexer_.next();  // its name
      lexer_.skip_value_and_metadata();
      return;
    }
    parse_property(token);
  }

  void open_prim(const UsdaToken& specifier) {
    std::string_view type;
    if (lexer_.peek().kind == UsdaToken::word) type = lexer_.next().text;
    if (lexer_.next().kind != UsdaToken::string) lexer_.refuse("a prim without a name");
    if (lexer_.peek().is('(')) lexer_.skip_value();
    if (!lexer_.next().is('{')) lexer_.refuse("a prim without {");
    const bool curves = type == "BasisCurves" && specifier.text != "class";
    scopes_.push_back({curves, false});
    if (!curves) return;
    if (curves_) lexer_.refuse("BasisCurves inside BasisCurves, which USD forbids");
    curves_.emplace().line = specifier.line;
  }

  void close_prim() {
    if (scopes_.empty()) lexer_.refuse("a } too many");
    const Scope scope = scopes_.back();
    scopes_.pop_back();
    if (scope.curves) close_curves();
    if (scope.moved) --moved_scopes_;
  }

  void close_curves() {
    if (moved_scopes_ > 0) ++moved_prims_;
    const std::size_t strands = raw_.offsets.size() - 1, points = raw_.points.size();
    const bool coloured = !raw_.colours.empty(), thick = !raw_.thickness.empty();
    append_curves(*curves_, raw_, where_);
    if (curves_->textured) textured_ += raw_.offsets.size() - 1 - strands;
    level(raw_.colours, coloured, strands, raw_.offsets.size() - 1);
    level(raw_.thickness, thick, points, raw_.points.size());
    curves_.reset();
    any_curves_ = true;
  }

  /// Prims that differ in what they say: values that are missing are NaN, to be repaired from the others. The last prim
  /// made `now` of `before`; whether any prim had values earlier says whose are missing, its own or those of all
  /// others.
  template <class T>
  static void level(std::vector<T>& values, bool earlier, std::size_t before, std::size_t now) {
    if (values.empty()) return;
    const T none(std::numeric_limits<float>::quiet_NaN());
    if (!earlier) values.insert(values.begin(), before, none);
    values.resize(now, none);
  }

  /// [custom] [uniform] type[[]] name [= value] [(metadata)]
  void parse_property(UsdaToken token) {
    while (is_qualifier(token.text)) token = lexer_.next_inside();
    if (lexer_.peek().is('[')) {
      lexer_.next();
      if (!lexer_.next().is(']')) lexer_.refuse("a type with [ and no ]");
    }
    std::string_view name = token.text;  // of `reorder properties = ...`, which has no type
    if (lexer_.peek().kind == UsdaToken::word)
      name = lexer_.next().text;
    else if (!lexer_.peek().is('='))
      lexer_.refuse("a property without a name");
    if (name.starts_with("xformOp:")) mark_moved();
    if (!scopes_.back().curves) return lexer_.skip_value_and_metadata();
    if (lexer_.peek().is('=') && (token.text.starts_with("texCoord") || name == "primvars:groom_root_uv"))
      curves_->textured = true;
    parse_curves_property(name, *curves_);
  }

  void mark_moved() {
    if (!scopes_.back().moved) ++moved_scopes_;
    scopes_.back().moved = true;
  }

  static bool is_qualifier(std::string_view word) {
    constexpr std::string_view kWords[] = {"custom", "uniform", "varying", "config", "prepend",
                                           "append", "delete",  "add",     "reorder"};
    return std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords);
  }

  void parse_curves_property(std::string_view name, CurvesPrim& prim) {
    const bool samples = name.ends_with(".timeSamples");
    if (samples) name.remove_suffix(std::string_view(".timeSamples").size());
    if (name == "curveVertexCounts") return read_array(samples, [&] { read_counts(prim.counts); });
    if (name == "points") return read_array(samples, [&] { lexer_.read_numbers(prim.points); });
    if (name == "type") return read_token(prim.type);
    if (name == "basis") return read_token(prim.basis);
    if (name == "wrap") return read_token(prim.wrap);
    if (name == "primvars:displayColor:indices") prim.display_colour.indexed = true;
    if (name == "primvars:groom_color:indices") prim.groom_colour.indexed = true;
    if (name == "primvars:widths:indices") prim.widths_primvar.indexed = true;
    if (Primvar* const primvar = primvar_of(name, prim)) {
      return read_array(
          samples, [&] { lexer_.read_numbers(primvar->values); }, &primvar->interpolation);
    }
    lexer_.skip_value_and_metadata();
  }

  static Primvar* primvar_of(std::string_view name, CurvesPrim& prim) {
    if (name == "widths") return &prim.widths;
    if (name == "primvars:widths") return &prim.widths_primvar;
    if (name == "primvars:displayColor") return &prim.display_colour;
    if (name == "primvars:groom_color") return &prim.groom_colour;
    if (name == "primvars:displayOpacity") return &prim.opacity;
    return nullptr;
  }

  void read_counts(std::vector<std::uint64_t>& counts) {
    lexer_.read_array(
        [&](std::string_view word) {
          const std::optional<std::uint32_t> n = parse_integer<std::uint32_t>(word);
          if (!n || *n > 0x7FFF'FFFFU) lexer_.refuse("\"" + std::string(word.substr(0, 40)) + "\" is no vertex count");
          counts.push_back(*n);
        },
        [&] { counts.clear(); });
  }

  /// `= [ ... ]`, or `= { time: [ ... ], ... }`: the first; then the metadata.
  template <class Read>
  void read_array(bool samples, const Read& read, std::string* interpolation = nullptr) {
    if (lexer_.peek().is('=')) {
      lexer_.next();
      if (samples) {
        read_first_sample(read);
      } else if (lexer_.peek().is('[')) {
        read();
      } else {
        lexer_.skip_value();  // None
      }
    }
    if (lexer_.peek().is('(')) parse_metadata(interpolation);
  }

  template <class Read>
  void read_first_sample(const Read& read) {
    if (!lexer_.next().is('{')) lexer_.refuse("time samples without {");
    animated_ = true;
    if (lexer_.peek().kind == UsdaToken::word) lexer_.next();  // the time, with its colon
    if (lexer_.peek().is('[')) read();
    lexer_.skip_to_close();
  }

  void read_token(std::string& value) {
    if (lexer_.peek().is('=')) {
      lexer_.next();
      value = lexer_.next().text;
    }
    if (lexer_.peek().is('(')) lexer_.skip_value();
  }

  void parse_metadata(std::string* interpolation) {
    lexer_.next();
    for (std::size_t depth = 1; depth > 0;) {
      const UsdaToken token = lexer_.next_inside();
      depth += token.opens() ? 1U : 0U;
      depth -= token.closes() ? 1U : 0U;
      if (depth != 1 || interpolation == nullptr || !token.is_word("interpolation") || !lexer_.peek().is('=')) continue;
      lexer_.next();
      *interpolation = lexer_.next_inside().text;
    }
  }

  UsdaLexer lexer_;
  const std::string& where_;
  std::vector<Scope> scopes_;         // the open prims
  std::optional<CurvesPrim> curves_;  // the open BasisCurves prim
  bool any_curves_ = false, animated_ = false, variants_ = false;
  std::size_t moved_scopes_ = 0, moved_prims_ = 0;
  std::size_t textured_ = 0;  // curves of prims with texture coordinates
  RawHair raw_;
};

template <class T>
void append_list(std::string& out, const std::vector<T>& values) {
  out += '[';
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k > 0) out += ", ";
    append_number(out, values[k]);
  }
  out += ']';
}

void append_triple(std::string& out, glm::vec3 v) {
  for (int k = 0; k < 3; ++k) {
    out += k == 0 ? "(" : ", ";
    append_number(out, v[k]);
  }
  out += ')';
}

void append_list(std::string& out, const std::vector<glm::vec3>& values) {
  out += '[';
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k > 0) out += ", ";
    append_triple(out, values[k]);
  }
  out += ']';
}

template <class T>
void append_attribute(std::string& out, const char* declaration, const std::vector<T>& values,
                      const char* interpolation = nullptr) {
  out += "    ";
  out += declaration;
  out += " = ";
  append_list(out, values);
  if (interpolation != nullptr) out += std::string(" (\n        interpolation = \"") + interpolation + "\"\n    )";
  out += '\n';
}

/// Box of the vertices, widened by the largest radius.
std::vector<glm::vec3> extent(const Strands& strands) {
  glm::vec3 low = strands.vertices.front(), high = low;
  float diameter_m = 0.0F;
  for (std::size_t k = 0; k < strands.vertices.size(); ++k) {
    low = glm::min(low, strands.vertices[k]);
    high = glm::max(high, strands.vertices[k]);
    diameter_m = std::max(diameter_m, diameter_at_m(strands, k));
  }
  return {low - 0.5F * diameter_m, high + 0.5F * diameter_m};
}

}  // namespace

RawHair decode_usda(Bytes bytes, const std::string& where) {
  const std::string_view text = text_of(bytes);
  if (!text.starts_with("#usda")) throw InputError(where, "does not start with #usda: no USD text; export it again");
  return UsdaParser(text, where).run();
}

std::string encode_usda(const Strands& strands, Output& output) {
  std::vector<std::size_t> counts, ids;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    counts.push_back(strands.strand(i).size());
    ids.push_back(i);
  }
  std::string text =
      "#usda 1.0\n(\n    defaultPrim = \"hair\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n"
      "def BasisCurves \"hair\" (\n    prepend apiSchemas = [\"GroomAPI\"]\n)\n{\n"
      "    uniform token type = \"linear\"\n    uniform token wrap = \"nonperiodic\"\n";
  append_attribute(text, "int[] curveVertexCounts", counts);
  append_attribute(text, "point3f[] points", strands.vertices);
  if (!strands.vertices.empty()) append_attribute(text, "float3[] extent", extent(strands));
  if (!strands.diameters_m.empty()) {
    append_attribute(text, "float[] widths", strands.diameters_m, "vertex");
  } else if (strands.diameter_m != 0.0F) {
    append_attribute(text, "float[] widths", std::vector<float>{strands.diameter_m}, "constant");
  } else {
    output.report.notes.push_back("no diameter is known: Unreal takes 1 cm where a groom has no widths");
  }
  append_attribute(text, "int[] primvars:groom_id", ids, "uniform");
  if (!strands.colours.empty()) {
    append_attribute(text, "color3f[] primvars:displayColor", strands.colours, "uniform");
    std::vector<glm::vec3> per_vertex;
    for (std::size_t i = 0; i < strands.count(); ++i)
      per_vertex.insert(per_vertex.end(), counts[i], strands.colours[i]);
    append_attribute(text, "float3[] primvars:groom_color", per_vertex, "vertex");
  }
  if (output.opacity)
    append_attribute(text, "float[] primvars:displayOpacity", std::vector<float>{*output.opacity}, "constant");
  return text +
         "    custom int userProperties:groom_version_major = 1\n"
         "    custom int userProperties:groom_version_minor = 5\n"
         "    custom string userProperties:groom_tool = \"Pelage\"\n}\n";
}

}  // namespace pelage::hair
