#include "pelage/hair/usda_curves.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <glm/vec4.hpp>
#include <string_view>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/curve_basis.h"

namespace pelage::hair {
namespace {

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
    else if (!prim_.opacity.values.empty())
      raw_.notes.push_back("opacity ignored: " + std::to_string(prim_.opacity.values.size()) +
                           " values, one for all is read");
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
    colours_.clear();
    for (std::size_t k = first; k < first + n; ++k) colours_.push_back(at(k));
    append_colour(raw_, colours_);
  }

  CurvesPrim& prim_;
  RawHair& raw_;
  const std::string& where_;
  Basis basis_ = Basis::bezier;
  Primvar* colour_ = nullptr;
  std::size_t colour_at_ = 0;       // of the varying colours
  std::vector<glm::vec3> colours_;  // of one curve's points
};

}  // namespace

void append_curves(CurvesPrim& prim, RawHair& raw, const std::string& where) {
  CurvesReader(prim, raw, where).run();
}

}  // namespace pelage::hair
