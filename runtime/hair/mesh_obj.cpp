#include "pelage/hair/mesh_obj.h"

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/input_file.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

class ObjParser {
 public:
  ObjParser(const std::string& where, const ReadOptions& options) : where_(where), options_(options) {}

  Mesh run(std::string_view text) {
    lines_ = ObjLines(text_of(std::as_bytes(std::span(text))));
    while (!lines_.at_end()) parse_line(lines_.next());
    if (mesh_.triangles.empty()) throw InputError(where_, "no polygon in it: give an OBJ mesh with v and f lines");
    compute_normals(mesh_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(where_, "line " + std::to_string(lines_.number()) + ": " + what + ": export the mesh again");
  }

  void parse_line(std::string_view line) {
    Words words(line);
    const std::string_view keyword = words.next();
    if (keyword == "v") parse_vertex(words);
    if (keyword == "f") parse_polygon(words);
  }

  float number(std::string_view word) const {
    const std::optional<float> value = parse_float(word);
    if (!value) refuse("\"" + std::string(word) + "\" is no number");
    if (!(std::abs(*value) < 1e30F)) refuse("\"" + std::string(word) + "\" is no position");
    return *value;
  }

  void parse_vertex(Words& words) {
    glm::vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = number(words.next());
    p = to_metres(p, options_);
    if (!is_usable(p)) refuse("a vertex that is not a finite position within 1000 km");
    mesh_.vertices.push_back(p);
  }

  /// "7", "7/1", "7//3" or "-1": counted from 1, or backwards from the last vertex so far.
  std::uint32_t vertex_index(std::string_view word) const {
    const std::string_view text = word.substr(0, word.find('/'));
    const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
    const std::optional<std::int64_t> index = parse_integer<std::int64_t>(text);
    if (!index || *index == 0 || *index > count || *index < -count) {
      refuse("vertex index \"" + std::string(text) + "\" with " + std::to_string(count) + " vertices so far");
    }
    return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
  }

  /// A fan around the first corner.
  void parse_polygon(Words& words) {
    std::vector<std::uint32_t> corners;
    for (std::string_view word = words.next(); !word.empty(); word = words.next())
      corners.push_back(vertex_index(word));
    if (corners.size() < 3) refuse("a polygon of " + std::to_string(corners.size()) + " corners");
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh_.triangles.emplace_back(corners[0], corners[k - 1], corners[k]);
  }

  const std::string& where_;
  const ReadOptions& options_;
  ObjLines lines_{std::string_view()};
  Mesh mesh_;
};

void append_vector(std::string& out, const char* keyword, glm::vec3 v) {
  out += keyword;
  for (int k = 0; k < 3; ++k) {
    out += ' ';
    append_number(out, v[k]);
  }
  out += '\n';
}

}  // namespace

Mesh parse_obj(std::string_view text, const std::string& where, const ReadOptions& options) {
  check_options(options);
  return ObjParser(where, options).run(text);
}

Mesh read_obj(const std::filesystem::path& file, const ReadOptions& options) {
  const std::vector<std::byte> bytes = read_bytes(file);
  return parse_obj(as_text(bytes), file.string(), options);
}

void write_obj(const Mesh& mesh, const std::filesystem::path& file) {
  std::string text = "# Pelage: metres, Y up\n";
  for (const glm::vec3& v : mesh.vertices) append_vector(text, "v", v);
  for (const glm::vec3& n : mesh.normals) append_vector(text, "vn", n);
  for (const glm::uvec3& t : mesh.triangles) {
    text += "f";
    for (int k = 0; k < 3; ++k) {
      const std::string index = std::to_string(t[k] + 1);
      text += mesh.normals.empty() ? " " + index : " " + index + "//" + index;
    }
    text += "\n";
  }
  AtomicFile out(file);
  out.write(text);
  out.commit();
}

}  // namespace pelage::hair
