// Bake settings as JSON (schemas/bake.schema.json).
#include "pelage/data_schema/bake_settings_fields.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/json_file.h"
#include "pelage/data_schema/validate.h"

namespace pelage {

void check(const BakeSettings& settings, const std::string& where) {
  if (settings.phong.diffuse + settings.phong.specular <= 0)
    throw InputError(where, "phong: diffuse and specular are both 0: nothing would be reflected; raise one");
}

BakeSettings bake_settings_from_json(const std::string& text, const std::string& where) {
  const nlohmann::json document = parse_json(text, where);
  validate(document, "bake", where);
  BakeSettings settings;
  json_fields::get(document, settings);
  check(settings, where);
  return settings;
}

BakeSettings load_bake_settings(const std::filesystem::path& file) {
  return bake_settings_from_json(read_text(file), file.string());
}

std::string to_json(const BakeSettings& settings) {
  nlohmann::ordered_json document = {{"version", 1}};
  document.update(json_fields::put(settings));
  return json_fields::text_of(document);
}

}  // namespace pelage
