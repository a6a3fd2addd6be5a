# Debian 12 packages, installed by scripts/install-dependencies.sh. Targets are used only by the boxes named.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(glm REQUIRED)            # every box: vectors
find_package(Eigen3 REQUIRED)         # data_schema, runtime/hair: fits
find_package(nlohmann_json REQUIRED)  # data_schema: JSON
find_package(spdlog REQUIRED)         # bake/console: log
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)          # programs: options
find_package(SQLite3 REQUIRED)        # db only
find_package(embree 3 REQUIRED)       # runtime/reference: ray tracing
find_package(TBB REQUIRED)            # threads
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)            # FLANN's headers need it, and nothing else of FLANN's list
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)           # runtime/render
pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)               # runtime/render
pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)      # runtime/image only (its CMake package is broken on Debian 12)
find_package(glfw3 REQUIRED)          # runtime/render: windows
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)             # db only, one translation unit
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
find_path(VALIJSON_INCLUDE_DIR valijson/validator.hpp REQUIRED)   # data_schema: JSON Schema
if(PELAGE_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(rapidcheck REQUIRED)   # tests/simulate: properties
  include(GoogleTest)
endif()
if(PELAGE_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
