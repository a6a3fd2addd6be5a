// A video from numbered pictures, by ffmpeg where it is installed.
#pragma once

#include <filesystem>

namespace pelage::app {

/// @throws UsageError with the remedy where there is no ffmpeg in PATH, or the file's folder does not exist
void check_video(const std::filesystem::path& file);

/// Of frame_0000.png and on in a folder, and not of what else is there. @throws OutputError; ffmpeg says why itself
void make_video(const std::filesystem::path& folder, int frames, double fps, const std::filesystem::path& file);

}  // namespace pelage::app
