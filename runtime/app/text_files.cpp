#include "pelage/app/text_files.h"

#include "pelage/data_schema/output_file.h"

namespace pelage::app {

void write_text(const std::string& text, const std::filesystem::path& file) {
  AtomicFile out(file);
  out.write(text);
  out.commit();
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace pelage::app
