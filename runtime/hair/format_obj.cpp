// OBJ polylines: `v` lines, then `l` lines, one per strand. Colours as Blender and MeshLab have them: `v x y z r g b`.
// Polygons and the rest are ignored. Blender writes the edges of a mesh as one `l a b` each: those that stand together
// in the file and form a chain are joined, in whatever order (edge_chains.h). A strand's own vertices are written, root
// first, never shared.
#include <algorithm>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/edge_chains.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();

class PolylineParser {
 public:
  PolylineParser(Bytes bytes, const std::string& where) : lines_(text_of(bytes)), where_(where) {}

  RawHair run() {
    raw_.format = "OBJ polylines";
    while (!lines_.at_end()) parse_line(Words(lines_.next()));
    end_edges();
    if (raw_.offsets.size() == 1) refuse_without_lines();
    if (joined_ > 0) raw_.notes.push_back(std::to_string(joined_) + " edges joined to others");
    if (texture_vertices_ && textured_ > 0) raw_.notes.push_back(texture_note(textured_));
    if (polygons_ > 0) raw_.notes.push_back(std::to_string(polygons_) + " polygons ignored");
    if (coloured_) append_colours(raw_, point_colours_);
    return std::move(raw_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(where_, "line " + std::to_string(lines_.number()) + ": " + what + ": export the curves again");
  }

  [[noreturn]] void refuse_without_lines() const {
    throw InputError(where_, polygons_ > 0
                                 ? "an OBJ mesh without `l` lines holds no hair: give it as --head, or export curves"
                                 : "no `l` line in it: export the curves as OBJ polylines (v and l lines)");
  }

  void parse_line(Words words) {
    const std::string_view keyword = words.next();
    if (keyword != "l" && !keyword.empty()) end_edges();  // only those that stand together are joined
    if (keyword == "v") parse_vertex(words);
    if (keyword == "l") parse_polyline(words);
    if (keyword == "f") ++polygons_;
    if (keyword == "vt") texture_vertices_ = true;
  }

  void parse_vertex(Words& words) {
    float values[7];
    std::size_t n = 0;
    for (std::string_view word = words.next(); !word.empty() && n < 7; word = words.next()) {
      const std::optional<float> value = parse_float(word);
      if (!value) refuse("\"" + std::string(word) + "\" is no number");
      values[n++] = *value;
    }
    if (n < 3) refuse("a vertex of " + std::to_string(n) + " numbers");
    vertices_.emplace_back(values[0], values[1], values[2]);
    const bool coloured = n >= 6;
    if (coloured && !coloured_) {
      coloured_ = true;
      vertex_colours_.assign(vertices_.size() - 1, glm::vec3(kNoNumber));
      point_colours_.assign(raw_.points.size(), glm::vec3(kNoNumber));
    }
    if (coloured_)
      vertex_colours_.push_back(coloured ? glm::vec3(values[3], values[4], values[5]) : glm::vec3(kNoNumber));
  }

  /// "7", "7/1" or "-1": counted from 1, or backwards from the last vertex so far.
  std::size_t vertex_index(std::string_view word) const {
    const std::string_view text = word.substr(0, word.find('/'));
    const auto count = static_cast<std::int64_t>(vertices_.size());
    const std::optional<std::int64_t> index = parse_integer<std::int64_t>(text);
    if (!index || *index == 0 || *index > count || *index < -count) {
      refuse("vertex index \"" + std::string(text) + "\" with " + std::to_string(count) + " vertices so far");
    }
    return static_cast<std::size_t>(*index > 0 ? *index - 1 : count + *index);
  }

  void parse_polyline(Words& words) {
    indices_.clear();
    bool textured = false;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      indices_.push_back(vertex_index(word));
      textured = textured || word.find('/') != std::string_view::npos;
    }
    if (indices_.empty()) refuse("an `l` line without vertices");
    if (textured) ++textured_;
    if (indices_.size() == 2) return edges_.push_back({indices_[0], indices_[1]});
    end_edges();
    append(indices_);
  }

  void append(std::span<const std::size_t> strand) {
    for (const std::size_t vertex : strand) {
      raw_.points.push_back(vertices_[vertex]);
      if (coloured_) point_colours_.push_back(vertex_colours_[vertex]);
    }
    end_strand(raw_, where_);
  }

  void end_edges() {
    if (edges_.empty()) return;
    const std::size_t before = raw_.offsets.size();
    for_each_chain(edges_, [&](std::span<const std::size_t> chain) { append(chain); });
    joined_ += edges_.size() - (raw_.offsets.size() - before);
    edges_.clear();
  }

  ObjLines lines_;
  const std::string& where_;
  std::vector<glm::vec3> vertices_, vertex_colours_, point_colours_;
  std::vector<std::size_t> indices_;  // of the line
  std::vector<Edge> edges_;           // that stand together, not strands yet
  std::size_t joined_ = 0, polygons_ = 0;
  std::size_t textured_ = 0;  // `l` lines with texture coordinates
  bool coloured_ = false, texture_vertices_ = false;
  RawHair raw_;
};

void append_numbers(std::string& out, glm::vec3 v) {
  for (int k = 0; k < 3; ++k) {
    out += ' ';
    append_number(out, v[k]);
  }
}

}  // namespace

RawHair decode_obj(Bytes bytes, const std::string& where) {
  return PolylineParser(bytes, where).run();
}

std::string encode_obj(const Strands& strands, Output& output) {
  std::string text = "# Pelage: metres, Y up\n";
  std::size_t vertex = 0, left_out = 0;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::span<const glm::vec3> strand = strands.strand(i);
    if (strand.size() < 2) {
      ++left_out;
      continue;
    }
    for (const glm::vec3& p : strand) {
      text += "v";
      append_numbers(text, p);
      if (!strands.colours.empty()) append_numbers(text, strands.colours[i]);
      text += "\n";
    }
    text += "l";
    for (std::size_t k = 0; k < strand.size(); ++k) {
      text += ' ';
      append_number(text, ++vertex);
    }
    text += "\n";
  }
  if (left_out > 0)
    output.report.lost.push_back(std::to_string(left_out) + " strands of fewer than 2 vertices: left out");
  return text;
}

}  // namespace pelage::hair
