#include "pelage/app/output_folder.h"

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"

namespace pelage::app {

void make_folder(const std::filesystem::path& folder, const std::string& first_file) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error) throw OutputError(folder.string(), error.message() + ": give a folder, or the name of one to be made");
  check_writable(folder / first_file);
}

}  // namespace pelage::app
