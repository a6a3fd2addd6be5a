// USD text (.usda), the subset that holds hair: BasisCurves prims wherever they stand in the tree, their
// curveVertexCounts, points, widths (constant, uniform, varying or vertex), type linear or cubic with basis bezier,
// bspline or catmullRom (evaluated: curve_basis.h), wrap nonperiodic or pinned, displayColor or groom_color, constant
// displayOpacity; metersPerUnit and upAxis of the stage. Of animated values the first sample is taken. Transforms,
// references and variants are not followed; where there are some, that is told.
//
// Written: one linear BasisCurves prim, named as Unreal's groom importer wants it (Epic, "Alembic for Grooms
// Specification", version 1.5; the USD importer reads the same names from primvars, the version from userProperties,
// and takes widths in the stage's unit, so that groom_width, which it does not scale, is left out).
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/vec4.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/curve_basis.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/text_words.h"
#include "pelage/hair/usda_lexer.h"

namespace pelage::hair {
namespace {

struct Primvar {
  std::vector<float> values;
  std::string interpolation;
  bool indexed = false;
};

/// What a BasisCurves prim says, with the schema's fallbacks.
struct CurvesPrim {
  std::size_t line = 0;
  std::vector<std::uint64_t> counts;
  std::vector<float> points;  // 3 per point
  Primvar widths{{}, "vertex"}, widths_primvar{{}, "constant"};
  Primvar display_colour{{}, "constant"}, groom_colour{{}, "constant"}, opacity{{}, "constant"};
  std::string type = "cubic", basis = "bezier", wrap = "nonperiodic";
};

/// One prim's curves, as they are added to the whole.
class CurvesReader {
 public:
  CurvesReader(CurvesPrim& prim, RawHair& raw, const std::string& where) : prim_(prim), raw_(raw), where_(where) {}

  void run() {
    check();
    const bool cubic = prim_.type == "cubic";
    std::size_t first = 0, first_varying = 0;
    for (std::size_t i = 0; i < prim_.counts.size(); ++i) {
      const auto n = static_cast<std::size_t>(prim_.counts[i]);
      if (cubic && n + phantoms() >= 4) {
        first_varying += add_cubic(i, first, n, first_varying);
      } else {
        for (std::size_t k = 0; k < n; ++k) raw_.points.emplace_back(point(first + k));
        for (std::size_t k = 0; has_widths() && k < n; ++k)
          raw_.thickness.push_back(width(i, first + k, first_varying + k));
        first_varying += n;
      }
      end_strand(raw_, where_);
      add_colour(i, first, n);
      first += n;
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(where_, "BasisCurves in line " + std::to_string(prim_.line) + ": " + what);
  }

  void check() {
    if (prim_.points.size() % 3 != 0) refuse("points that are no triples: export it again");
    std::uint64_t sum = 0;
    for (const std::uint64_t n : prim_.counts) sum += n;  // each < 2^31
    if (sum != prim_.points.size() / 3) {
      refuse("curveVertexCounts need " + std::to_string(sum) + " points, there are " +
             std::to_string(prim_.points.size() / 3) + ": export it again");
    }
    if (prim_.type != "linear" && prim_.type != "cubic") refuse("type \"" + prim_.type + "\" is unknown");
    if (prim_.wrap != "nonperiodic" && prim_.wrap != "pinned")
      refuse("wrap \"" + prim_.wrap + "\": closed curves are no hair; export open ones");
    if (prim_.basis == "bezier")
      basis_ = Basis::bezier;
    else if (prim_.basis == "bspline")
      basis_ = Basis::b_spline;
    else if (prim_.basis == "catmullRom")
      basis_ = Basis::catmull_rom;
    else if (prim_.type == "cubic")
      refuse("basis \"" + prim_.basis + "\" is not read: bezier, bspline, catmullRom are");
    if (!prim_.widths_primvar.values.empty()) prim_.widths = std::move(prim_.widths_primvar);
    settle(prim_.widths, 1, "widths");
    colour_ = prim_.display_colour.values.empty() ? &prim_.groom_colour : &prim_.display_colour;
    settle(*colour_, 3, "colours");
    if (prim_.opacity.interpolation == "constant" && prim_.opacity.values.size() == 1)
      raw_.opacity = prim_.opacity.values.front();
  }

  std::size_t values_for(std::string_view interpolation) const {
    if (interpolation == "constant") return 1;
    if (interpolation == "uniform") return prim_.counts.size();
    if (interpolation == "vertex") return prim_.points.size() / 3;
    if (interpolation == "varying") return varying_count();
    return 0;
  }

  /// A primvar whose count does not fit its interpolation has the first one that it fits, or is not used; that is told.
  void settle(Primvar& primvar, std::size_t each, const char* name) {
    const std::size_t size = primvar.values.size();
    if (size == 0 || (size == each * values_for(primvar.interpolation) && !primvar.indexed)) return;
    const std::string misfit = std::to_string(size / each) + " values do not fit interpolation \"" +
                               primvar.interpolation.substr(0, 40) + "\"";
    for (const char* const other : {"constant", "uniform", "vertex", "varying"}) {
      if (primvar.indexed || size != each * values_for(other)) continue;
      primvar.interpolation = other;
      raw_.notes.push_back(std::string(name) + " taken as " + other + ": " + misfit);
      return;
    }
    raw_.notes.push_back(std::string(name) + " ignored: " + (primvar.indexed ? "indexed" : misfit));
    primvar.values.clear();
  }

  /// Control points that `pinned` adds at the ends: mirrored, so that the curve starts and ends at its points.
  std::size_t phantoms() const { return prim_.wrap == "pinned" && basis_ != Basis::bezier ? 2 : 0; }

  std::size_t varying_of(std::size_t n) const {
    const bool cubic = prim_.type == "cubic" && n + phantoms() >= 4;
    return cubic ? divide(basis_, n + phantoms()).spans + 1 : n;
  }
  std::size_t varying_count() const {
    std::size_t sum = 0;
    for (const std::uint64_t n : prim_.counts) sum += varying_of(static_cast<std::size_t>(n));
    return sum;
  }

  glm::vec3 point(std::size_t k) const {
    return {prim_.points[3 * k], prim_.points[3 * k + 1], prim_.points[3 * k + 2]};
  }
  bool has_widths() const { return !prim_.widths.values.empty(); }

  float width(std::size_t curve, std::size_t vertex, std::size_t varying) const {
    const Primvar& w = prim_.widths;
    if (w.values.empty()) return 0.0F;
    if (w.interpolation == "constant") return w.values[0];
    if (w.interpolation == "uniform") return w.values[curve];
    return w.values[w.interpolation == "varying" ? varying : vertex];
  }

  /// Evaluates a curve; returns how many varying values are its.
  std::size_t add_cubic(std::size_t curve, std::size_t first, std::size_t n, std::size_t first_varying) {
    const bool by_vertex = prim_.widths.interpolation == "vertex";
    std::vector<glm::vec4> control;
    for (std::size_t k = 0; k < n; ++k)
      control.emplace_back(point(first + k), by_vertex ? width(curve, first + k, 0) : 0.0F);
    if (phantoms() > 0) {
      control.insert(control.begin(), 2.0F * control[0] - control[1]);
      control.push_back(2.0F * control[n] - control[n - 1]);
    }
    const CurveSpans spans = divide(basis_, control.size());
    if (spans.used < control.size()) {
      raw_.repairs.push_back(
          {raw_.offsets.size() - 1, false,
           std::to_string(control.size() - spans.used) + " control points after the last whole Bezier span ignored"});
    }
    for (std::size_t k = 0; k < spans.vertices; ++k) {
      const glm::vec4 p = evaluate(basis_, spans, control, k);
      raw_.points.emplace_back(p);
      if (has_widths()) raw_.thickness.push_back(by_vertex ? p.w : width_along(curve, first_varying, spans, k));
    }
    return spans.spans + 1;
  }

  /// Constant, uniform, or linear between the ends of the spans.
  float width_along(std::size_t curve, std::size_t first_varying, const CurveSpans& spans, std::size_t k) const {
    if (prim_.widths.interpolation != "varying") return width(curve, 0, 0);
    const double x = spans.parameter(k);
    const std::size_t span = std::min(static_cast<std::size_t>(x), spans.spans - 1);
    const auto u = static_cast<float>(x - static_cast<double>(span));
    const float* const w = prim_.widths.values.data() + first_varying + span;
    return (1.0F - u) * w[0] + u * w[1];
  }

  void add_colour(std::size_t curve, std::size_t first, std::size_t n) {
    const std::vector<float>& c = colour_->values;
    const auto at = [&](std::size_t k) { return glm::vec3(c[3 * k], c[3 * k + 1], c[3 * k + 2]); };
    if (c.empty()) return;
    if (colour_->interpolation == "constant") return raw_.colours.push_back(at(0));
    if (colour_->interpolation == "uniform") return raw_.colours.push_back(at(curve));
    if (colour_->interpolation == "varying") {
      n = varying_of(n);
      first = colour_at_;
      colour_at_ += n;
    }
    glm::dvec3 sum(0.0);
    for (std::size_t k = first; k < first + n; ++k) sum += glm::dvec3(at(k));
    raw_.colours.emplace_back(sum / static_cast<double>(n));
  }

  CurvesPrim& prim_;
  RawHair& raw_;
  const std::string& where_;
  Basis basis_ = Basis::bezier;
  Primvar* colour_ = nullptr;
  std::size_t colour_at_ = 0;  // of the varying colours
};

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
    const std::optional<float> metres = parse_float(lexer_.next().text);
    if (!metres || !(*metres > 0.0F) || !(*metres <= 1e6F)) lexer_.refuse("metersPerUnit is no plausible number");
    double value = 0;  // in full precision: 0.01 is no float
    const std::string_view text = lexer_.last().text;
    std::from_chars(text.data(), text.data() + text.size(), value);
    raw_.metres_per_unit = value;
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
    CurvesReader(*curves_, raw_, where_).run();
    level(raw_.colours, strands, raw_.offsets.size() - 1);
    level(raw_.thickness, points, raw_.points.size());
    curves_.reset();
    any_curves_ = true;
  }

  /// Prims that differ in what they say: values that are missing are NaN, to be repaired from the others.
  template <class T>
  static void level(std::vector<T>& values, std::size_t before, std::size_t now) {
    if (values.empty() || values.size() == now) return;
    const T none(std::numeric_limits<float>::quiet_NaN());
    if (values.size() + before == now) values.insert(values.begin(), before, none);  // these are the first
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
  const std::string_view text = as_text(bytes);
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
