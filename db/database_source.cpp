#include "pelage/db/database_source.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/numeric.h"
#include "pelage/db/nearest_sectors.h"

namespace pelage {
namespace {

constexpr int kMaxNeighbours = 8;
constexpr int kMaxSamples = 256;
constexpr int kCandidates = 4;                                             // nearest records tried per plate
constexpr int kBeam = 16;                                                  // sequences kept per plate
constexpr float kTriedShifts[] = {0, -0.0625F, 0.0625F, -0.125F, 0.125F};  // 0: as the search found it
constexpr float kJumpWeight = 0.3F;
constexpr std::uint32_t kNobody = 0xFFFFFFFFU;

using Pick = DatabaseSource::Pick;

/// Records blended in one sector.
using Team = std::array<Pick, kMaxNeighbours>;

struct State {
  int team;     // index into the track's teams
  float shift;  // of the team's records
  float cost;   // of the best sequence that ends here
  int parent;   // in the previous plate's beam
};

float fraction(float x) {
  return x - std::floor(x);
}

/// Linear interpolation in a periodic row of n values at position `at` (in values).
struct Periodic {
  int first, second;
  float beyond;
};
Periodic periodic(float position, int n) {
  const float whole = std::floor(position);
  const int first = ((static_cast<int>(whole) % n) + n) % n;
  return {first, first + 1 == n ? 0 : first + 1, position - whole};
}

}  // namespace

struct DatabaseSource::Catalogue {
  const RecordBank& bank;
  FeatureSet set;
  int dimensions, samples, rolls, neighbours;
  FeatureScale scale;
  NearestSectors index;
  std::vector<float> rolled;    // [record][roll][dimension] scaled features after a shift of roll / rolls
  std::vector<float> profiles;  // [record][sample] tau seen along r
  std::vector<float> hat;       // [sample] weight of the sector's window, divided by the mean squared profile

  Catalogue(const RecordBank& records, FeatureSet features, int blended, bool coherent)
      : bank(records),
        set(features),
        dimensions(dimension(features)),
        samples(records.shape().samples),
        rolls(records.metadata().settings.grid),
        neighbours(blended),
        index(points(), dimensions) {
    if (coherent) tabulate();
  }

  /// Scaled features of all records; sets `scale`.
  std::vector<float> points() {
    const BakeSettings& baked = bank.metadata().settings;
    std::vector<float> features(bank.features().begin(), bank.features().end());
    scale = bank.feature_scale();
    if (set != baked.features) {
      const auto n = static_cast<std::size_t>(dimensions);
      features.resize(bank.size() * n);
      tbb::parallel_for(std::size_t{0}, bank.size(), [&](std::size_t i) {
        density_features(projections(bank.crossings(i), baked.grid, baked.sigma), set,
                         std::span(features).subspan(i * n, n));
      });
      scale = fit_scale(features, dimensions);
    }
    scale.apply(features);
    return features;
  }

  void tabulate() {
    const auto n = static_cast<std::size_t>(dimensions);
    const BakeSettings& baked = bank.metadata().settings;
    rolled.resize(bank.size() * static_cast<std::size_t>(rolls) * n);
    profiles.resize(bank.size() * static_cast<std::size_t>(samples));
    tbb::parallel_for(std::size_t{0}, bank.size(), [&](std::size_t i) {
      Projections p = projections(bank.crossings(i), baked.grid, baked.sigma);
      for (int roll = 0; roll < rolls; ++roll) {
        const auto row =
            std::span(rolled).subspan((i * static_cast<std::size_t>(rolls) + static_cast<std::size_t>(roll)) * n, n);
        density_features(p, set, row);
        scale.apply(row);
        std::rotate(p.along_s.begin(), p.along_s.end() - 1, p.along_s.end());
      }
      for (int x = 0; x < samples; ++x) {
        profiles[i * static_cast<std::size_t>(samples) + static_cast<std::size_t>(x)] = bank.tau(i, 0, x);
      }
    });
    double power = 0;
    for (const float v : profiles) power += static_cast<double>(v) * static_cast<double>(v);
    power = std::max(power / static_cast<double>(bank.size()), 1e-30);  // 1e-30: all records empty
    for (int x = 0; x < samples; ++x) {
      const double s = (x + 0.5) / samples;
      hat.push_back(static_cast<float>(2 * (1 - std::abs(2 * s - 1)) / power));
    }
  }

  Team team_of(std::span<const Neighbour> nearest) const {
    Team team{};
    float total = 0;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      team[i] = {nearest[i].record, 1.0F / std::max(std::sqrt(nearest[i].distance_sq), 1e-6F)};
      total += team[i].weight;
    }
    for (std::size_t i = 0; i < nearest.size(); ++i) team[i].weight /= total;
    return team;
  }

  float feature_cost(const Team& team, float shift, const float* wanted) const {
    std::array<float, kMaxDimension> mean{};
    const Periodic at = periodic(fraction(shift) * static_cast<float>(rolls), rolls);
    for (int i = 0; i < neighbours; ++i) {
      const Pick& pick = team[static_cast<std::size_t>(i)];
      const float* base =
          rolled.data() + static_cast<std::size_t>(pick.record) * static_cast<std::size_t>(rolls * dimensions);
      const float* a = base + at.first * dimensions;
      const float* b = base + at.second * dimensions;
      for (int d = 0; d < dimensions; ++d) {
        mean[static_cast<std::size_t>(d)] += pick.weight * (a[d] + at.beyond * (b[d] - a[d]));
      }
    }
    float sum = 0;
    for (int d = 0; d < dimensions; ++d) {
      const float diff = mean[static_cast<std::size_t>(d)] - wanted[d];
      sum += diff * diff;
    }
    return sum / static_cast<float>(dimensions);
  }

  void profile(const Team& team, float shift, float* out) const {
    std::fill(out, out + samples, 0.0F);
    const Periodic at = periodic(fraction(-shift) * static_cast<float>(samples), samples);
    for (int i = 0; i < neighbours; ++i) {
      const Pick& pick = team[static_cast<std::size_t>(i)];
      const float* row = profiles.data() + static_cast<std::size_t>(pick.record) * static_cast<std::size_t>(samples);
      int a = at.first, b = at.second;
      for (int x = 0; x < samples; ++x) {
        out[x] += pick.weight * (row[a] + at.beyond * (row[b] - row[a]));
        a = b;
        b = b + 1 == samples ? 0 : b + 1;
      }
    }
  }

  float jump(const float* a, const float* b) const {
    float sum = 0;
    for (int x = 0; x < samples; ++x) {
      sum += hat[static_cast<std::size_t>(x)] * (a[x] - b[x]) * (a[x] - b[x]);
    }
    return sum;
  }

  /// Teams of a plate: the nearest, the next nearest, ..; with blending, the k nearest from each of these on.
  std::vector<Team> candidates(std::span<const float> wanted, int count) const {
    const std::vector<Neighbour> nearest = index.nearest(wanted, count + neighbours - 1);
    std::vector<Team> teams;
    for (std::size_t i = 0; i + static_cast<std::size_t>(neighbours) <= nearest.size(); ++i) {
      teams.push_back(team_of(std::span(nearest).subspan(i, static_cast<std::size_t>(neighbours))));
    }
    return teams;
  }
};

namespace {

/// Dynamic programming along the non-empty sectors of one track.
template <class Catalogue>
class TrackChoice {
 public:
  explicit TrackChoice(const Catalogue& catalogue) : catalogue_(catalogue) {}

  /// One plate on. `drift` of s from the previous plate to this one.
  void add_plate(const float* wanted, float drift, const std::vector<Team>& candidates) {
    std::vector<State> states;
    hold(wanted, drift, states);
    change(wanted, candidates, states);
    std::stable_sort(states.begin(), states.end(), [](const State& a, const State& b) { return a.cost < b.cost; });
    if (states.size() > kBeam) states.resize(kBeam);
    plates_.push_back(std::move(states));
  }

  /// Calls use(plate, team, shift) for the cheapest sequence, last plate first.
  template <class Use>
  void finish(Use use) {
    int at = 0;
    for (std::size_t i = plates_.size(); i-- > 0;) {
      const State& s = plates_[i][static_cast<std::size_t>(at)];
      use(i, teams_[static_cast<std::size_t>(s.team)], s.shift);
      at = s.parent;
    }
    plates_.clear();
    teams_.clear();
  }

 private:
  void hold(const float* wanted, float drift, std::vector<State>& states) {
    moved_.clear();
    if (plates_.empty()) return;
    const auto n = static_cast<std::size_t>(catalogue_.samples);
    moved_.resize(plates_.back().size() * n);
    for (std::size_t i = 0; i < plates_.back().size(); ++i) {
      const State& s = plates_.back()[i];
      const Team& team = teams_[static_cast<std::size_t>(s.team)];
      const float shift = s.shift + drift;
      catalogue_.profile(team, shift, &moved_[i * n]);
      states.push_back({s.team, shift, s.cost + catalogue_.feature_cost(team, shift, wanted), static_cast<int>(i)});
    }
  }

  void change(const float* wanted, const std::vector<Team>& candidates, std::vector<State>& states) {
    std::array<float, kMaxSamples> profile;
    for (const Team& team : candidates) {
      teams_.push_back(team);
      for (const float shift : kTriedShifts) {
        catalogue_.profile(team, shift, profile.data());
        State s{static_cast<int>(teams_.size()) - 1, shift, 0, -1};
        if (!plates_.empty()) arrive(profile.data(), s);
        s.cost += catalogue_.feature_cost(team, shift, wanted);
        states.push_back(s);
      }
    }
  }

  /// The cheapest way to here from the previous plate.
  void arrive(const float* profile, State& s) const {
    const auto n = static_cast<std::size_t>(catalogue_.samples);
    for (std::size_t i = 0; i < plates_.back().size(); ++i) {
      const float cost = plates_.back()[i].cost + kJumpWeight * catalogue_.jump(&moved_[i * n], profile);
      if (s.parent >= 0 && !(cost < s.cost)) continue;
      s.cost = cost;
      s.parent = static_cast<int>(i);
    }
  }

  const Catalogue& catalogue_;
  std::vector<Team> teams_;
  std::vector<std::vector<State>> plates_;  // the beams
  std::vector<float> moved_;                // [state of the last beam][sample] its profile, moved on by the drift
};

int checked_neighbours(const LookupSettings& settings, const RecordBank& bank) {
  if (settings.neighbours < 1 || settings.neighbours > kMaxNeighbours) {
    throw UsageError("neighbours is " + std::to_string(settings.neighbours) + "; it must lie in [1, " +
                     std::to_string(kMaxNeighbours) + "]");
  }
  return static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(settings.neighbours), bank.size()));
}

/// Distribution function of the standard normal.
float normal_below(float x) {
  return 0.5F * std::erfc(-x * std::numbers::sqrt2_v<float> * 0.5F);
}

}  // namespace

DatabaseSource::DatabaseSource(std::shared_ptr<const RecordBank> bank, const LookupSettings& settings)
    : DatabaseSource(bank, settings, bank->metadata().settings.features) {}

DatabaseSource::DatabaseSource(std::shared_ptr<const RecordBank> bank, const LookupSettings& settings,
                               FeatureSet features)
    : bank_(std::move(bank)), settings_(settings) {
  settings_.neighbours = checked_neighbours(settings, *bank_);
  catalogue_ = std::make_unique<const Catalogue>(*bank_, features, settings_.neighbours, settings_.coherent);
}

DatabaseSource::DatabaseSource(const std::filesystem::path& database, const LookupSettings& settings)
    : DatabaseSource(std::make_shared<const RecordBank>(database), settings) {}

DatabaseSource::~DatabaseSource() = default;

std::span<const Pick> DatabaseSource::picks(std::size_t sector) const noexcept {
  const auto k = static_cast<std::size_t>(settings_.neighbours);
  const Pick* first = picks_.data() + sector * k;
  return {first, first->record == kNobody ? 0 : k};
}

void DatabaseSource::attach(const SectorSet& sectors) {
  const BakeSettings& baked = bank_->metadata().settings;
  const Catalogue& c = *catalogue_;
  const auto k = static_cast<std::size_t>(settings_.neighbours), width = static_cast<std::size_t>(c.dimensions);
  std::vector<float> features = density_features(sectors, c.set, baked.grid, baked.sigma);
  std::vector<char> empty(sectors.size());
  for (std::size_t i = 0; i < sectors.size(); ++i) empty[i] = !(features[i * width] >= kEmptyDensity);
  c.scale.apply(features);
  picks_.assign(sectors.size() * k, {kNobody, 0.0F});
  shifts_.assign(sectors.size(), 0.0F);
  keep_own(sectors);

  const auto take = [&](std::size_t sector, const Team& team, float shift) {
    std::copy_n(team.begin(), k, picks_.begin() + static_cast<std::ptrdiff_t>(sector * k));
    shifts_[sector] = fraction(shift);
  };
  const auto length = static_cast<std::size_t>(sectors.plates) + 1;
  tbb::parallel_for(std::size_t{0}, sectors.tracks(), [&](std::size_t track) {
    TrackChoice<Catalogue> choice(c);
    std::uint64_t searched = 0;
    std::size_t begun = track * length;  // first sector of the run
    const auto end_run = [&] { choice.finish([&](std::size_t i, const Team& t, float s) { take(begun + i, t, s); }); };
    for (std::size_t i = track * length; i < (track + 1) * length; ++i) {
      if (empty[i]) {
        end_run();
        begun = i + 1;
        continue;
      }
      ++searched;
      const std::span<const float> wanted(features.data() + i * width, width);
      if (settings_.coherent) {
        choice.add_plate(wanted.data(), i == begun ? 0.0F : sectors.drift[i - 1], c.candidates(wanted, kCandidates));
      } else {
        take(i, c.candidates(wanted, 1).front(), 0.0F);
      }
    }
    end_run();
    searches_ += searched;
  });
}

void DatabaseSource::evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                              std::span<float> re) const noexcept {
  const auto n = static_cast<std::size_t>(samples());
  const std::span<const Pick> chosen = picks(sector);
  if (chosen.empty()) {
    std::fill_n(tau.begin(), n, 0.0F);
    std::fill_n(re.begin(), re.empty() ? 0 : n, 1.0F);
    return;
  }
  bank_->lookup(chosen.front().record, shifts_[sector], angles, tau, re);
  if (chosen.size() > 1) {
    // Reflectance is straight: it is blended with the optical depth that it belongs to. 1e-9 keeps 0 / 0 away and is
    // far below one step of tau.
    constexpr float kLeast = 1e-9F;
    std::array<float, kMaxSamples> depth, other_tau, other_re;
    const float w = chosen.front().weight;
    for (std::size_t x = 0; x < n; ++x) depth[x] = w * (tau[x] + kLeast);
    for (std::size_t x = 0; x < re.size(); ++x) re[x] *= depth[x];
    for (const Pick& pick : chosen.subspan(1)) {
      bank_->lookup(pick.record, shifts_[sector], angles, {other_tau.data(), n}, {other_re.data(), re.size()});
      for (std::size_t x = 0; x < n; ++x) {
        other_tau[x] = pick.weight * (other_tau[x] + kLeast);
        depth[x] += other_tau[x];
      }
      for (std::size_t x = 0; x < re.size(); ++x) re[x] += other_tau[x] * other_re[x];
    }
    for (std::size_t x = 0; x < n; ++x) tau[x] = std::max(depth[x] - kLeast, 0.0F);
    for (std::size_t x = 0; x < re.size(); ++x) re[x] /= depth[x];
  }
  if (settings_.own_alpha) own_tau(sector, angles, tau);
}

namespace {

/// What a ray needs to know, per sample along s.
struct Rays {
  std::array<float, kMaxSamples> s, tangent, falloff, gain, reach, front;
  std::array<float, kMaxSamples> sum;
};

float wrapped(float x) {  // to [-1/2, 1/2]
  const int towards_zero = static_cast<int>(x + (x < 0 ? -0.5F : 0.5F));
  return x - static_cast<float>(towards_zero);
}

/// Adds a strand at (s, r) with this mass to the n rays: its own image and the neighbours' in the wrapped sector.
__attribute__((target_clones("avx512f", "avx2", "default"))) void add_strand(float s, float r, float mass, float soft,
                                                                             int n, Rays& rays) {
  for (int i = 0; i < n; ++i) {
    const auto x = static_cast<std::size_t>(i);
    const float depth = rays.front[x] * (1 - r) + (1 - rays.front[x]) * r;
    const float away = wrapped(rays.s[x] - s - rays.tangent[x] * depth);
    const float left = away - 1, right = away + 1, falloff = rays.falloff[x];
    const float images =
        exp_neg(away * away * falloff) + exp_neg(left * left * falloff) + exp_neg(right * right * falloff);
    const float z = std::min(std::max((rays.reach[x] - depth) * soft + 0.5F, 0.0F), 1.0F);
    rays.sum[x] += mass * z * z * (3 - 2 * z) * images;
  }
}

}  // namespace

/// Line integrals of the sector's Gaussians, smoothed along s as the records are: a strand at (s_i, r_i) seen at angle
/// theta lies at s_i + tan(theta) depth_i, its width is sigma / |cos theta| there, its mass 1 / |cos theta|. Strands of
/// the sector alone, wrapped, as the march wraps; beyond max_path they fade over +-1.5 sigma. Where the smoothed width
/// exceeds .45 (within 6 degrees of grazing at sigma = .05) it counts as .45: three images are the whole then.
void DatabaseSource::own_tau(std::size_t sector, const SatfAngles& angles, std::span<float> tau) const noexcept {
  const BakeSettings& baked = bank_->metadata().settings;
  const int n = samples();
  const double cell = 1.0 / baked.grid;
  const auto variance = static_cast<float>(baked.sigma * baked.sigma + cell * cell / 6);  // of the bilinear interpolant
  const auto smoothing = static_cast<float>(baked.smoothing * baked.smoothing * baked.sigma * baked.sigma);
  const double step = (static_cast<double>(angles.view_last) - static_cast<double>(angles.view_first)) / n;
  const double first = static_cast<double>(angles.view_first) + 0.5 * step;
  double sine = std::sin(first), cosine = std::cos(first);
  const double turn_sine = std::sin(step), turn_cosine = std::cos(step);
  Rays rays;
  for (int i = 0; i < n; ++i) {
    const auto x = static_cast<std::size_t>(i);
    const auto upright = std::max(static_cast<float>(std::abs(cosine)), 1e-3F);
    const float wide_sq = std::min(variance / (upright * upright) + smoothing, 0.45F * 0.45F);
    rays.s[x] = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
    rays.tangent[x] = static_cast<float>(sine) / upright;
    rays.falloff[x] = 0.5F / wide_sq;
    rays.gain[x] = reference_scale() / upright * std::sqrt(rays.falloff[x] * std::numbers::inv_pi_v<float>);
    rays.reach[x] = static_cast<float>(baked.max_path) * upright;
    rays.front[x] = cosine >= 0 ? 1.0F : 0.0F;
    rays.sum[x] = 0;
    const double next = cosine * turn_cosine - sine * turn_sine;
    sine = sine * turn_cosine + cosine * turn_sine;
    cosine = next;
  }
  const float soft = 1.0F / (3.0F * static_cast<float>(baked.sigma));
  for (std::size_t i = own_.offsets[sector]; i < own_.offsets[sector + 1]; ++i) {
    add_strand(own_.crossings[i].x, own_.crossings[i].y, own_mass_[i], soft, n, rays);
  }
  for (std::size_t x = 0; x < static_cast<std::size_t>(n); ++x) tau[x] = rays.gain[x] * rays.sum[x];
}

void DatabaseSource::keep_own(const SectorSet& sectors) {
  own_ = SectorSet{};
  own_mass_.clear();
  if (!settings_.own_alpha) return;
  const auto inv_sigma = static_cast<float>(1 / bank_->metadata().settings.sigma);
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    for (const glm::vec2 p : sectors.sector(i)) {
      if (p.x < 0 || p.x >= 1) continue;  // its copy on the other side wraps
      own_.crossings.push_back(p);
      own_mass_.push_back(normal_below((1 - p.y) * inv_sigma) - normal_below(-p.y * inv_sigma));
    }
    own_.offsets.push_back(static_cast<std::uint32_t>(own_.crossings.size()));
  }
}

}  // namespace pelage
