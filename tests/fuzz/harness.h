// Fuzz harnesses: one function per reader that takes any bytes. It returns when the reader refuses them with a typed
// error or when what it returns keeps the reader's promises (data_schema/*.h, hair/*.h, db/database.h: finite, in
// range, consistent, the same when written and read again). Anything else leaves it as an exception: Broken, or what
// the reader threw. libFuzzer (fuzz_main.cpp) and GoogleTest (replay.cpp) run the same functions.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "pelage/data_schema/errors.h"

namespace pelage::fuzz {

struct Harness {
  std::string_view name;  // of its corpus folder too
  void (*run)(std::string_view bytes);
  /// Inputs that are made rather than kept, because they follow the program's version; may be null.
  std::vector<std::string> (*seeds)() = nullptr;
};

std::span<const Harness> harnesses();

/// A reader accepted something and broke a promise.
class Broken : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};
inline void require(bool kept, const char* promise) {
  if (!kept) throw Broken(promise);
}

/// What `read` returns, or nothing where it refuses its input; every other exception passes.
template <class Read>
auto accepted(const Read& read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

/// A file in a folder of this process's own, under TMPDIR.
std::filesystem::path scratch(std::string_view name);
/// The same, holding `bytes`.
std::filesystem::path scratch(std::string_view name, std::string_view bytes);
std::string bytes_of(const std::filesystem::path& file);

void read_hair(std::string_view bytes);
void read_tfx(std::string_view bytes);
void read_data(std::string_view bytes);
void read_ply(std::string_view bytes);
void read_obj_strands(std::string_view bytes);
void read_usda(std::string_view bytes);
/// Three strands as this version writes them.
std::vector<std::string> hair_seeds();
std::vector<std::string> tfx4_seeds();
std::vector<std::string> data_seeds();
std::vector<std::string> ply_seeds();
std::vector<std::string> obj_strands_seeds();
std::vector<std::string> usda_seeds();
void read_tfxbone(std::string_view bytes);
void read_obj_mesh(std::string_view bytes);
void read_json_scene(std::string_view bytes);
void read_json_hairstyle(std::string_view bytes);
void read_json_bake(std::string_view bytes);
void read_database(std::string_view bytes);
std::vector<std::string> database_seeds();

}  // namespace pelage::fuzz
