// A trade-off as files for other programs, and its rows read back: a sweep goes on from them.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pelage/tradeoff/tradeoff.h"

namespace pelage::app {

/// Every field under its own name, of failed rows too. Numbers that JSON cannot write are null (not a number) and the
/// words "inf" and "-inf". Text keeps its bytes here; written to a file, bytes that are not UTF-8 become U+FFFD.
nlohmann::ordered_json row_json(const TradeoffRow& row);

/// Exactly what row_json was given. @param file  for messages  @throws InputError naming file and key: a key that is
/// missing, unknown, or holds what it cannot
TradeoffRow row_from_json(const nlohmann::json& json, const std::string& file);

/// row_json as a file, and back. @throws OutputError, InputError
void write_row(const TradeoffRow& row, const std::filesystem::path& file);
TradeoffRow read_row(const std::filesystem::path& file);

nlohmann::ordered_json tradeoff_json(const Tradeoff& tradeoff);

/// A line of names, then one line per row [RFC 4180]; figures of a failed row are empty.
std::string tradeoff_csv(const Tradeoff& tradeoff);

/// tradeoff.json and tradeoff.csv; each whole or not at all. @throws OutputError
void write_tradeoff(const Tradeoff& tradeoff, const std::filesystem::path& folder);

}  // namespace pelage::app
