#include "pelage/image/image_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/image/tone.h"

namespace pelage {

void check_picture_name(const std::filesystem::path& file) {
  if (file.extension() == ".png" || file.extension() == ".exr") return;
  throw UsageError("-o: '" + file.string() + "' has no extension that is written; use .png or .exr");
}

void write_image(const Image& image, const std::filesystem::path& file,
                 const std::map<std::string, std::string>& attributes) {
  check_picture_name(file);
  const std::string extension = file.extension().string();
  const bool png = extension == ".png";
  AtomicFile out(file);
  // Encoded in memory: OpenImageIO's PNG writer does not tell when the disk is full.
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  auto writer = OIIO::ImageOutput::create(extension.substr(1));
  OIIO::ImageSpec spec(image.width, image.height, 4, png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::HALF);
  if (png) spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("oiio:ColorSpace", png ? "sRGB" : "Linear");
  // The same picture, the same bytes: left alone, OpenImageIO writes the time of day into EXR files.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  for (const auto& [name, value] : attributes) spec.attribute(name, value);
  bool good = writer != nullptr && writer->set_ioproxy(&memory) && writer->open(file.filename().string(), spec);
  if (good && png) {
    good = writer->write_image(OIIO::TypeDesc::UINT8, to_srgb8(image).data());
  } else if (good) {
    good = writer->write_image(OIIO::TypeDesc::FLOAT, image.rgba.data());
  }
  if (good) good = writer->close();
  if (!good || bytes.empty()) throw OutputError(file.string(), writer ? writer->geterror() : OIIO::geterror());
  out.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  out.commit();
}

Image read_image(const std::filesystem::path& file) {
  auto reader = OIIO::ImageInput::open(file.string());
  if (!reader) throw InputError(file.string(), OIIO::geterror());
  const OIIO::ImageSpec& spec = reader->spec();
  if (spec.nchannels != 4)
    throw InputError(file.string(), "has " + std::to_string(spec.nchannels) + " channels; 4 (RGBA) are read");
  Image image(spec.width, spec.height);
  if (!reader->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, image.rgba.data()))
    throw InputError(file.string(), reader->geterror());
  if (spec.format == OIIO::TypeDesc::UINT8) {
    // OpenImageIO hands PNG over with associated alpha in the encoded domain; ours is associated in linear light.
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const float alpha = image.rgba[i + 3];
      for (std::size_t c = 0; c < 3 && alpha > 0.0F; ++c)
        image.rgba[i + c] = alpha * srgb_decode(image.rgba[i + c] / alpha);
    }
  }
  return image;
}

}  // namespace pelage
