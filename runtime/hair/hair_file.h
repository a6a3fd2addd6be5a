// Hair files, read by content (by extension where a format has no magic) and written by extension:
//   HAIR (Cem Yuksel), TFX 4 (AMD TressFX), USC-HairSalon .data, strand PLY (hairutil's layout), OBJ polylines, USD
//   text with BasisCurves (the groom_* names that Unreal reads); TFX 2 text and CT2Hair .bin are read only.
//
// A bad strand is repaired or dropped, counted and named by its index in the file; it does not reject the file. A file
// whose structure is wrong (truncated, sizes that contradict each other, another dialect) is refused with the reason,
// and no size field makes the reader allocate more than the file's own bytes warrant.
//
// Of these only USD stores a unit and an up axis; for the others ReadOptions says them. Thickness is read as a diameter
// in the file's unit. A writer stores what Strands holds and no more, in metres, Y up, so that reading the file gives
// the same Strands bit for bit: what the format has no place for is told in WriteReport, and what it cannot do without
// is refused with the remedy. (Readers drop strands of fewer than two vertices and say one diameter for all only once.)
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace pelage::hair {

/// Which axis of the file points up. Converted by a right-handed rotation: z: (x, y, z) -> (x, z, -y); x: -> (-y, x,
/// z).
enum class UpAxis { x, y, z };

/// What the file's vertices are: points of a polyline, or control points of a uniform cubic B-spline (fur.hair), which
/// is evaluated to two vertices per control point. A strand of fewer than 4 points is a polyline either way.
enum class Curve { polyline, b_spline };

struct ReadOptions {
  double metres_per_unit = 1.0;  // > 0
  UpAxis up = UpAxis::y;
  Curve curve = Curve::polyline;
  bool check_unit = true;  // refuse a median strand shorter than 3 mm or longer than 3 m
};

/// A strand that was not taken as it is.
struct StrandIssue {
  std::size_t strand;  // index in the file
  bool dropped;        // otherwise repaired
  std::string reason;
};

constexpr std::size_t kMaxIssues = 10'000;  // that are kept one by one: a file of rubbish has millions

struct ReadReport {
  std::string format;  // "HAIR", "TFX 4", ...
  std::size_t strands_in_file = 0;
  std::vector<StrandIssue> issues{};                        // in order of strand, the first kMaxIssues
  std::size_t dropped_unlisted = 0, repaired_unlisted = 0;  // those behind them
  std::vector<std::string> notes{};  // about the file as a whole: what was not believed, not read, not kept
  std::optional<float> opacity{};    // of a fibre, in (0, 1], where the file says so
  double metres_per_unit = 1.0;      // as used: the option's, or the file's own

  std::size_t dropped() const noexcept;  // all of them
  std::size_t repaired() const noexcept;
};

/// "m", "cm", "mm", "in", or a number of metres per unit: "0.00254". @throws UsageError
double parse_unit(std::string_view text);
/// "x", "y", "z". @throws UsageError
UpAxis parse_up_axis(std::string_view text);
/// "polyline", "bspline". @throws UsageError
Curve parse_curve(std::string_view text);

/// @throws InputError naming the file, what is wrong and the remedy; UsageError for options that make no sense
Strands read_hair(const std::filesystem::path& file, const ReadOptions& options = {}, ReadReport* report = nullptr);

/// The same from memory; `where` names the file in messages.
Strands parse_hair(std::span<const std::byte> bytes, const std::string& where, const ReadOptions& options = {},
                   ReadReport* report = nullptr);

struct WriteReport {
  std::string format{};
  std::vector<std::string> lost{};   // what the format has no place for, a sentence each
  std::vector<std::string> notes{};  // what other programs will make of the file
};

/// Writes the format that the extension names, atomically (temporary file, then rename). Metres, Y up.
/// @param opacity  of a fibre, where it is known
/// @throws UsageError for an extension that is none of them; OutputError for strands that the format cannot take
WriteReport write_strands(const Strands& strands, const std::filesystem::path& file, std::optional<float> opacity = {});

/// The bytes that write_strands would write.
std::string format_strands(const Strands& strands, const std::filesystem::path& file, std::optional<float> opacity = {},
                           WriteReport* report = nullptr);

/// Does the extension name a format that can be written? @throws UsageError listing them
void check_hair_output(const std::filesystem::path& file);

/// Writes HAIR, whatever the extension. @throws OutputError
void write_hair(const Strands& strands, const std::filesystem::path& file);

/// What is odd about a median strand of this length, with the unit that would make it plausible; empty: nothing.
std::string implausible_unit(double median_length_m, double metres_per_unit);

}  // namespace pelage::hair
