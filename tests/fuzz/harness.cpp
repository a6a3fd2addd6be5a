#include "harness.h"

#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

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
    Harness{"hair", read_hair, hair_seeds},
    Harness{"tfx4", read_tfx, tfx4_seeds},
    Harness{"tfx2", read_tfx},
    Harness{"tfxbone", read_tfxbone},
    Harness{"data", read_data, data_seeds},
    Harness{"ply", read_ply, ply_seeds},
    Harness{"obj_strands", read_obj_strands, obj_strands_seeds},
    Harness{"usda", read_usda, usda_seeds},
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

// C streams: C++ ones swallow what their own allocations throw, and tests/faults lets those fail.
struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

fs::path scratch(std::string_view name, std::string_view bytes) {
  fs::path path = scratch(name);
  const File file(std::fopen(path.c_str(), "wb"));
  const bool written =
      file && (bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size());
  if (!written) throw std::runtime_error("cannot write " + path.string());
  return path;
}

std::string bytes_of(const fs::path& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  std::string bytes(fs::file_size(path), '\0');
  if (!file || std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    throw std::runtime_error("cannot read " + path.string());
  return bytes;
}

}  // namespace pelage::fuzz
