// Effects as values [DESIGN section 8]: what each needs and provides, whether a scene calls for it and why, and how it
// is left out. plan.h makes of them, and of what a scene asks for, the settings that are run.
//
// A pass is work without a look of its own (a shadow map, a voxel grid): it runs where an effect that runs needs it.
//
// Bounds of `auto`. An effect is skipped only where leaving it out changes
//   - a colour by at most kUnseen (linear, after exposure), half an 8-bit step of sRGB where these are smallest, or
//   - the light that arrives by at most the share kUnseenShare, which moves an 8-bit sRGB value by less than half a
//   step,
//   - a place by at most kUnseenWidth of a fibre's width or, in a picture, kUnseenSample of a sample, or
//   - nothing at all (what it acts on cannot come into reach); what a strand's friction with itself does, less than
//     0.1 mm, does not count.
// Sleep runs where it is not off, and is no omission but an approximation of its own: hair that slept is within 5 mm of
// hair that was kept awake (measured: .1 mm; shaken after a minute asleep, .5 mm).
// tests/effects holds scenes made to break each.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

inline constexpr float kUnseen = 1.0F / (2 * 255 * 12.92F);
inline constexpr float kUnseenShare = 1.0F / 256;
inline constexpr float kUnseenWidth = 0.1F;
inline constexpr float kUnseenSample = 0.1F;

/// What effects ask about. Nothing is copied; what is null or empty is unknown or not there.
struct HairFacts {
  const Strands* strands = nullptr;  // drawn or simulated one by one, with a diameter
  const Hairstyle* style = nullptr;  // drawn as clusters
  const Mesh* head = nullptr;
  float opacity = kDefaultOpacity;  // of a fibre of `strands`
};

struct Verdict {
  bool called_for = true;
  std::string why;  // a sentence, with the numbers and, where it is not called for, the bound
};

enum class Task { picture, motion };

struct Effect {
  std::string name;
  bool pass = false;
  std::vector<std::string> needs;     // cannot run without any of these
  std::vector<std::string> uses;      // takes them where they are
  std::vector<std::string> provides;  // kResult: what the task is for
  std::vector<std::string> stages;    // of the ledger that are its alone
  /// Why its settings leave nothing to run, e.g. "simulation.wind.velocity_m_s is zero"; empty: they do not.
  std::function<std::string(const Scene&, const HairFacts&)> idle;
  /// Asked only where it is not idle.
  std::function<Verdict(const Scene&, const HairFacts&)> called_for;
  /// As if its setting were zero. None for passes.
  std::function<void(Scene&)> leave_out;
};

inline constexpr const char* kResult = "result";

/// Of all methods, and the capsules of this scene: what a scene may switch.
std::vector<std::string> effect_names(const Scene& scene);

/// Of the scene's method, an effect or pass after all that it needs or uses.
std::vector<Effect> picture_effects(const Scene& scene);
/// With one for each capsule that the simulation collides with.
std::vector<Effect> motion_effects(const Scene& scene);

}  // namespace pelage
