#include "pelage/app/picture.h"

#include <spdlog/spdlog.h>

#include "pelage/image/image_file.h"
#include "pelage/image/tone.h"

namespace pelage::app {

Image finished(Image image, const ImageSettings& settings) {
  expose(image, settings.exposure);
  compose_over(image, settings.background, settings.backdrop);
  return image;
}

void write_picture(Image image, const Scene& scene, const std::filesystem::path& file) {
  if (const std::size_t bad = remove_non_finite(image); bad > 0)
    spdlog::warn("{}: {} values were not finite", file.string(), bad);
  write_image(finished(std::move(image), scene.image), file,
              {{"Software", "pelage"}, {"pelage:scene", to_json(scene)}});
}

}  // namespace pelage::app
