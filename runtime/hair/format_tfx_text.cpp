// TFX 2 (AMD TressFX 2), text: settings, one a line, then per strand `strand i numVerts n texcoord u v` and n lines
// `x, y, z`. The transform among the settings is what the sample applied when it placed the hair; it is told, not used.
#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

class TfxTextParser {
 public:
  TfxTextParser(Bytes bytes, const std::string& where) : lines_(text_of(bytes)), where_(where) {}

  RawHair run() {
    raw_.format = "TFX 2";
    while (!lines_.at_end()) parse_line(Words(lines_.next(), kSeparators));
    const std::size_t found = raw_.offsets.size() - 1;
    if (promised_ > found) {
      throw InputError(where_, "TFX 2 text says " + std::to_string(promised_) + " strands and holds " +
                                   std::to_string(found) + ": truncated; fetch or export it again");
    }
    if (textured_ > 0) raw_.notes.push_back(texture_note(textured_));
    return std::move(raw_);
  }

 private:
  static constexpr std::string_view kSeparators = " \t,";

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(
        where_, "TFX 2 text, line " + std::to_string(lines_.number()) + ": " + what + ": fetch or export it again");
  }

  void parse_line(Words words) {
    const std::string_view keyword = words.next();
    if (keyword == "version") check_version(words.next());
    if (keyword == "numStrands") promised_ = count(words.next());
    if (keyword == "scale") note_unless(keyword, words, 1.0F);
    if (keyword == "rotation" || keyword == "translation") note_unless(keyword, words, 0.0F);
    if (keyword == "strand") parse_strand(words);
  }

  void check_version(std::string_view word) {
    const std::optional<float> version = parse_float(word);
    if (!version || !(*version >= 1.0F && *version < 3.0F)) {
      refuse("version \"" + std::string(word) + "\", this build reads 2 as text and 4 as binary");
    }
  }

  std::uint64_t count(std::string_view word) {
    const std::optional<std::uint64_t> value = parse_integer<std::uint64_t>(word);
    if (!value) refuse("\"" + std::string(word) + "\" is no count");
    return *value;
  }

  void note_unless(std::string_view keyword, Words& words, float neutral) {
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      if (parse_float(word) == neutral) continue;
      raw_.notes.push_back("the file's " + std::string(keyword) + " is not applied");
      return;
    }
  }

  void parse_strand(Words& words) {
    words.next();  // its index
    if (words.next() != "numVerts") refuse("a strand without numVerts");
    const std::uint64_t vertices = count(words.next());
    if (words.next() == "texcoord") ++textured_;
    for (std::uint64_t k = 0; k < vertices; ++k) {
      if (lines_.at_end()) refuse("ends inside strand " + std::to_string(raw_.offsets.size() - 1));
      parse_vertex(Words(lines_.next(), kSeparators));
    }
    end_strand(raw_, where_);
  }

  void parse_vertex(Words words) {
    glm::vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words.next();
      const std::optional<float> value = parse_float(word);
      if (!value) refuse("\"" + std::string(word) + "\" is no number");
      p[k] = *value;
    }
    raw_.points.push_back(p);
  }

  Lines lines_;
  const std::string& where_;
  std::uint64_t promised_ = 0;
  std::size_t textured_ = 0;  // strands with texture coordinates
  RawHair raw_;
};

}  // namespace

RawHair decode_tfx_text(Bytes bytes, const std::string& where) {
  return TfxTextParser(bytes, where).run();
}

}  // namespace pelage::hair
