// Strand PLY, hairutil's layout: element `vertex` (x y z, maybe red green blue alpha, thickness), element `strand` with
// the segments of each (nsegs), element `edge` for viewers that draw lines. Text and binary of both byte orders are
// read, other elements and properties skipped; binary little-endian is written, colours in 8 bits. A PLY without
// `strand` does not say where a strand ends (dumps of NeuralHaircut and GaussianHaircut) and is refused.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kMaxSegments = 65'535;  // u16, as hairutil has it

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
struct TypeName {
  std::string_view name, other_name;
  Type type;
  std::size_t bytes;
};
constexpr TypeName kTypes[] = {{"char", "int8", Type::i8, 1},      {"uchar", "uint8", Type::u8, 1},
                               {"short", "int16", Type::i16, 2},   {"ushort", "uint16", Type::u16, 2},
                               {"int", "int32", Type::i32, 4},     {"uint", "uint32", Type::u32, 4},
                               {"float", "float32", Type::f32, 4}, {"double", "float64", Type::f64, 8}};

std::size_t bytes_of(Type type) {
  return kTypes[static_cast<std::size_t>(type)].bytes;
}

struct Property {
  std::string_view name;
  Type type;
  std::optional<Type> count_type{};  // of a list
};
struct Element {
  std::string_view name;
  std::uint64_t count;
  std::vector<Property> properties{};
};
enum class Encoding { text, little_endian, big_endian };
struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements{};
  std::size_t end = 0;  // first byte of the body
};

class HeaderParser {
 public:
  HeaderParser(std::string_view text, const std::string& where) : whole_(text.size()), lines_(text), where_(where) {}

  Header run() {
    if (lines_.next() != "ply") refuse("does not start with the line \"ply\"");
    while (true) {
      if (lines_.at_end()) refuse("the header has no end_header");
      Words words(lines_.next());
      const std::string_view keyword = words.next();
      if (keyword == "end_header") break;
      if (keyword == "format") parse_encoding(words.next());
      if (keyword == "element") parse_element(words);
      if (keyword == "property") parse_property(words);
    }
    header_.end = whole_ - lines_.rest().size();
    return std::move(header_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(where_, "PLY, line " + std::to_string(lines_.number()) + ": " + what + ": export it again");
  }

  void parse_encoding(std::string_view word) {
    if (word == "ascii")
      header_.encoding = Encoding::text;
    else if (word == "binary_little_endian")
      header_.encoding = Encoding::little_endian;
    else if (word == "binary_big_endian")
      header_.encoding = Encoding::big_endian;
    else
      refuse("format \"" + std::string(word) + "\" is unknown");
  }

  void parse_element(Words& words) {
    const std::string_view name = words.next(), count = words.next();
    const std::optional<std::uint64_t> n = parse_integer<std::uint64_t>(count);
    if (!n) refuse("\"" + std::string(count) + "\" is no count");
    header_.elements.push_back({name, *n});
  }

  Type type(std::string_view word) const {
    for (const TypeName& t : kTypes) {
      if (word == t.name || word == t.other_name) return t.type;
    }
    refuse("property type \"" + std::string(word) + "\" is unknown");
  }

  void parse_property(Words& words) {
    if (header_.elements.empty()) refuse("a property before the first element");
    Property property{};
    std::string_view word = words.next();
    if (word == "list") {
      property.count_type = type(words.next());
      word = words.next();
    }
    property.type = type(word);
    property.name = words.next();
    header_.elements.back().properties.push_back(property);
  }

  std::size_t whole_;
  Lines lines_;
  const std::string& where_;
  Header header_;
};

/// The numbers of the body, one after the other.
class Scalars {
 public:
  Scalars(Bytes body, Encoding encoding, const std::string& where)
      : body_(body), text_(as_text(body), " \t\r\n"), encoding_(encoding), where_(where) {}

  double next(Type type) {
    if (encoding_ == Encoding::text) return from_text(type);
    const std::size_t size = bytes_of(type);
    if (body_.size() - at_ < size) refuse("ends in the middle");
    std::array<std::byte, 8> bytes{};
    std::copy_n(body_.begin() + static_cast<std::ptrdiff_t>(at_), size, bytes.begin());
    if (encoding_ == Encoding::big_endian)
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    at_ += size;
    return from_bytes(bytes, type);
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(where_, "PLY: " + what + ": truncated or damaged; fetch or export it again");
  }

 private:
  static double from_bytes(const std::array<std::byte, 8>& bytes, Type type) {
    switch (type) {
      case Type::i8:
        return load<std::int8_t>(bytes, 0);
      case Type::u8:
        return load<std::uint8_t>(bytes, 0);
      case Type::i16:
        return load<std::int16_t>(bytes, 0);
      case Type::u16:
        return load<std::uint16_t>(bytes, 0);
      case Type::i32:
        return load<std::int32_t>(bytes, 0);
      case Type::u32:
        return load<std::uint32_t>(bytes, 0);
      case Type::f32:
        return static_cast<double>(load<float>(bytes, 0));
      case Type::f64:
        break;
    }
    return load<double>(bytes, 0);
  }

  double from_text(Type type) {
    const std::string_view word = text_.next();
    if (word.empty()) refuse("ends in the middle");
    if (type == Type::f32 || type == Type::f64) {
      if (const std::optional<float> value = parse_float(word)) return static_cast<double>(*value);
    } else if (const std::optional<std::int64_t> value = parse_integer<std::int64_t>(word)) {
      return static_cast<double>(*value);
    }
    refuse("\"" + std::string(word.substr(0, 40)) + "\" is no number");
  }

  Bytes body_;
  Words text_;
  Encoding encoding_;
  const std::string& where_;
  std::size_t at_ = 0;
};

/// A number that a double property may hold beyond float's range.
float to_float(double value) {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return std::abs(value) <= kMost ? static_cast<float>(value) : std::numeric_limits<float>::quiet_NaN();
}

class BodyParser {
 public:
  BodyParser(Header header, Bytes bytes, const std::string& where)
      : header_(std::move(header)), scalars_(bytes.subspan(header_.end), header_.encoding, where), where_(where) {}

  RawHair run() {
    raw_.format = "strand PLY";
    require_strands();
    for (const Element& element : header_.elements) read_element(element);
    split();
    append_notes();
    if (!colours_.empty()) append_colours(raw_, colours_);
    return std::move(raw_);
  }

 private:
  enum Slot { kX, kY, kZ, kRed, kGreen, kBlue, kAlpha, kThickness, kSegments, kSlots };
  static constexpr std::string_view kNames[kSlots] = {"x",    "y",     "z",         "red",  "green",
                                                      "blue", "alpha", "thickness", "nsegs"};
  static constexpr std::size_t kIgnored = kSlots;
  static constexpr std::string_view kTexture[] = {"s", "t", "u", "v", "texture_u", "texture_v"};

  const Element* find(std::string_view name) const {
    const auto it = std::find_if(header_.elements.begin(), header_.elements.end(),
                                 [&](const Element& element) { return element.name == name; });
    return it == header_.elements.end() ? nullptr : &*it;
  }

  static bool has(const Element* element, Slot slot) {
    return element != nullptr && std::any_of(element->properties.begin(), element->properties.end(),
                                             [&](const Property& p) { return p.name == kNames[slot]; });
  }

  void require_strands() const {
    const Element* const vertex = find("vertex");
    if (!has(vertex, kX) || !has(vertex, kY) || !has(vertex, kZ))
      throw InputError(where_, "PLY without a vertex element of x, y and z holds no hair: give a strand PLY");
    if (has(find("strand"), kSegments)) return;
    throw InputError(where_,
                     "PLY without an element `strand` with `nsegs` (a mesh, a point cloud, or strands as NeuralHaircut "
                     "and GaussianHaircut dump them) does not say where a strand ends: add it as hairutil does, or "
                     "export as .data or .hair");
  }

  /// Which value each property is, or kIgnored.
  static std::vector<std::size_t> slots_of(const Element& element) {
    std::vector<std::size_t> slots;
    for (const Property& p : element.properties) {
      const auto* const it = std::find(std::begin(kNames), std::end(kNames), p.name);
      slots.push_back(p.count_type ? kIgnored : static_cast<std::size_t>(it - std::begin(kNames)));
    }
    return slots;
  }

  /// Row by row, each of at least a byte: a count that the file does not hold ends with the file, nothing is reserved.
  void read_element(const Element& element) {
    if (element.properties.empty()) return;
    const bool vertices = element.name == "vertex", strands = element.name == "strand";
    const std::vector<std::size_t> slots = slots_of(element);
    std::array<double, kSlots + 1> row{};
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < slots.size(); ++k) row[slots[k]] = read_property(element.properties[k]);
      if (vertices) take_vertex(element, row);
      if (strands) take_strand(row[kSegments]);
    }
  }

  /// The value, scaled to [0, 1] for a colour in bytes; a list is read and forgotten.
  double read_property(const Property& p) {
    if (!p.count_type) return scalars_.next(p.type);
    const double n = scalars_.next(*p.count_type);
    for (double i = 0; i < n; ++i) scalars_.next(p.type);
    return 0.0;
  }

  void take_vertex(const Element& element, const std::array<double, kSlots + 1>& row) {
    raw_.points.emplace_back(to_float(row[kX]), to_float(row[kY]), to_float(row[kZ]));
    if (raw_.points.size() == 1) learn(element);
    if (coloured_) {
      colours_.emplace_back(to_float(row[kRed] / colour_scale_), to_float(row[kGreen] / colour_scale_),
                            to_float(row[kBlue] / colour_scale_));
    }
    if (alpha_ && row[kAlpha] != colour_scale_) ++translucent_;
    if (thick_) raw_.thickness.push_back(to_float(row[kThickness]));
  }

  void learn(const Element& element) {
    coloured_ = has(&element, kRed) && has(&element, kGreen) && has(&element, kBlue);
    alpha_ = has(&element, kAlpha) && coloured_;
    thick_ = has(&element, kThickness);
    for (const Property& p : element.properties) {
      if (std::find(std::begin(kTexture), std::end(kTexture), p.name) != std::end(kTexture)) textured_ = true;
      if (p.name == kNames[kRed] && p.type == Type::u8) colour_scale_ = 255.0;
      if (p.name == kNames[kRed] && p.type == Type::u16) colour_scale_ = 65'535.0;
    }
  }

  void append_notes() {
    if (textured_) raw_.notes.push_back(texture_note(segments_.size()));
    if (translucent_ > 0) raw_.notes.push_back("alpha of " + counted(translucent_, "vertex", "vertices") + " not read");
  }

  void take_strand(double segments) {
    if (!(segments >= 0) || segments > 4'294'967'294.0 || segments != std::floor(segments))
      scalars_.refuse("strand " + std::to_string(segments_.size()) + " has no plausible count of segments");
    segments_.push_back(static_cast<std::uint32_t>(segments));
  }

  /// Points to strands: their counts must use up the vertices exactly.
  void split() {
    std::uint64_t end = 0;
    for (const std::uint32_t n : segments_) end += std::uint64_t{n} + 1;
    if (end != raw_.points.size() || end > 0xFFFF'FFFFU) {
      scalars_.refuse("its " + std::to_string(segments_.size()) + " strands need " + std::to_string(end) +
                      " vertices, it has " + std::to_string(raw_.points.size()));
    }
    for (const std::uint32_t n : segments_) raw_.offsets.push_back(raw_.offsets.back() + n + 1);
  }

  Header header_;
  Scalars scalars_;
  const std::string& where_;
  bool coloured_ = false, alpha_ = false, thick_ = false, textured_ = false;
  double colour_scale_ = 1.0;
  std::size_t translucent_ = 0;  // vertices
  std::vector<glm::vec3> colours_;
  std::vector<std::uint32_t> segments_;
  RawHair raw_;
};

std::uint8_t to_byte(float c) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0F, 1.0F) * 255.0F));
}

bool fits_byte(glm::vec3 c) {
  for (int k = 0; k < 3; ++k) {
    if (static_cast<float>(to_byte(c[k]) / 255.0) != c[k]) return false;
  }
  return true;
}

std::string make_header(const Strands& strands, bool thick) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment Pelage: metres, Y up\nelement vertex ";
  append_number(text, strands.vertices.size());
  text += "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!strands.colours.empty())
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
  if (thick) text += "property float thickness\n";
  text += "element strand ";
  append_number(text, strands.count());
  text += "\nproperty ushort nsegs\nelement edge ";
  append_number(text, strands.vertices.size() - strands.count());
  return text + "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
}

void append_vertices(std::string& out, const Strands& strands, bool thick) {
  for (std::size_t i = 0; i < strands.count(); ++i) {
    for (std::size_t k = strands.offsets[i]; k < strands.offsets[i + 1]; ++k) {
      append_bytes(out, strands.vertices[k]);
      if (!strands.colours.empty()) {
        const glm::vec3 c = strands.colours[i];
        append_bytes(out, std::array<std::uint8_t, 4>{to_byte(c.x), to_byte(c.y), to_byte(c.z), 255});
      }
      if (thick) append_bytes(out, diameter_at_m(strands, k));
    }
  }
}

void append_segments(std::string& out, const Strands& strands) {
  for (std::size_t i = 0; i < strands.count(); ++i)
    append_bytes(out, static_cast<std::uint16_t>(strands.strand(i).size() - 1));
  for (std::size_t i = 0; i < strands.count(); ++i) {
    for (std::uint32_t k = strands.offsets[i] + 1; k < strands.offsets[i + 1]; ++k)
      append_bytes(out, std::array<std::uint32_t, 2>{k - 1, k});
  }
}

}  // namespace

RawHair decode_ply(Bytes bytes, const std::string& where) {
  return BodyParser(HeaderParser(as_text(bytes), where).run(), bytes, where).run();
}

std::string encode_ply(const Strands& strands, Output& output) {
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::size_t n = strands.strand(i).size();
    if (n >= 1 && n <= kMaxSegments + 1) continue;
    throw OutputError(output.where, "strand " + std::to_string(i) + " has " + std::to_string(n) +
                                        " vertices, a strand PLY takes 1 to 65536: resample it (pelage convert "
                                        "--resample)");
  }
  if (!std::all_of(strands.colours.begin(), strands.colours.end(), fits_byte))
    output.report.lost.push_back("colour: rounded to 8 bits, as strand PLY has it");
  const bool thick = has_diameters(strands);
  std::string bytes = make_header(strands, thick);
  append_vertices(bytes, strands, thick);
  append_segments(bytes, strands);
  return bytes;
}

}  // namespace pelage::hair
