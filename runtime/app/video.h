// A video from numbered pictures, by ffmpeg where it is installed.
#pragma once

#include <filesystem>
#include <string>

namespace pelage::app {

/// @throws UsageError with the remedy where there is no ffmpeg in PATH, or the file's folder does not exist
void check_video(const std::filesystem::path& file);

/// @param pictures  as ffmpeg names them: "folder/frame_%04d.png"   @throws OutputError with ffmpeg's own words
void make_video(const std::string& pictures, double fps, const std::filesystem::path& file);

}  // namespace pelage::app
