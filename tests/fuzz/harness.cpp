#include "harness.h"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace pelage::fuzz {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "pelage-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    path_ = name;
  }
  ~Folder() {
    std::error_code none;
    fs::remove_all(path_, none);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path operator/(std::string_view name) const { return path_ / name; }

 private:
  fs::path path_;
};

constexpr std::array kHarnesses = {
    Harness{"hair", read_hair},
    Harness{"tfx4", read_tfx4},
    Harness{"obj_mesh", read_obj_mesh},
    Harness{"json_scene", read_json_scene},
    Harness{"json_hairstyle", read_json_hairstyle},
    Harness{"json_bake", read_json_bake},
    Harness{"database", read_database, database_seeds},
};

}  // namespace

std::span<const Harness> harnesses() {
  return kHarnesses;
}

fs::path scratch(std::string_view name) {
  static const Folder folder;
  return folder / name;
}

fs::path scratch(std::string_view name, std::string_view bytes) {
  fs::path file = scratch(name);
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace pelage::fuzz
