#include "pelage/hair/cluster_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/cluster_curve.h"
#include "pelage/hair/cluster_kmeans.h"
#include "pelage/hair/cluster_projection.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

constexpr int kFeaturePoints = 8;                     // per strand in the k-means
constexpr int kKMeansIterations = 20;                 // 20 -> 100 changes the radius on the Sintel bob by < 1 %
constexpr int kMeanPoints = 24;                       // of the mean strand that a centre line starts from
constexpr int kCurvePasses = 3;                       // project and fit
constexpr double kSmoothings[] = {1e-6, 1e-4, 1e-2};  // the first keeps 88 % of three waves' amplitude (fit_curve)
constexpr double kFewCut = 0.002;                     // share of the vertices at which no stiffer line is tried
constexpr double kAlongWeight = 2.0;                  // > 1: see refit_line
constexpr double kEndMargin = 0.005;                  // of the centre line's length beyond the outermost strand
constexpr int kExtensions = 4;                        // attempts to cover every strand's t-range
constexpr std::size_t kSectionControls = 8;
constexpr std::size_t kMinControls = 6, kMaxControls = 32;  // of centre lines
constexpr double kTurnPerControl = std::numbers::pi / 6;    // one more control point for every 30 degrees of turning
constexpr int kReassignPasses = 2;
constexpr std::size_t kCandidates = 6;   // nearest clusters that a strand may move to
constexpr double kBadlyOutside = 0.5;    // a strand with less of its length inside looks for another cluster
constexpr double kClearlyBetter = 0.25;  // and moves if so much more of it is inside there

using Members = std::vector<std::uint32_t>;

/// A strand in its cluster: what of it increases in t, in the plate planes.
struct Placed {
  std::uint32_t strand;
  std::vector<PlanePoint> points;
};

/// A cluster while it is fitted.
struct Draft {
  Members members;
  std::vector<glm::vec3> control;
  glm::vec3 first_normal{1, 0, 0};
  std::optional<CentreLine> line;
  std::vector<CrossSection> sections;
  std::vector<Placed> placed;
};

void check(const FitSettings& s) {
  if (s.clusters < 1 || s.clusters > 10000) {
    throw UsageError("clusters: " + std::to_string(s.clusters) + " is outside 1 ... 10000");
  }
  if (!(s.coverage >= 0.5 && s.coverage <= 1)) {
    throw UsageError("coverage: " + std::to_string(s.coverage) + " is outside 0.5 ... 1");
  }
  if (!(s.diameter_m >= 0 && std::isfinite(s.diameter_m))) throw UsageError("diameter: must be a positive number");
}

void check(const Strands& strands) {
  for (std::size_t i = 0; i < strands.count(); ++i) {
    for (std::size_t j = 0; j < strands.strand(i).size(); ++j) {
      const glm::vec3& p = strands.strand(i)[j];
      if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
      throw InputError("strand " + std::to_string(i) + ", vertex " + std::to_string(j), "not a finite position");
    }
  }
}

/// Strands that have a length.
Members usable_strands(const Strands& strands) {
  Members usable;
  for (std::uint32_t i = 0; i < strands.count(); ++i) {
    const double length = arc_length_m(strands.strand(i));
    if (length > 0 && std::isfinite(length)) usable.push_back(i);
  }
  if (usable.empty()) throw InputError("strands", "none has a length, so there is nothing to cluster");
  return usable;
}

Features features_of(const Strands& strands, const Members& usable) {
  Features features{3 * kFeaturePoints, std::vector<float>(usable.size() * 3 * kFeaturePoints)};
  tbb::parallel_for(std::size_t{0}, usable.size(), [&](std::size_t i) {
    float* out = features.values.data() + i * features.dimensions;
    for (const glm::vec3& p : resample_polyline(strands.strand(usable[i]), kFeaturePoints)) {
      *out++ = p.x, *out++ = p.y, *out++ = p.z;
    }
  });
  return features;
}

/// Mean of the members at equal shares of their length. Where strands cancel each other (opposite directions) the
/// longest member stands in.
std::vector<glm::vec3> mean_strand(const Strands& strands, const Members& members) {
  std::vector<glm::dvec3> sum(kMeanPoints, glm::dvec3(0));
  double lengths = 0;
  std::uint32_t longest = members.front();
  for (const std::uint32_t m : members) {
    const std::vector<glm::vec3> points = resample_polyline(strands.strand(m), kMeanPoints);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += glm::dvec3(points[i]);
    const double length = arc_length_m(strands.strand(m));
    lengths += length;
    if (length > arc_length_m(strands.strand(longest))) longest = m;
  }
  const double n = static_cast<double>(members.size());
  std::vector<glm::vec3> mean;
  for (const glm::dvec3& p : sum) mean.emplace_back(p / n);
  if (arc_length_m(mean) < 0.1 * lengths / n) return resample_polyline(strands.strand(longest), kMeanPoints);
  return mean;
}

std::size_t controls_for(std::span<const glm::vec3> polyline) {
  double turning = 0;
  for (std::size_t i = 1; i + 1 < polyline.size(); ++i) {
    const glm::vec3 a = polyline[i] - polyline[i - 1], b = polyline[i + 1] - polyline[i];
    turning += std::atan2(static_cast<double>(glm::length(glm::cross(a, b))), static_cast<double>(glm::dot(a, b)));
  }
  return std::min(kMinControls + static_cast<std::size_t>(turning / kTurnPerControl), kMaxControls);
}

std::vector<glm::vec3> fit_polyline(std::span<const glm::vec3> polyline, std::size_t controls) {
  const double length = arc_length_m(polyline);
  std::vector<CurveSample> samples;
  double s = 0;
  for (std::size_t i = 0; i < polyline.size(); ++i) {
    if (i > 0) s += static_cast<double>(glm::distance(polyline[i], polyline[i - 1]));
    samples.push_back({s / length, glm::dvec3(polyline[i]), 1.0});
  }
  return fit_curve(samples, {}, controls, kSmoothings[0]);
}

std::vector<Placed> place(const Strands& strands, const Members& members, const CentreLine& line) {
  const Projector projector(line);
  std::vector<Placed> placed;
  for (const std::uint32_t m : members) {
    placed.push_back({m, increasing_part(projector.project(strands.strand(m)), strands.strand(m))});
  }
  return placed;
}

/// Calls body(point, weight) for every placed vertex, weighted with half the length of its two segments.
template <class Body>
void for_vertices(const Strands& strands, const Placed& placed, const Body& body) {
  const std::span<const glm::vec3> strand = strands.strand(placed.strand);
  const auto& points = placed.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3& at = strand[points[i].vertex];
    float weight = 0;
    if (i > 0) weight += glm::distance(at, strand[points[i - 1].vertex]);
    if (i + 1 < points.size()) weight += glm::distance(at, strand[points[i + 1].vertex]);
    body(points[i], 0.5 * static_cast<double>(weight));
  }
}

struct Range {
  double low = 0, high = 1;
};

/// From the first to the last t of the placed strands.
Range range_of(const std::vector<Placed>& placed) {
  Range r{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Placed& p : placed) {
    if (p.points.size() < 2) continue;
    r.low = std::min(r.low, p.points.front().t);
    r.high = std::max(r.high, p.points.back().t);
  }
  return r.low < r.high ? r : Range{};
}

Range with_margin(Range r) {
  const double margin = kEndMargin * (r.high - r.low);
  return {r.low - margin, r.high + margin};
}

/// Mean square distance of the strands from their centre line [m^2].
double mean_square_m2(const Strands& strands, const std::vector<Placed>& placed) {
  double sum = 0, weights = 0;
  for (const Placed& p : placed) {
    for_vertices(strands, p, [&](const PlanePoint& q, double weight) {
      sum += weight * glm::dot(q.plane_m, q.plane_m);
      weights += weight;
    });
  }
  return weights > 0 ? sum / weights : 0.0;
}

/// The centre line that lies amid its strands and runs along them, over their whole range of t.
/// The second demand (a direction error of 1 costs kAlongWeight times the mean square distance) holds it where a
/// cluster is wider than long: there the line nearest to all points runs across the strands.
std::vector<glm::vec3> refit_line(const Strands& strands, const Draft& draft, double smoothing) {
  const Range range = with_margin(range_of(draft.placed));
  const auto x_of = [&](const PlanePoint& q) { return (q.t - range.low) / (range.high - range.low); };
  const double along_m2 = kAlongWeight * mean_square_m2(strands, draft.placed);
  std::vector<CurveSample> points;
  std::vector<StepSample> steps;
  for (const Placed& p : draft.placed) {
    if (p.points.size() < 2) continue;
    const std::span<const glm::vec3> strand = strands.strand(p.strand);
    for_vertices(strands, p, [&](const PlanePoint& q, double weight) {
      points.push_back({x_of(q), glm::dvec3(strand[q.vertex]), weight});
    });
    for (std::size_t i = 1; i < p.points.size(); ++i) {
      const PlanePoint &a = p.points[i - 1], &b = p.points[i];
      const glm::dvec3 step = glm::dvec3(strand[b.vertex]) - glm::dvec3(strand[a.vertex]);
      const double length_m = glm::length(step);
      if (length_m > 0) steps.push_back({x_of(a), x_of(b), step, along_m2 / length_m});  // length / length^2
    }
  }
  return points.empty() ? draft.control : fit_curve(points, steps, draft.control.size(), smoothing);
}

/// The same line, straight on at both ends until it spans the range.
std::vector<glm::vec3> extended(const CentreLine& line, Range range, std::size_t controls) {
  constexpr int kSamples = 128;
  std::vector<CurveSample> samples;
  for (int i = 0; i <= kSamples; ++i) {
    const double x = i / static_cast<double>(kSamples);
    const double t = range.low + x * (range.high - range.low);
    const Frame f = line.frame(t);
    const double beyond_m = (t - std::clamp(t, 0.0, 1.0)) * line.length_m();
    samples.push_back({x, glm::dvec3(f.position) + beyond_m * glm::dvec3(f.tangent), 1.0});
  }
  return fit_curve(samples, {}, controls, kSmoothings[0]);
}

void set_line(const Strands& strands, Draft& draft, std::vector<glm::vec3> control) {
  draft.control = std::move(control);
  draft.line.emplace(draft.control, draft.first_normal);
  draft.placed = place(strands, draft.members, *draft.line);
}

void fit_line(const Strands& strands, Draft& draft, double smoothing) {
  const std::vector<glm::vec3> mean = mean_strand(strands, draft.members);
  set_line(strands, draft, fit_polyline(mean, controls_for(mean)));
  for (int pass = 0; pass < kCurvePasses; ++pass) set_line(strands, draft, refit_line(strands, draft, smoothing));
  for (int i = 0; i < kExtensions; ++i) {
    const Range range = range_of(draft.placed);
    if (range.low >= 0 && range.high <= 1) break;
    const Range wider = with_margin({std::min(range.low, 0.0), std::max(range.high, 1.0)});
    set_line(strands, draft, extended(*draft.line, wider, std::min(draft.control.size() + 1, kMaxControls)));
  }
  for (Placed& p : draft.placed) {  // what still lies before the root or beyond the tip is cut
    std::erase_if(p.points, [](const PlanePoint& q) { return q.t < 0 || q.t > 1; });
  }
}

/// Share of the vertices that the cluster does not hold.
double share_cut(const Strands& strands, const Draft& draft) {
  std::size_t all = 0, kept = 0;
  for (const Placed& p : draft.placed) {
    all += strands.strand(p.strand).size();
    if (p.points.size() >= 2) kept += p.points.size();
  }
  return 1 - static_cast<double>(kept) / static_cast<double>(all);
}

/// Fits the line, stiffer where a supple one bends back so that strands are lost, and keeps the one that holds most.
void fit_best_line(const Strands& strands, Draft& draft) {
  double least = 2;
  Draft best;
  for (const double smoothing : kSmoothings) {
    fit_line(strands, draft, smoothing);
    const double cut = share_cut(strands, draft);
    if (cut < least) best = draft, least = cut;
    if (least < kFewCut) break;
  }
  draft = std::move(best);
}

void fit_draft(const Strands& strands, const FitSettings& settings, Draft& draft) {
  fit_best_line(strands, draft);
  std::vector<PlaneSample> samples;
  for (const Placed& p : draft.placed) {
    for_vertices(strands, p, [&](const PlanePoint& q, double weight) {
      if (weight > 0) samples.push_back({q.t, q.plane_m, weight});
    });
  }
  const double min_radius_m = static_cast<double>(settings.diameter_m);
  if (samples.empty()) samples.push_back({0.5, glm::dvec2(0), 1.0});
  draft.sections = fit_cross_sections(samples, kSectionControls, settings.coverage, min_radius_m);
}

glm::vec2 disk_of(const Draft& draft, const PlanePoint& p) {
  return evaluate_b_spline(std::span<const CrossSection>(draft.sections), static_cast<float>(p.t))
      .solve(glm::vec2(p.plane_m));
}

/// Share of a strand's length that lies inside the envelope of a cluster; what is cut lies outside.
double share_inside(const Strands& strands, const Draft& draft, const Placed& placed) {
  double inside = 0;
  for_vertices(strands, placed, [&](const PlanePoint& q, double weight) {
    const glm::vec2 disk = disk_of(draft, q);
    if (q.t >= 0 && q.t <= 1 && glm::dot(disk, disk) <= 1) inside += weight;
  });
  return inside / arc_length_m(strands.strand(placed.strand));
}

/// A better cluster for strands of which little lies inside their own. [usable strand] cluster
std::vector<std::uint32_t> better_clusters(const Strands& strands, const Members& usable, const Features& features,
                                           const KMeans& means, const std::vector<Draft>& drafts) {
  std::vector<std::uint32_t> labels = means.labels;
  tbb::parallel_for(std::size_t{0}, usable.size(), [&](std::size_t i) {
    const auto share_in = [&](std::uint32_t k) {
      const Draft& d = drafts[k];
      return d.line ? share_inside(strands, d, place(strands, {usable[i]}, *d.line).front()) : 0.0;
    };
    const double own = share_in(labels[i]);
    if (own >= kBadlyOutside) return;
    double best = own + kClearlyBetter;
    for (const std::uint32_t k : nearest_centres(means.centres, features.row(i), kCandidates)) {
      const double share = k == means.labels[i] ? 0.0 : share_in(k);
      if (share > best) best = share, labels[i] = k;
    }
  });
  return labels;
}

/// Fits the clusters whose members are not what they were.
void fit_changed(const Strands& strands, const FitSettings& settings, const Members& usable,
                 const std::vector<std::uint32_t>& labels, std::vector<Draft>& drafts) {
  std::vector<Members> members(drafts.size());
  for (std::size_t i = 0; i < usable.size(); ++i) members[labels[i]].push_back(usable[i]);
  tbb::parallel_for(std::size_t{0}, drafts.size(), [&](std::size_t k) {
    if (drafts[k].members == members[k]) return;
    drafts[k] = Draft{};
    drafts[k].members = std::move(members[k]);
    if (!drafts[k].members.empty()) fit_draft(strands, settings, drafts[k]);
  });
}

Cluster to_cluster(const Strands& strands, const Draft& draft) {
  Cluster cluster;
  cluster.centre_line = draft.control;
  cluster.cross_sections = draft.sections;
  cluster.first_normal = draft.line->frame(0).normal;
  glm::dvec3 colour(0);
  for (const Placed& p : draft.placed) {
    if (p.points.size() < 2) continue;
    for (const PlanePoint& q : p.points) {
      const glm::vec2 disk = disk_of(draft, q);
      cluster.strand_points.push_back({static_cast<float>(q.t), disk.x, disk.y});
    }
    cluster.strand_offsets.push_back(static_cast<std::uint32_t>(cluster.strand_points.size()));
    if (!strands.colours.empty()) colour += glm::dvec3(strands.colours[p.strand]);
  }
  if (!strands.colours.empty() && cluster.strand_count() > 0) {
    cluster.colour = glm::vec3(colour / static_cast<double>(cluster.strand_count()));
  }
  return cluster;
}

double distance_to_segment_squared(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 ab = b - a;
  const double length_sq = glm::dot(ab, ab);
  const double w = length_sq > 0 ? std::clamp(glm::dot(p - a, ab) / length_sq, 0.0, 1.0) : 0.0;
  const glm::dvec3 d = p - (a + w * ab);
  return glm::dot(d, d);
}

/// Sums over a cluster's strands for the report.
struct Tally {
  double inside_m = 0, length_m = 0;
  double square_m2 = 0;
  std::size_t distances = 0, points = 0, cut = 0;
};

/// One strand against its reconstruction: at its vertices, at the middle of its segments, and from the vertices that
/// were cut to the nearest part of what is left.
void tally_strand(const Strands& strands, const Draft& draft, const Placed& placed, Tally& tally) {
  const std::span<const glm::vec3> strand = strands.strand(placed.strand);
  const auto disk_point = [&](const PlanePoint& q) { return glm::dvec3(q.t, glm::dvec2(disk_of(draft, q))); };
  const auto world = [&](const glm::dvec3& d) {
    const Frame f = draft.line->frame(static_cast<double>(static_cast<float>(d.x)));
    const glm::vec2 p = evaluate_b_spline(std::span<const CrossSection>(draft.sections), static_cast<float>(d.x))
                            .apply(glm::vec2(glm::dvec2(d.y, d.z)));
    return glm::dvec3(f.position + p.x * f.normal + p.y * f.binormal);
  };
  const auto add = [&](double square_m2) { tally.square_m2 += square_m2, ++tally.distances; };
  std::vector<glm::dvec3> rebuilt;
  std::vector<bool> kept(strand.size(), false);
  for (std::size_t i = 0; i < placed.points.size(); ++i) {
    const std::uint32_t vertex = placed.points[i].vertex;
    const glm::dvec3 disk = disk_point(placed.points[i]), original(strand[vertex]);
    kept[vertex] = true;
    if (i > 0) {
      const glm::dvec3 before = disk_point(placed.points[i - 1]);
      const std::uint32_t last = placed.points[i - 1].vertex;
      const double segment_m = static_cast<double>(glm::distance(strand[vertex], strand[last]));
      for (int k = 0; k < 4; ++k) {
        const glm::dvec3 at = before + (0.125 + 0.25 * k) * (disk - before);
        if (at.y * at.y + at.z * at.z <= 1) tally.inside_m += 0.25 * segment_m;
      }
      const glm::dvec3 middle = 0.5 * (original + glm::dvec3(strand[last]));
      rebuilt.push_back(world(0.5 * (before + disk)));
      if (vertex == last + 1) add(distance_to_segment_squared(rebuilt.back(), middle, middle));
    }
    rebuilt.push_back(world(disk));
    add(distance_to_segment_squared(rebuilt.back(), original, original));
  }
  tally.length_m += arc_length_m(strand);
  tally.points += strand.size();
  for (std::size_t i = 0; i < strand.size(); ++i) {
    if (kept[i]) continue;
    ++tally.cut;
    double nearest = glm::dot(glm::dvec3(strand[i]) - rebuilt[0], glm::dvec3(strand[i]) - rebuilt[0]);
    for (std::size_t j = 1; j < rebuilt.size(); ++j) {
      nearest = std::min(nearest, distance_to_segment_squared(glm::dvec3(strand[i]), rebuilt[j - 1], rebuilt[j]));
    }
    add(nearest);
  }
}

Tally tally_of(const Strands& strands, const Draft& draft) {
  Tally tally;
  for (const Placed& p : draft.placed) {
    if (p.points.size() >= 2) tally_strand(strands, draft, p, tally);
  }
  return tally;
}

ClusterReport report_of(const Cluster& cluster, const Tally& tally) {
  const SweptCluster swept = sweep(cluster, kReportPlates);
  ClusterReport r;
  r.strands = cluster.strand_count();
  r.length_m = swept.length_m;
  for (const CrossSection& s : swept.cross_sections) r.radius_m += std::sqrt(s.determinant()) / (kReportPlates + 1);
  r.inside = tally.inside_m / tally.length_m;
  r.rms_m = std::sqrt(tally.square_m2 / static_cast<double>(tally.distances));
  r.points = tally.points;
  r.cut_points = tally.cut;
  r.overlapping_plates = overlapping_plates(swept);
  return r;
}

/// Clusters and report of the drafts that hold strands.
ClusterFit finish(const Strands& strands, const std::vector<Draft>& drafts) {
  std::vector<Cluster> clusters(drafts.size());
  std::vector<Tally> tallies(drafts.size());
  std::vector<ClusterReport> reports(drafts.size());
  tbb::parallel_for(std::size_t{0}, drafts.size(), [&](std::size_t k) {
    if (drafts[k].members.empty()) return;
    clusters[k] = to_cluster(strands, drafts[k]);
    if (clusters[k].strand_count() == 0) return;
    tallies[k] = tally_of(strands, drafts[k]);
    reports[k] = report_of(clusters[k], tallies[k]);
  });
  ClusterFit fit;
  Tally sum;
  for (std::size_t k = 0; k < drafts.size(); ++k) {
    if (clusters[k].strand_count() == 0) continue;
    sum.inside_m += tallies[k].inside_m, sum.length_m += tallies[k].length_m;
    sum.square_m2 += tallies[k].square_m2, sum.distances += tallies[k].distances;
    fit.report.strands += reports[k].strands;
    fit.report.points += reports[k].points;
    fit.report.cut_points += reports[k].cut_points;
    fit.report.overlapping_plates += reports[k].overlapping_plates;
    fit.report.plates += kReportPlates;
    fit.report.clusters.push_back(reports[k]);
    fit.clusters.push_back(std::move(clusters[k]));
  }
  if (fit.clusters.empty()) throw InputError("strands", "no cluster could be fitted: no strand has a direction");
  fit.report.inside = sum.inside_m / sum.length_m;
  fit.report.rms_m = std::sqrt(sum.square_m2 / static_cast<double>(sum.distances));
  return fit;
}

}  // namespace

float drawn_diameter_m(const Strands& strands) noexcept {
  if (strands.diameters_m.empty()) {
    return strands.diameter_m > 0 ? strands.diameter_m : default_diameter_m(strands.count());
  }
  double sum = 0;
  for (const float d : strands.diameters_m) sum += static_cast<double>(d);
  return static_cast<float>(sum / static_cast<double>(strands.diameters_m.size()));
}

ClusterFit fit_clusters(const Strands& strands, const FitSettings& settings) {
  check(settings);
  check(strands);
  FitSettings used = settings;
  if (!(used.diameter_m > 0)) used.diameter_m = drawn_diameter_m(strands);
  const Members usable = usable_strands(strands);
  const Features features = features_of(strands, usable);
  KMeans means = k_means(features, used.clusters, used.seed, kKMeansIterations);
  const std::vector<std::uint32_t> chosen = means.labels;
  std::vector<Draft> drafts(means.centres.rows());
  fit_changed(strands, used, usable, means.labels, drafts);
  for (int pass = 0; pass < kReassignPasses; ++pass) {
    means.labels = better_clusters(strands, usable, features, means, drafts);
    fit_changed(strands, used, usable, means.labels, drafts);
  }
  ClusterFit fit = finish(strands, drafts);
  fit.report.dropped = strands.count() - fit.report.strands;
  for (std::size_t i = 0; i < chosen.size(); ++i) fit.report.reassigned += chosen[i] != means.labels[i];
  return fit;
}

}  // namespace pelage::hair
