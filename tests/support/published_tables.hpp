// The tables that Stable32 printed for two public sets of phases, and how far ours are from them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <zlib.h>

#include "goingrate/spectra/stability.hpp"
#include "support/real_data.hpp"

namespace goingrate::test {

/// A printed table and the options it was made with.
struct PublishedTable {
  std::string_view file, data; ///< inside the folder of public measurements
  DeviationKind kind;
  std::size_t rows;              ///< how many it has, those in remarks included
  bool remove_bias = true;       ///< whether the program was told to
  std::optional<int> alpha = {}; ///< the noise it was told to assume
  double variance_factor = 1.0;  ///< its variances over ours, where its bias differs; see below
};

inline constexpr std::string_view phase_dat = "stable32-phasedat/PHASE.DAT";
inline constexpr std::string_view gps = "gps-1pps/gps_1pps_phase_data.txt.gz";

// Where the tables and SP 1065 differ:
// - The octave and decade tables of MTOTDEV and TTOTDEV are without bias removed, those of all tau
//   with it; only the values tell (0.20664 and 0.24185 at m = 1 of the same phases, a ratio of
//   sqrt 0.73).
// - HTOTDEV with "alpha 2" was made to switch the correction off.
// - THEO1 for alpha = 1: its variances are 0.60279 times the uncorrected ones at every m. SP 1065
// has
//   0.14 + 0.82/m^0.30 (0.551 at m = 10, 0.243 at m = 998). The factor is taken from the first
//   row and then holds for all 181; where it comes from is not documented.
inline constexpr std::array published_tables = {
    PublishedTable{"stable32-phasedat/phase_dat_adev.txt", phase_dat, DeviationKind::adev, 125},
    PublishedTable{"stable32-phasedat/phase_dat_adev_octave.txt", phase_dat, DeviationKind::adev,
                   8},
    PublishedTable{"stable32-phasedat/phase_dat_oadev.txt", phase_dat, DeviationKind::oadev, 139},
    PublishedTable{"stable32-phasedat/phase_dat_oadev_octave.txt", phase_dat, DeviationKind::oadev,
                   8},
    PublishedTable{"stable32-phasedat/phase_dat_mdev.txt", phase_dat, DeviationKind::mdev, 139},
    PublishedTable{"stable32-phasedat/phase_dat_mdev_octave.txt", phase_dat, DeviationKind::mdev,
                   8},
    PublishedTable{"stable32-phasedat/phase_dat_tdev.txt", phase_dat, DeviationKind::tdev, 139},
    PublishedTable{"stable32-phasedat/phase_dat_tdev_octave.txt", phase_dat, DeviationKind::tdev,
                   8},
    PublishedTable{"stable32-phasedat/phase_dat_hdev.txt", phase_dat, DeviationKind::hdev, 125},
    PublishedTable{"stable32-phasedat/phase_dat_hdev_octave.txt", phase_dat, DeviationKind::hdev,
                   8},
    PublishedTable{"stable32-phasedat/phase_dat_ohdev.txt", phase_dat, DeviationKind::ohdev, 139},
    PublishedTable{"stable32-phasedat/phase_dat_ohdev_octave.txt", phase_dat, DeviationKind::ohdev,
                   8},
    PublishedTable{"stable32-phasedat/phase_dat_totdev.txt", phase_dat, DeviationKind::totdev, 185},
    PublishedTable{"stable32-phasedat/phase_dat_totdev_octave.txt", phase_dat,
                   DeviationKind::totdev, 9},
    PublishedTable{"stable32-phasedat/phase_dat_mtotdev.txt", phase_dat, DeviationKind::mtotdev,
                   158},
    PublishedTable{"stable32-phasedat/phase_dat_mtotdev_octave.txt", phase_dat,
                   DeviationKind::mtotdev, 9, false},
    PublishedTable{"stable32-phasedat/phase_dat_mtotdev_octave_alpha0.txt", phase_dat,
                   DeviationKind::mtotdev, 9, false, 0},
    PublishedTable{"stable32-phasedat/phase_dat_mtotdev_decade.txt", phase_dat,
                   DeviationKind::mtotdev, 8, false},
    PublishedTable{"stable32-phasedat/phase_dat_ttotdev_all.txt", phase_dat, DeviationKind::ttotdev,
                   158},
    PublishedTable{"stable32-phasedat/phase_dat_ttotdev_octave.txt", phase_dat,
                   DeviationKind::ttotdev, 9, false},
    PublishedTable{"stable32-phasedat/phase_dat_ttotdev_decade.txt", phase_dat,
                   DeviationKind::ttotdev, 8, false},
    PublishedTable{"stable32-phasedat/phase_dat_htotdev_octave.txt", phase_dat,
                   DeviationKind::htotdev, 9},
    PublishedTable{"stable32-phasedat/phase_dat_htotdev_octave_nobias.txt", phase_dat,
                   DeviationKind::htotdev, 9, false, 2},
    PublishedTable{"stable32-phasedat/phase_dat_theo1.txt", phase_dat, DeviationKind::theo1, 181,
                   false, 1, 0.60279},
    PublishedTable{"stable32-phasedat/phase_dat_theo1_alpha0.txt", phase_dat, DeviationKind::theo1,
                   181, true, 0},
    PublishedTable{"stable32-phasedat/phase_dat_theo1_alpha0_decade.txt", phase_dat,
                   DeviationKind::theo1, 7, true, 0},
    PublishedTable{"stable32-phasedat/phase_dat_mtie.txt", phase_dat, DeviationKind::mtie, 9},
    PublishedTable{"stable32-phasedat/phase_dat_tierms.txt", phase_dat, DeviationKind::tierms, 139},
    PublishedTable{"gps-1pps/stable32_ADEV_decade.txt", gps, DeviationKind::adev, 15},
    PublishedTable{"gps-1pps/stable32_OADEV_octave.txt", gps, DeviationKind::oadev, 16},
    PublishedTable{"gps-1pps/stable32_MDEV_octave.txt", gps, DeviationKind::mdev, 16},
    PublishedTable{"gps-1pps/stable32_TDEV_octave.txt", gps, DeviationKind::tdev, 16},
    PublishedTable{"gps-1pps/stable32_HDEV_octave.txt", gps, DeviationKind::hdev, 16},
    PublishedTable{"gps-1pps/stable32_OHDEV_octave.txt", gps, DeviationKind::ohdev, 16},
    PublishedTable{"gps-1pps/stable32_TOTDEV_octave.txt", gps, DeviationKind::totdev, 17}};

/// A printed row; `alpha`, `low` and `high` are NaN where the table has no such column, the last
/// two also where it holds zeros.
struct PrintedRow {
  std::size_t m, n;
  double tau, value, alpha, low, high;
};

/// Ours next to a printed one.
struct ComparedRow {
  PrintedRow printed;
  DeviationRow ours;
  double difference; ///< of the values, in units of the printed fifth digit
};

/// Numbers of a file, one to a line; lines that start with # are remarks. zlib reads plain files
/// too.
inline std::vector<double> read_phase(const std::filesystem::path& path) {
  std::vector<double> phase;
  gzFile file = gzopen(path.c_str(), "rb");
  std::array<char, 256> line{};
  while (file != nullptr && gzgets(file, line.data(), static_cast<int>(line.size())) != nullptr)
    if (line[0] != '#') phase.push_back(std::strtod(line.data(), nullptr));
  gzclose(file);
  return phase;
}

/// The rows of a table: factor, tau, count, and then the value alone or alpha, low, value and high.
/// Rows that were turned into remarks (a # before the numbers) are rows too.
inline std::vector<PrintedRow> read_table(const std::filesystem::path& path) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<PrintedRow> rows;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] == '#') line[0] = ' ';
    std::istringstream words(line);
    std::vector<double> v;
    for (double number; words >> number;)
      v.push_back(number);
    if (!words.eof() || (v.size() != 4 && v.size() != 7)) continue;
    PrintedRow row{static_cast<std::size_t>(v[0]),
                   static_cast<std::size_t>(v[2]),
                   v[1],
                   v[3],
                   none,
                   none,
                   none};
    if (v.size() == 7) row.alpha = v[3], row.value = v[5];
    if (v.size() == 7 && v[4] > 0.0) row.low = v[4], row.high = v[6];
    rows.push_back(row);
  }
  return rows;
}

/// Computes what a table shows; nothing if the folder does not have it.
inline std::optional<std::vector<ComparedRow>> compare(const PublishedTable& table) {
  const auto data = real_data(table.data), file = real_data(table.file);
  if (!data || !file) return std::nullopt;
  const std::vector<PrintedRow> printed = read_table(*file);
  std::vector<std::size_t> factors;
  for (const PrintedRow& row : printed)
    factors.push_back(row.m);
  const DeviationTable ours = stability_table(table.kind, read_phase(*data), 1.0, factors,
                                              {table.alpha, table.remove_bias, 0});
  std::vector<ComparedRow> rows;
  for (std::size_t i = 0; i < printed.size(); ++i) {
    const double unit = std::pow(10.0, std::floor(std::log10(printed[i].value)) - 4.0);
    const double value = ours.rows[i].value * std::sqrt(table.variance_factor);
    rows.push_back({printed[i], ours.rows[i], (value - printed[i].value) / unit});
  }
  return rows;
}

} // namespace goingrate::test
