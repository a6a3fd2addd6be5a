# Installs the boxes, their headers and the package files that find_package(Pelage) reads.
include(CMakePackageConfigHelpers)
get_property(boxes GLOBAL PROPERTY PELAGE_BOXES)
install(TARGETS ${boxes} EXPORT PelageTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(target IN LISTS boxes)
  string(REPLACE "pelage_" "" box ${target})
  get_target_property(folder ${target} SOURCE_DIR)
  install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pelage/${box} FILES_MATCHING PATTERN "*.h"
          PATTERN console EXCLUDE)
endforeach()
