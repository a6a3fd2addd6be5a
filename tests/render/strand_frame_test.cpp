// StrandFrame: pictures that must come out, pictures that must not change, and stages that must not run.
#include <gmock/gmock.h>

#include "pelage/data_schema/strand_tint.h"
#include "strands.h"

namespace pelage {
namespace {

using test::checked;
using test::coverage;
using test::difference;
using test::mean;
using test::strand_lock;
using test::strands_from_the_front;

class StrandFrames : public test::WithOpenGl {};

constexpr StrandOrder kOrders[] = {StrandOrder::exact, StrandOrder::sorted, StrandOrder::weighted};
constexpr StrandShape kShapes[] = {StrandShape::ribbons, StrandShape::lines};

Light from(glm::vec3 direction) {
  Light light;
  light.direction = direction;
  return light;
}

TEST_F(StrandFrames, EveryMethodShapeAndOrderDrawsTheSameTwice) {
  StrandFrame frame(strand_lock(150), 0.6F, test::wall());
  for (const Method method : {Method::density_map, Method::deep_opacity, Method::opacity_shadow, Method::unshadowed}) {
    for (const StrandShape shape : kShapes) {
      for (const StrandOrder order : kOrders) {
        StrandFrameSettings settings = strands_from_the_front();
        settings.method = method;
        settings.strands.shape = shape;
        settings.strands.order = order;
        const Image first = checked(frame.render(settings, 60, 80, 1));
        EXPECT_GT(coverage(first), 0.1);
        EXPECT_EQ(first.rgba, frame.render(settings, 60, 80, 1).rgba);
        StrandFrame fresh(strand_lock(150), 0.6F, test::wall());
        EXPECT_EQ(first.rgba, fresh.render(settings, 60, 80, 1).rgba);
      }
    }
  }
}

TEST_F(StrandFrames, RefusesWhatIsNotDrawnHere) {
  StrandFrame frame(strand_lock(100), 0.6F, {});
  for (const Method method : {Method::satf, Method::truth}) {
    StrandFrameSettings settings = strands_from_the_front();
    settings.method = method;
    EXPECT_THROW(frame.render(settings, 8, 8, 1), UsageError);
  }
  for (const int pieces : {-1, 0, 33}) {
    StrandFrameSettings settings = strands_from_the_front();
    settings.strands.smoothing = pieces;
    EXPECT_THROW(frame.render(settings, 8, 8, 1), UsageError);
  }
  StrandFrameSettings settings = strands_from_the_front();
  settings.lights.assign(kMaxLights + 1, Light{});
  EXPECT_THROW(frame.render(settings, 8, 8, 1), UsageError);
  for (const float opacity : {-0.1F, 1.1F, NAN}) EXPECT_THROW(StrandFrame(strand_lock(5), opacity, {}), InputError);
  settings = strands_from_the_front();
  const Image before = frame.render(settings, 24, 24, 1);
  settings.lights[0].position = glm::vec3(-0.1F, 0.1F, -0.1F);
  settings.strands.shadow_at = ShadowAt::fragment;
  EXPECT_THROW(frame.render(settings, 24, 24, 1), UsageError) << "a point light's map is no texture";
  EXPECT_EQ(frame.render(strands_from_the_front(), 24, 24, 1).rgba, before.rgba) << "what failed leaves nothing behind";
}

TEST_F(StrandFrames, TilesGiveThePictureInOnePiece) {
  StrandFrame frame(strand_lock(200), 0.6F, test::wall());
  for (const StrandOrder order : kOrders) {
    StrandFrameSettings settings = strands_from_the_front();
    settings.strands.order = order;
    const Image whole = checked(frame.render(settings, 110, 150, 2));
    const Image tiled = checked(frame.render(settings, 110, 150, 2, 64));
    // Another matrix rounds positions otherwise: single samples on edges change sides.
    const auto d = difference(whole, tiled);
    std::printf("tiles against one piece: rms %.2g, most %.2g\n", d.rms, d.most);
    EXPECT_LT(d.rms, 4e-3);
    EXPECT_NEAR(mean(whole, 3), mean(tiled, 3), 1e-4);
  }
}

TEST_F(StrandFrames, AnySizeWorks) {
  StrandFrame frame(strand_lock(50), 0.6F, test::wall());
  for (const StrandOrder order : kOrders) {
    for (const auto& [w, h] : {std::pair(1, 1), std::pair(3, 2), std::pair(16384, 1), std::pair(1, 16384)}) {
      StrandFrameSettings settings = strands_from_the_front();
      settings.strands.order = order;
      if (w > 1000) settings.camera.fov_deg = 4e-4F;
      EXPECT_GT(coverage(checked(frame.render(settings, w, h, 3))), 0) << w << " x " << h;
    }
  }
}

TEST_F(StrandFrames, CamerasBehindWithinAndAlongTheHair) {
  Strands along;  // the eye lies on a strand and looks along it; a light too
  along.diameter_m = 1e-3F;
  along.append(std::vector<glm::vec3>{{0, 0, 0.8F}, {0, 0, 0.6F}, {0, 0, 0.4F}, {0, 0, -0.4F}});
  StrandFrame lock(strand_lock(100), 0.6F, {}), line(along, 0.6F, {});
  for (const StrandShape shape : kShapes) {
    for (const StrandOrder order : kOrders) {
      StrandFrameSettings settings = strands_from_the_front();
      settings.strands.shape = shape;
      settings.strands.order = order;
      settings.lights = {from({0, 1, 0}), from({0, -1, 0}), from({0, 0, 1})};
      checked(line.render(settings, 32, 32, 1));
      checked(lock.render(settings, 32, 32, 1));
      settings.camera.eye = {0, 0.02F, 0};
      settings.camera.target = {0.01F, 0, 0.02F};
      EXPECT_GT(coverage(checked(lock.render(settings, 32, 32, 1))), 0.2) << "from within";
      settings.camera.eye = {0, 0.2F, 0};
      settings.camera.target = {0, 0, 0};
      checked(lock.render(settings, 32, 32, 1));
      settings.camera.eye = {0, 0, 0.6F};
      settings.camera.target = {0, 0, 2};
      EXPECT_EQ(coverage(checked(lock.render(settings, 32, 32, 1))), 0.0) << "behind";
    }
  }
}

TEST_F(StrandFrames, HairThatIsNoHair) {
  Strands none, points, still;
  points.append(std::vector<glm::vec3>{{0, 0, 0}});
  points.append(std::vector<glm::vec3>{{0.01F, 0, 0}});
  still.append(std::vector<glm::vec3>(5, glm::vec3(0)));
  Strands some = strand_lock(1, 3);
  some.append({});
  some.append(std::vector<glm::vec3>{{0, 0, 0}});
  for (const StrandOrder order : kOrders) {
    for (const int pieces : {1, 3}) {
      StrandFrameSettings settings = strands_from_the_front();
      settings.strands.order = order;
      settings.strands.smoothing = pieces;
      for (const Strands* s : {&none, &points, &still}) {
        StrandFrame frame(*s, 0.6F, {});
        EXPECT_EQ(coverage(checked(frame.render(settings, 16, 16, 2))), 0.0);
      }
      StrandFrame headed(none, 0.6F, test::wall());
      EXPECT_GT(coverage(checked(headed.render(settings, 16, 16, 1))), 0.1);
      StrandFrame frame(some, 0.6F, {});
      EXPECT_GT(mean(checked(frame.render(settings, 32, 32, 1)), 3), 1e-5);
    }
  }
}

TEST_F(StrandFrames, TellsItsTilesAndCanBeStoppedBetweenThem) {
  StrandFrame frame(strand_lock(30), 0.6F, {});
  const StrandFrameSettings settings = strands_from_the_front();
  std::vector<int> done;
  const auto told = [&](int n, int total) {
    EXPECT_EQ(total, 6);  // 48 x 32 pixels in tiles of 16
    done.push_back(n);
  };
  const Image whole = frame.render(settings, 48, 32, 1, 16, told);
  EXPECT_EQ(done, (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
  const auto drawn = frame.ledger().calls("draw");
  const auto stop = [](int n, int) {
    if (n == 2) throw Interrupted("by the test");
  };
  EXPECT_THROW(frame.render(settings, 48, 32, 1, 16, stop), Interrupted);
  EXPECT_EQ(frame.ledger().calls("draw"), drawn + 2);
  EXPECT_EQ(frame.render(settings, 48, 32, 1, 16).rgba, whole.rgba) << "and goes on as if nothing had happened";
}

TEST_F(StrandFrames, OnlyWhatChangedIsComputedAgain) {
  StrandFrame frame(strand_lock(30), 0.6F, test::wall());
  StrandFrameSettings settings = strands_from_the_front();
  settings.lights = {Light{}, from({-1, 0.5F, 0.2F})};
  settings.strands.order = StrandOrder::exact;
  frame.render(settings, 32, 32, 1);
  const std::vector<std::string> names{"smooth", "tangents", "upload", "fill", "transmittance",
                                       "filter", "order",    "draw",   "read"};
  const auto changed = [&] {
    std::vector<std::uint64_t> before;
    for (const auto& name : names) before.push_back(frame.ledger().calls(name));
    frame.render(settings, 32, 32, 1);
    std::string ran;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto n = frame.ledger().calls(names[i]) - before[i];
      if (n > 0) ran += names[i] + (n > 1 ? " x" + std::to_string(n) + " " : " ");
    }
    return ran;
  };
  EXPECT_EQ(changed(), "draw read ");
  settings.camera.eye.x = 0.1F;  // [Bertails2005 Fig. 4]: no shadow is computed for a camera that moves
  EXPECT_EQ(changed(), "draw read ");
  settings.strands.order = StrandOrder::sorted;
  EXPECT_EQ(changed(), "order draw read ");
  EXPECT_EQ(changed(), "draw read ");
  settings.camera.eye.x = 0.0F;
  EXPECT_EQ(changed(), "order draw read ");
  settings.strands.order = StrandOrder::exact;
  EXPECT_EQ(changed(), "draw read ");
  settings.material.primary = 0.5F;
  settings.lights[0].intensity = 0.3F;
  settings.lights[1].colour = {1, 0.5F, 0};
  settings.strands.lobes = StrandLobes::kajiya_kay;
  settings.strands.shape = StrandShape::lines;
  EXPECT_EQ(changed(), "draw read ");
  settings.lights[1].direction.x = -0.7F;  // the other light's map stays
  EXPECT_EQ(changed(), "fill transmittance filter draw read ");
  settings.lights.pop_back();
  EXPECT_EQ(changed(), "filter draw read ");
  settings.shadow.density_map.resolution = 40;
  EXPECT_EQ(changed(), "fill transmittance filter draw read ");
  settings.strands.smoothing = 2;
  EXPECT_EQ(changed(), "smooth tangents upload fill transmittance filter draw read ");
  frame.set_strands(strand_lock(30, 24, {0.01F, 0.1F, 0}));
  EXPECT_EQ(changed(), "smooth tangents upload fill transmittance filter draw read ");
  for (const Stage& s : frame.ledger().stages()) {
    EXPECT_EQ(s.milliseconds > 0.0, s.name != "order") << s.name;  // order is that of another frame
  }
}

TEST_F(StrandFrames, ALaterFrameEqualsAFreshOne) {
  // What is kept from frame to frame is not stale.
  struct Step {
    StrandFrameSettings settings;
    Strands strands;
  };
  std::vector<Step> all{{strands_from_the_front(), strand_lock(60)}};
  all[0].settings.strands.order = StrandOrder::exact;
  all[0].settings.strands.shape = StrandShape::ribbons;
  const auto then = [&](auto change) {
    all.push_back(all.back());
    change(all.back().settings, all.back().strands);
  };
  using S = StrandFrameSettings;
  then([](S& s, Strands&) { s.camera.eye = {0.3F, 0.2F, 0.4F}; });
  then([](S& s, Strands&) { s.lights.push_back({{-1, 0.2F, 0.3F}, {}, {1, 0.5F, 0.2F}, 0.7F}); });
  then([](S& s, Strands&) { s.lights[0].position = glm::vec3(0.2F, 0.3F, 0.4F); });
  then([](S& s, Strands&) { s.strands.order = StrandOrder::sorted; });
  then([](S& s, Strands&) { s.camera.eye = {-0.3F, 0.2F, -0.4F}; });
  then([](S& s, Strands&) { s.camera.target = {0, 0.05F, 0}; });
  then([](S&, Strands& h) { h = strand_lock(60, 24, {0.01F, 0.1F, 0.02F}); });
  then([](S&, Strands& h) { h = strand_lock(70, 20); });
  then([](S& s, Strands&) { s.strands.order = StrandOrder::weighted; });
  then([](S& s, Strands&) { s.shadow.density_map.resolution = 12; });
  then([](S& s, Strands&) { s.lights[0].position.reset(); });
  then([](S& s, Strands&) { s.method = Method::deep_opacity; });
  then([](S& s, Strands&) { s.shadow.opacity_map.layers = 2; });
  then([](S& s, Strands&) { s.strands.smoothing = 3; });
  then([](S&, Strands& h) { h.colours.assign(h.count(), {0.5F, 0.1F, 0.4F}); });
  then([](S& s, Strands&) { s.method = Method::unshadowed; });
  then([](S& s, Strands&) { s.strands.shape = StrandShape::lines; });
  then([](S& s, Strands&) { s.lights.pop_back(); });
  StrandFrame frame(all[0].strands, 0.6F, test::wall());
  std::vector<float> last;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool moved = i > 0 && all[i].strands.vertices != all[i - 1].strands.vertices;
    if (moved || all[i].strands.colours.size() != frame.strands().colours.size()) frame.set_strands(all[i].strands);
    const Image later = checked(frame.render(all[i].settings, 48, 48, 1));
    const Image fresh = StrandFrame(all[i].strands, 0.6F, test::wall()).render(all[i].settings, 48, 48, 1);
    EXPECT_EQ(later.rgba, fresh.rgba) << "step " << i;
    EXPECT_NE(later.rgba, last) << "step " << i << " changes nothing";
    last = later.rgba;
  }
}

TEST_F(StrandFrames, LightsAddUp) {
  StrandFrame frame(strand_lock(100), 0.6F, test::wall());
  StrandFrameSettings settings = strands_from_the_front();
  const Light a{{1, 1, 1}, {}, {1, 1, 1}, 0.5F}, b{{}, glm::vec3(-0.2F, 0.2F, 0.3F), {0.2F, 1, 0.4F}, 0.05F};
  const auto with = [&](std::vector<Light> lights) {
    settings.lights = std::move(lights);
    return checked(frame.render(settings, 48, 48, 1));
  };
  Image sum = with({a});
  const Image second = with({b});
  EXPECT_GT(mean(second, 1), 0.002);
  for (std::size_t i = 0; i < sum.rgba.size(); ++i)
    if (i % 4 != 3) sum.rgba[i] += second.rgba[i];
  // Lists hold half floats: 2^-12 of each fragment's colour, below 1 here.
  EXPECT_LT(difference(sum, with({a, b})).most, 4 * 0x1p-12);
}

TEST_F(StrandFrames, WithoutLightHairIsBlackNotGone) {
  StrandFrame frame(strand_lock(50), 0.6F, {});
  StrandFrameSettings settings = strands_from_the_front();
  const Image lit = checked(frame.render(settings, 32, 32, 1));
  settings.lights.clear();
  const Image dark = checked(frame.render(settings, 32, 32, 1));
  EXPECT_EQ(mean(dark, 1), 0.0);
  EXPECT_DOUBLE_EQ(mean(dark, 3), mean(lit, 3));
}

TEST_F(StrandFrames, HairShadowsItselfAndTheHead) {
  StrandFrame frame(strand_lock(300), 0.6F, test::wall());
  StrandFrameSettings settings = strands_from_the_front();
  settings.lights[0].direction = {0, 0, 1};
  settings.camera.eye = {0, 0, -0.6F};  // from behind the wall hides the hair
  const Image with = checked(frame.render(settings, 48, 48, 1));
  settings.method = Method::unshadowed;
  const Image without = checked(frame.render(settings, 48, 48, 1));
  EXPECT_LT(mean(with, 0), 0.99 * mean(without, 0));
  EXPECT_EQ(without.rgba, checked(StrandFrame({}, 0.6F, test::wall()).render(settings, 48, 48, 1)).rgba)
      << "the wall occludes";
  // Ambient light is not shadowed [Bertails2005 section 3.3]: from behind, where no light gets, it is all there is.
  StrandFrame hair(strand_lock(3000), 0.6F, {});
  settings.camera.eye = {0, 0, -0.6F};
  settings.method = Method::density_map;
  const Image dark = checked(hair.render(settings, 48, 48, 2));
  settings.material.ambient = 0;
  EXPECT_LT(mean(checked(hair.render(settings, 48, 48, 2)), 0), 0.7 * mean(dark, 0));
}

TEST_F(StrandFrames, EachSwitchTakesItsTermAway) {
  StrandFrame frame(strand_lock(100), 0.6F, {});
  StrandFrameSettings settings = strands_from_the_front();
  settings.lights[0].direction = {0.3F, 0.1F, 1};
  const Image reference = checked(frame.render(settings, 48, 48, 2));
  for (bool StrandSettings::*const term :
       {&StrandSettings::diffuse, &StrandSettings::primary_highlight, &StrandSettings::secondary_highlight}) {
    StrandFrameSettings other = settings;
    other.strands.*term = false;
    const Image image = checked(frame.render(other, 48, 48, 2));
    EXPECT_LT(mean(image, 0), 0.99 * mean(reference, 0));
    EXPECT_EQ(mean(image, 3), mean(reference, 3));
  }
  // Kajiya-Kay: one highlight, unshifted; the same as a material that says so.
  StrandFrameSettings one = settings, said = settings;
  one.strands.lobes = StrandLobes::kajiya_kay;
  said.material.primary_shift = said.material.secondary = 0;
  const Image kajiya_kay = checked(frame.render(one, 48, 48, 2));
  EXPECT_EQ(kajiya_kay.rgba, frame.render(said, 48, 48, 2).rgba);
  EXPECT_GT(difference(kajiya_kay, reference).rms, 1e-4);
}

TEST_F(StrandFrames, OwnColoursReplaceTheMaterials) {
  Strands strands = strand_lock(2, 8);
  strands.colours = {{1, 0, 0}, {0, 0, 1}};
  StrandFrame frame(strands, 0.6F, {});
  StrandFrameSettings settings = strands_from_the_front();
  test::shade_flat(settings);
  const Image image = checked(frame.render(settings, 64, 64, 1));
  EXPECT_GT(mean(image, 0), 1e-4);
  EXPECT_GT(mean(image, 2), 1e-4);
  EXPECT_EQ(mean(image, 1), 0.0);
  EXPECT_NEAR(mean(image, 0) + mean(image, 2), mean(image, 3), 1e-3 * mean(image, 3)) << "nothing else is drawn";
  settings = strands_from_the_front();
  settings.lights[0].direction = {0.3F, 0.1F, 1};
  settings.strands.primary_highlight = false;  // has the light's colour
  for (bool StrandSettings::*const other : {&StrandSettings::diffuse, &StrandSettings::secondary_highlight}) {
    settings.strands.diffuse = settings.strands.secondary_highlight = true;
    settings.strands.*other = false;
    const Image one = checked(frame.render(settings, 64, 64, 1));
    EXPECT_GT(mean(one, 0), 1e-7);
    EXPECT_EQ(mean(one, 1), 0.0);
  }
}

TEST_F(StrandFrames, ShadowAtFragmentsIsLikeShadowAtVertices) {
  StrandFrame frame(strand_lock(500, 100), 0.6F, {});
  StrandFrameSettings settings = strands_from_the_front();
  const Image vertices = checked(frame.render(settings, 64, 96, 1));
  settings.strands.shadow_at = ShadowAt::fragment;
  const Image fragments = checked(frame.render(settings, 64, 96, 1));
  settings.method = Method::unshadowed;
  const Image without = checked(frame.render(settings, 64, 96, 1));
  const double d = difference(vertices, fragments).rms, shadow = difference(vertices, without).rms;
  std::printf("shadow at fragments against vertices: rms %.2g; shadow itself %.2g\n", d, shadow);
  // Vertices are 2 mm apart, cells 6 mm: linear between vertices is about what the map is.
  EXPECT_LT(d, 0.02 * shadow);
}

/// Eight strands across the picture, a pixel of each.
TEST_F(StrandFrames, ColoursVaryByTheStrandsOwnFactor) {
  Strands strands;
  for (int i = 0; i < 8; ++i) {
    const float y = 0.01F * float(i) - 0.035F;
    strands.append(std::vector<glm::vec3>{{-0.2F, y, 0}, {0, y, 0}, {0.2F, y, 0}});
  }
  strands.diameter_m = 8e-3F;
  for (const bool own : {false, true}) {
    if (own) strands.colours.assign(8, {0.5F, 0.25F, 0.125F});
    StrandFrame frame(strands, 1.0F, {});
    StrandFrameSettings settings = strands_from_the_front();
    settings.camera.eye = {0, 0, 1};
    settings.camera.fov_deg = static_cast<float>(2 * std::atan(0.04) * 180 / 3.14159265358979);
    settings.material.primary = 0;             // is the light's colour and does not vary
    settings.strands.smoothing = own ? 3 : 1;  // pieces of a curve are of their strand
    const Image plain = checked(frame.render(settings, 1, 8, 1));
    settings.material.variation = 0.8F;
    const Image varied = checked(frame.render(settings, 1, 8, 1));
    for (int i = 0; i < 8; ++i) {
      const glm::vec3 tint = strand_tint(static_cast<std::uint32_t>(i), 0.8F);
      for (int c = 0; c < 3; ++c) {
        // Rounding of a few sums and products on either side.
        EXPECT_NEAR(varied.pixel(0, 7 - i)[c] / plain.pixel(0, 7 - i)[c], tint[c], 1e-5F)
            << "strand " << i << ", own colours " << own;
      }
    }
    settings.material.variation = 0;
    EXPECT_EQ(frame.render(settings, 1, 8, 1).rgba, plain.rgba);
  }
}

}  // namespace
}  // namespace pelage
