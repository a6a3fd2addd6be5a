#include "pelage/db/literal_key_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pelage/data_schema/errors.h"
#include "pelage/db/database_source.h"

namespace pelage {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;
constexpr std::size_t kAngleTerms = 4;  // cos, sin of view and light
constexpr std::size_t kCopies = 3;      // of the keys that the search holds
constexpr std::size_t kMostBytes = std::size_t{2} << 30;

std::size_t feature_count(const RecordBank& bank) {
  return static_cast<std::size_t>(dimension(bank.metadata().settings.features));
}

std::size_t key_bytes(const RecordBank& bank) {
  const auto directions = static_cast<std::size_t>(bank.shape().views) * static_cast<std::size_t>(bank.shape().lights);
  return bank.size() * directions * (feature_count(bank) + kAngleTerms) * sizeof(float) * kCopies;
}

float angle_of(int index, int count) {
  return kTurn * static_cast<float>(index) / static_cast<float>(count);
}

void angle_terms(float angle, float* out) {
  out[0] = std::numbers::sqrt2_v<float> * std::cos(angle);
  out[1] = std::numbers::sqrt2_v<float> * std::sin(angle);
}

/// [record][view][light][features, cos and sin of view and of light]
std::vector<float> keys_of(const RecordBank& bank) {
  if (key_bytes(bank) > kMostBytes)
    throw InputError("literal key", std::to_string(bank.size()) + " records of " + std::to_string(bank.shape().views) +
                                        " x " + std::to_string(bank.shape().lights) + " angles take " +
                                        std::to_string(key_bytes(bank) >> 20) +
                                        " MiB to search, at most 2048 are used: bake fewer (bake.sectors, bake.views, "
                                        "bake.lights)");
  const std::size_t n = feature_count(bank);
  std::vector<float> features(bank.features().begin(), bank.features().end()), keys;
  bank.feature_scale().apply(features);
  keys.reserve(key_bytes(bank) / sizeof(float) / kCopies);
  std::array<float, kAngleTerms> angles;
  for (std::size_t record = 0; record < bank.size(); ++record)
    for (int view = 0; view < bank.shape().views; ++view)
      for (int light = 0; light < bank.shape().lights; ++light) {
        const auto first = features.begin() + static_cast<std::ptrdiff_t>(record * n);
        keys.insert(keys.end(), first, first + static_cast<std::ptrdiff_t>(n));
        angle_terms(angle_of(view, bank.shape().views), angles.data());
        angle_terms(angle_of(light, bank.shape().lights), angles.data() + 2);
        keys.insert(keys.end(), angles.begin(), angles.end());
      }
  return keys;
}

}  // namespace

LiteralKeySource::LiteralKeySource(std::shared_ptr<const RecordBank> bank)
    : bank_(std::move(bank)), index_(keys_of(*bank_), static_cast<int>(feature_count(*bank_) + kAngleTerms)) {}

std::size_t LiteralKeySource::bytes() const noexcept {
  return key_bytes(*bank_) + bank_->bytes();
}

void LiteralKeySource::attach(const SectorSet& sectors) {
  const BakeSettings& baked = bank_->metadata().settings;
  const std::size_t n = feature_count(*bank_);
  features_ = density_features(sectors, baked.features, baked.grid, baked.sigma);
  empty_.resize(sectors.size());
  for (std::size_t i = 0; i < sectors.size(); ++i) empty_[i] = !(features_[i * n] >= kEmptyDensity);
  bank_->feature_scale().apply(features_);
}

std::optional<LiteralKeySource::Entry> LiteralKeySource::nearest(std::size_t sector, float view, float light) const {
  if (empty_[sector]) return std::nullopt;
  const std::size_t n = feature_count(*bank_);
  std::array<float, kMaxDimension + kAngleTerms> key;
  std::copy_n(features_.begin() + static_cast<std::ptrdiff_t>(sector * n), n, key.begin());
  angle_terms(view, &key[n]);
  angle_terms(light, &key[n + 2]);
  ++searches_;
  const std::uint32_t entry = index_.nearest({key.data(), n + kAngleTerms}, 1).front().record;
  const auto lights = static_cast<std::uint32_t>(bank_->shape().lights);
  const std::uint32_t row = entry / lights, views = static_cast<std::uint32_t>(bank_->shape().views);
  return Entry{row / views, static_cast<int>(row % views), static_cast<int>(entry % lights)};
}

void LiteralKeySource::evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                                std::span<float> re) const noexcept {
  const auto n = static_cast<std::size_t>(samples());
  const std::optional<Entry> entry =
      nearest(sector, 0.5F * (angles.view_first + angles.view_last), 0.5F * (angles.light_first + angles.light_last));
  if (!entry) {
    std::fill_n(tau.begin(), n, 0.0F);
    std::fill_n(re.begin(), re.empty() ? 0 : n, 1.0F);
    return;
  }
  const float view = angle_of(entry->view, bank_->shape().views), light = angle_of(entry->light, bank_->shape().lights);
  bank_->lookup(entry->record, 0, {view, view, light, light}, tau, re);
}

}  // namespace pelage
