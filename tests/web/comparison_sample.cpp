// Writes two pages of `pelage compare` from made-up results, for compare_page_test.py: <folder>/still.html and
// <folder>/moving.html. A pixel's red is 2 x, its green 2 y, its blue 20 times the method's number in the list: a
// screenshot says which pixel of which method is seen where. Maps have blue + 5 (error) and + 10 (FLIP).
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "pelage/app/comparison_page.h"
#include "pelage/image/image_file.h"
#include "pelage/image/tone.h"

namespace {

using namespace pelage;
using app::ComparedMethod;
using app::Comparison;

constexpr int kWidth = 120, kHeight = 90;
constexpr const char* kHostile = "</script><img src=x onerror=\"document.title='ran'\"> & 'hair' {{scene}} \xFF";

Image coded_picture(int blue) {
  Image image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float* p = image.pixel(x, y);
      p[0] = srgb_decode(static_cast<float>(2 * x) / 255);
      p[1] = srgb_decode(static_cast<float>(2 * y) / 255);
      p[2] = srgb_decode(static_cast<float>(blue) / 255);
      p[3] = 1;
    }
  }
  return image;
}

ComparedMethod method(const std::string& id, const std::string& title, double rmse, double first_ms) {
  ComparedMethod m;
  m.id = id;
  m.title = title;
  m.what = "What " + title + " does, in a sentence.";
  m.command = "pelage render 'hair <1>.json' --method " + id;
  m.error = {rmse, -rmse / 3, rmse * rmse, -20 * std::log10(rmse), 2 * rmse, 10 * rmse, 1.5 * rmse};
  m.stages = {
      {"read", first_ms / 4, 1000, 1}, {"voxels & <density>", first_ms / 2, 1000, 1}, {"draw", first_ms / 4, 9, 1}};
  m.prepare_ms = 3;
  m.first_ms = first_ms;
  m.again_ms = first_ms / 3;
  m.bytes = static_cast<std::uint64_t>(first_ms * 1e5);
  return m;
}

std::vector<ComparedMethod> methods() {
  std::vector<ComparedMethod> list{method("truth", "Ray-traced truth", 0, 52'000.5)};
  list.push_back(method("satf", "SATF, generic records", 0.021, 9.5));
  list.push_back(method("density-map", "Density map, corrected", 0.1034, 100.25));
  list.push_back(method("density-map-printed", kHostile, 9e-5, 88));
  list.push_back(method("deep-opacity", "Deep opacity maps", 0.0102, 31));
  list.push_back(method("broken", "A method that fails", 0, 0));
  list.push_back(method("opacity-shadow", "Opacity shadow maps", 0.0021, 1024));
  list.push_back(method("none", "No self-shadow", 0.31, 2));
  list[0].error.psnr_db = std::numeric_limits<double>::infinity();
  list[4].error.psnr_db = std::numeric_limits<double>::quiet_NaN();
  list[5].failed = "OpenGL 4.5 is <not> here";
  return list;
}

void write_pictures(std::vector<ComparedMethod>& list, const std::filesystem::path& folder) {
  int blue = 0;
  for (ComparedMethod& m : list) {
    if (!m.failed.empty()) continue;
    m.picture = m.id + ".png";
    write_image(coded_picture(blue), folder / m.picture, {});
    if (m.id != "truth") {
      m.error_map = m.id + "-error.png";
      m.flip_map = m.id + "-flip.png";
      write_image(coded_picture(blue + 5), folder / m.error_map, {});
      write_image(coded_picture(blue + 10), folder / m.flip_map, {});
    }
    blue += 20;
  }
}

void move(Comparison& comparison) {
  comparison.fps = 30;
  comparison.flicker_noise = 0.0005;
  for (ComparedMethod& m : comparison.methods) {
    if (!m.failed.empty()) continue;
    for (int i = 0; i < 40; ++i) {
      app::ComparedFrame f{m.error, i == 0 ? 0 : 0.2 * m.error.rmse * (1 + std::sin(1.7 * i)), m.again_ms};
      f.error.rmse *= 1 + 0.3 * std::sin(0.2 * i);
      f.error.flip *= 1 + 0.3 * std::cos(0.15 * i);
      m.frames.push_back(f);
    }
    m.flicker = 0.2 * m.error.rmse;
  }
}

void write(const Comparison& comparison, const std::filesystem::path& folder, const char* name) {
  std::ofstream(folder / name, std::ios::binary) << app::comparison_page(comparison, folder);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return std::fputs("comparison_sample FOLDER\n", stderr), 2;
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  Comparison comparison;
  comparison.name = kHostile;
  comparison.command = fmt::format("pelage compare '{}' -o out", kHostile);
  comparison.scene = fmt::format("{{\n  \"hair\": \"{}\"\n}}", kHostile);
  comparison.revision = "0123abc";
  comparison.cpu = "A processor";
  comparison.threads = 2;
  comparison.width = kWidth;
  comparison.height = kHeight;
  comparison.truth_samples = 256;
  comparison.truth_noise = {0.0023, 0.0001, 1e-5, 50, 0.009, 0.1, 0.004};
  comparison.methods = methods();
  write_pictures(comparison.methods, folder);
  write(comparison, folder, "still.html");
  move(comparison);
  write(comparison, folder, "moving.html");
}
