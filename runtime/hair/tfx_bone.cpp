#include "pelage/hair/tfx_bone.h"

#include <cmath>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/input_file.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kStrandBytes = 36;    // i32 strand, 4 x { i32 bone, f32 weight }
constexpr std::size_t kLeastBoneBytes = 9;  // i32 index, i32 length, the NUL

class BoneParser {
 public:
  BoneParser(Bytes bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  TfxBones run() {
    read_names();
    read_strands();
    if (at_ != bytes_.size()) refuse(std::to_string(bytes_.size() - at_) + " bytes after the last strand");
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(where_, ".tfxbone, byte " + std::to_string(at_) + ": " + what +
                                 ": truncated or damaged; fetch or export it again");
  }

  std::size_t left() const noexcept { return bytes_.size() - at_; }

  std::int32_t integer() {
    if (left() < 4) refuse("ends in the middle");
    at_ += 4;
    return load<std::int32_t>(bytes_, at_ - 4);
  }

  /// A count of things of at least `each` bytes, which the rest of the file must hold.
  std::size_t count(const char* things, std::size_t each) {
    const std::int64_t n = integer();
    if (n < 0 || static_cast<std::size_t>(n) > left() / each) {
      refuse(std::to_string(n) + " " + things + " do not fit into the file of " + std::to_string(bytes_.size()) +
             " bytes");
    }
    return static_cast<std::size_t>(n);
  }

  /// An index below `size`, not seen before.
  std::size_t new_index(const char* thing, std::vector<bool>& seen) {
    const std::int64_t i = integer();
    if (i < 0 || static_cast<std::size_t>(i) >= seen.size() || seen[static_cast<std::size_t>(i)]) {
      refuse(std::string(thing) + " " + std::to_string(i) + " is none of the " + std::to_string(seen.size()) +
             ", or comes twice");
    }
    seen[static_cast<std::size_t>(i)] = true;
    return static_cast<std::size_t>(i);
  }

  void read_names() {
    std::vector<bool> seen(count("bones", kLeastBoneBytes));
    result_.names.resize(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const std::size_t bone = new_index("bone", seen);
      const std::size_t length = count("characters of a bone's name", 1);
      const std::string_view name = as_text(bytes_.subspan(at_, length));
      result_.names[bone] = name.substr(0, name.find('\0'));
      at_ += length;
    }
  }

  void read_strands() {
    std::vector<bool> seen(count("strands", kStrandBytes));
    result_.strands.resize(seen.size());
    for (std::size_t k = 0; k < seen.size(); ++k) read_strand(new_index("strand", seen));
  }

  void read_strand(std::size_t strand) {
    std::array<std::int32_t, 4> bones{};
    std::array<double, 4> weights{};
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      bones[k] = integer();
      const auto weight = static_cast<double>(load_weight());
      weights[k] = weight > 0 && std::isfinite(weight) ? weight : 0.0;
      sum += weights[k];
    }
    if (!(sum > 0)) {
      const bool usable = bones[0] >= 0 && static_cast<std::size_t>(bones[0]) < result_.names.size();
      bones = {usable ? bones[0] : 0, 0, 0, 0};
      weights = {1.0, 0.0, 0.0, 0.0};
      sum = 1.0;
      result_.repaired.push_back(strand);
    }
    if (std::abs(sum - 1.0) > std::abs(result_.farthest_sum - 1.0)) result_.farthest_sum = sum;
    store(strand, bones, weights, sum);
  }

  float load_weight() {
    if (left() < 4) refuse("ends in the middle");
    at_ += 4;
    return load<float>(bytes_, at_ - 4);
  }

  void store(std::size_t strand, const std::array<std::int32_t, 4>& bones, const std::array<double, 4>& weights,
             double sum) {
    StrandBones& out = result_.strands[strand];
    for (std::size_t k = 0; k < 4; ++k) {
      if (weights[k] == 0) continue;
      if (bones[k] < 0 || static_cast<std::size_t>(bones[k]) >= result_.names.size()) {
        refuse("strand " + std::to_string(strand) + " hangs on bone " + std::to_string(bones[k]) + " of " +
               std::to_string(result_.names.size()));
      }
      out.bones[k] = static_cast<std::uint32_t>(bones[k]);
      out.weights[k] = static_cast<float>(weights[k] / sum);
    }
  }

  Bytes bytes_;
  const std::string& where_;
  std::size_t at_ = 0;
  TfxBones result_;
};

}  // namespace

TfxBones parse_tfxbone(std::span<const std::byte> bytes, const std::string& where) {
  return BoneParser(bytes, where).run();
}

TfxBones read_tfxbone(const std::filesystem::path& file) {
  return parse_tfxbone(read_bytes(file), file.string());
}

}  // namespace pelage::hair
