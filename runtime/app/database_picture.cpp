#include "pelage/app/database_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <numbers>
#include <numeric>

#include "pelage/db/density_grid.h"
#include "pelage/image/draw.h"

namespace pelage::app {
namespace {

constexpr int kWidth = 1440, kMargin = 24, kText = 14;
constexpr int kColumns = 8, kCardWidth = (kWidth - 2 * kMargin) / kColumns, kTile = 78, kCardHeight = 2 * kTile + 44;
constexpr int kPlot = 300, kPlotStep = 350;
constexpr draw::Colour kInk{.12F, .12F, .14F}, kFaint{.62F, .62F, .65F}, kRed{.85F, .15F, .12F},
    kOrange{.93F, .53F, .13F}, kBlue{.16F, .38F, .70F};
constexpr float kBrightest = 2.5F;  // reflectance shown as full: records have mean 1 over lights

using Value = std::function<float(float x, float y)>;  // both in [0, 1]

void tile(Image& image, glm::ivec2 corner, const Value& value) {
  for (int y = 0; y < kTile; ++y) {
    for (int x = 0; x < kTile; ++x) {
      const float v = value((static_cast<float>(x) + .5F) / kTile, (static_cast<float>(y) + .5F) / kTile);
      draw::fill(image, corner + glm::ivec2(x, y), {1, 1}, draw::ramp(v));
    }
  }
}

/// The record along s at a view angle, lit `offset` from the view.
struct Row {
  std::vector<float> tau, re;
};
Row row_of(const RecordBank& bank, std::size_t record, float view, float offset) {
  const auto n = static_cast<std::size_t>(bank.shape().samples);
  Row row{std::vector<float>(n), std::vector<float>(n)};
  bank.lookup(record, 0, {view, view, view + offset, view + offset}, row.tau, row.re);
  return row;
}

/// Views down, s across: opacity or reflectance.
void angle_tile(Image& image, glm::ivec2 corner, const RecordBank& bank, std::size_t record, float offset,
                bool opacity) {
  std::vector<Row> rows;
  for (int y = 0; y < kTile; ++y) {
    const float view = 2 * std::numbers::pi_v<float> * (static_cast<float>(y) + .5F) / kTile;
    rows.push_back(row_of(bank, record, view, offset));
  }
  tile(image, corner, [&](float x, float y) {
    const Row& row = rows[static_cast<std::size_t>(y * kTile)];
    const auto i = static_cast<std::size_t>(x * static_cast<float>(row.tau.size()));
    return opacity ? 1 - std::exp(-row.tau[i]) : row.re[i] / kBrightest;
  });
}

void strands_tile(Image& image, glm::ivec2 corner, const RecordBank& bank, std::size_t record) {
  const BakeSettings& settings = bank.metadata().settings;
  const DensityGrid grid = density_grid(bank.crossings(record), 64, settings.sigma);
  const double peak = 1 / (2 * std::numbers::pi * settings.sigma * settings.sigma);  // of one strand
  tile(image, corner, [&](float x, float y) {
    return static_cast<float>(grid.at(static_cast<int>((1 - y) * 63.99F), static_cast<int>(x * 63.99F)) / (1.5 * peak));
  });
}

void card(Image& image, glm::ivec2 corner, const RecordBank& bank, std::size_t record, const std::string& note) {
  draw::text(image, corner + glm::ivec2(0, kText), fmt::format("#{}, {}", record, note), 12, kInk);
  const glm::ivec2 at = corner + glm::ivec2(0, 22);
  constexpr int kStep = kTile + 4;
  strands_tile(image, at, bank, record);
  angle_tile(image, at + glm::ivec2(kStep, 0), bank, record, 0, true);
  angle_tile(image, at + glm::ivec2(0, kStep), bank, record, 0, false);
  angle_tile(image, at + glm::ivec2(kStep, kStep), bank, record, std::numbers::pi_v<float> / 2, false);
}

std::string strands_text(const RecordBank& bank, std::size_t record) {
  const std::size_t count = bank.crossings(record).size();
  return fmt::format("{} strand{}", count, count == 1 ? "" : "s");
}

/// Evenly from the sparsest to the densest (feature 0 of all sets is the mean density).
std::vector<std::uint32_t> from_sparse_to_dense(const RecordBank& bank, std::size_t count) {
  const std::size_t width = bank.features().size() / bank.size();
  std::vector<std::uint32_t> order(bank.size()), chosen;
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return bank.features()[a * width] < bank.features()[b * width]; });
  const std::size_t shown = std::min(count, order.size());
  for (std::size_t i = 0; i < shown; ++i)
    chosen.push_back(order[i * (order.size() - 1) / std::max<std::size_t>(shown - 1, 1)]);
  return chosen;
}

// --- diagrams --------------------------------------------------------------------------------------------------------

struct Axis {
  std::string name;
  float low = 0, high = 1;
  float place(float v) const { return (v - low) / (high - low); }
};

Axis axis_of(std::string name, std::span<const float> features, std::size_t width, std::size_t feature) {
  Axis axis{std::move(name), features[feature], features[feature]};
  for (std::size_t i = feature; i < features.size(); i += width) {
    axis.low = std::min(axis.low, features[i]);
    axis.high = std::max(axis.high, features[i]);
  }
  const float pad = std::max(.04F * (axis.high - axis.low), 1e-6F);
  axis.low -= pad;
  axis.high += pad;
  return axis;
}

void axes(Image& image, glm::ivec2 corner, const Axis& x, const Axis& y) {
  const glm::ivec2 bottom = corner + glm::ivec2(0, kPlot + 16);
  draw::text(image, bottom, fmt::format("{:.3g}", x.low), 12, kInk);
  const int half = static_cast<int>(3.6F * static_cast<float>(x.name.size()));  // of the name, about
  draw::text(image, bottom + glm::ivec2(kPlot / 2 - half, 0), x.name, 13, kInk);
  draw::text(image, bottom + glm::ivec2(kPlot - 30, 0), fmt::format("{:.3g}", x.high), 12, kInk);
  draw::text(image, corner + glm::ivec2(4, 16), fmt::format("{:.3g}  {}", y.high, y.name), 12, kInk);
  draw::text(image, corner + glm::ivec2(4, kPlot - 6), fmt::format("{:.3g}", y.low), 12, kInk);
}

struct Names {
  std::array<std::size_t, 3> features;
  std::array<const char*, 3> text;
};
Names names_of(FeatureSet set) {
  if (set == FeatureSet::profile11) return {{0, 1, 6}, {"mean density", "1st cosine along s", "1st cosine along r"}};
  return {{0, 1, 2}, {"mean density", "mean s", "mean r"}};
}

void scatter(Image& image, glm::ivec2 corner, const RecordBank& bank, const CoverageShown& c, std::size_t fx,
             std::size_t fy, const Names& names) {
  const std::span<const float> features = bank.features();
  const std::size_t width = features.size() / bank.size();
  std::vector<float> all(features.begin(), features.end());
  all.insert(all.end(), c.sector_features.begin(), c.sector_features.end());
  const Axis x = axis_of(names.text[fx], all, width, names.features[fx]);
  const Axis y = axis_of(names.text[fy], all, width, names.features[fy]);
  const auto place = [&](std::span<const float> row) {
    return glm::vec2(corner) +
           glm::vec2(kPlot * x.place(row[names.features[fx]]), kPlot * (1 - y.place(row[names.features[fy]])));
  };
  const float far = quantile(c.spacing, .95);
  for (std::size_t i = 0; i < c.sector_distances.size(); ++i) {
    const bool uncovered = c.sector_distances[i] > far;
    draw::disc(image, place({&c.sector_features[i * width], width}), uncovered ? 1.3F : .8F, uncovered ? kRed : kFaint,
               uncovered ? .8F : .25F);
  }
  std::vector<std::uint32_t> order = thinnest(c.spacing, bank.size());
  std::reverse(order.begin(), order.end());  // thin places on top
  for (const std::uint32_t i : order) {
    draw::disc(image, place(features.subspan(i * width, width)), 1.8F,
               draw::ramp(far > 0 ? .9F * c.spacing[i] / far : 0));
  }
  draw::frame(image, corner, {kPlot, kPlot}, kInk);
  axes(image, corner, x, y);
}

/// Shares of distances per bin, as bars from the bottom.
void histogram(Image& image, glm::ivec2 corner, const CoverageShown& c) {
  constexpr int kBins = 60, kBar = kPlot / kBins;
  Axis x{"distance to nearest record", 0, std::max(quantile(c.spacing, .995), quantile(c.sector_distances, .995))};
  if (!(x.high > 0)) x.high = 1;
  const auto shares = [&](const std::vector<float>& values) {
    std::array<float, kBins> bins{};
    for (const float v : values) {
      const int bin = std::clamp(static_cast<int>(x.place(v) * kBins), 0, kBins - 1);
      bins[static_cast<std::size_t>(bin)] += 1.0F / static_cast<float>(values.size());
    }
    return bins;
  };
  const auto records = shares(c.spacing), sectors = shares(c.sector_distances);
  const float top = 1.1F * std::max(*std::max_element(records.begin(), records.end()),
                                    *std::max_element(sectors.begin(), sectors.end()));
  const auto bars = [&](const std::array<float, kBins>& bins, int offset, int bar, draw::Colour colour) {
    for (int i = 0; i < kBins; ++i) {
      const int height = static_cast<int>(kPlot * bins[static_cast<std::size_t>(i)] / top);
      draw::fill(image, corner + glm::ivec2(i * kBar + offset, kPlot - height), {bar, height}, colour);
    }
  };
  const bool both = !c.sector_distances.empty();
  bars(records, 0, both ? kBar / 2 : kBar - 1, kBlue);
  if (both) bars(sectors, kBar / 2, kBar / 2, kOrange);
  draw::frame(image, corner, {kPlot, kPlot}, kInk);
  axes(image, corner, x, {"share", 0, top});
  draw::text(image, corner + glm::ivec2(110, 52), "last bar: that far or farther", 12, kFaint);
  draw::text(image, corner + glm::ivec2(110, 16), fmt::format("of the {} records", c.spacing.size()), 12, kBlue);
  if (both) {
    draw::text(image, corner + glm::ivec2(110, 34), fmt::format("of {} sectors", c.sector_distances.size()), 12,
               kOrange);
  }
}

}  // namespace

std::vector<std::uint32_t> thinnest(const std::vector<float>& spacing, std::size_t count) {
  std::vector<std::uint32_t> order(spacing.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return spacing[a] > spacing[b]; });
  order.resize(std::min(count, order.size()));
  return order;
}

Image draw_database(const RecordBank& bank, const std::string& name, const CoverageShown& c) {
  constexpr int kRows = 3, kCardsTop = 84;
  constexpr int kPlotsTop = kCardsTop + kRows * kCardHeight + 2 * 30 + 20;
  Image image(kWidth, kPlotsTop + kPlot + 40);
  draw::fill(image, {0, 0}, {image.width, image.height}, {1, 1, 1});
  draw::text(image, {kMargin, 30}, fmt::format("{}: {} records", name, bank.size()), 18, kInk);
  draw::text(image, {kMargin, 54},
             fmt::format("Each card: density of strands (s right, r up) and opacity; below, reflectance lit from the "
                         "viewer and from 90 degrees aside (s right, view angle down). Opacity 0 to 1, reflectance 0 "
                         "to {}, dark to light.",
                         kBrightest),
             13, kInk);
  draw::text(image, {kMargin, kCardsTop}, "From sparse to dense", 15, kInk);
  int y = kCardsTop + 8;
  const auto cards = [&](const std::vector<std::uint32_t>& records,
                         const std::function<std::string(std::uint32_t)>& note) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      if (i > 0 && i % kColumns == 0) y += kCardHeight;
      card(image, {kMargin + static_cast<int>(i % kColumns) * kCardWidth, y}, bank, records[i], note(records[i]));
    }
    y += kCardHeight;
  };
  cards(from_sparse_to_dense(bank, 2 * kColumns), [&](auto record) { return strands_text(bank, record); });
  draw::text(image, {kMargin, y + 22},
             "Thin places: the records farthest from any other, with that distance in standard deviations per feature",
             15, kInk);
  y += 30;
  cards(thinnest(c.spacing, kColumns),
        [&](auto record) { return fmt::format("{}, {:.2f}", strands_text(bank, record), c.spacing[record]); });
  draw::text(
      image, {kMargin, kPlotsTop - 14},
      c.hairstyle.empty()
          ? "Feature coverage: each record's place, light where the next one is far"
          : fmt::format("Feature coverage: each record's place, light where the next one is far; sectors of {} grey, "
                        "red where farther from any record than 95 % of the records from each other",
                        c.hairstyle),
      15, kInk);
  const Names names = names_of(bank.metadata().settings.features);
  const auto at = [&](int i) { return glm::ivec2(kMargin + i * kPlotStep, kPlotsTop); };
  scatter(image, at(0), bank, c, 0, 1, names);
  scatter(image, at(1), bank, c, 0, 2, names);
  scatter(image, at(2), bank, c, 1, 2, names);
  histogram(image, at(3), c);
  return image;
}

}  // namespace pelage::app
