// Output files as the programs use them; the code is in data_schema, because libraries write files too.
#pragma once

#include "pelage/data_schema/output_file.h"

namespace pelage::console {
using pelage::AtomicFile;
using pelage::check_writable;
}  // namespace pelage::console
