/// What the packs of an ensemble have in common: NAME.ensemble.csv, .json, .md.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace packmpi::report {

/// Quantities of a pack that the tables compare, by their names in NAME.json ("achieved").
inline constexpr std::array ensemble_quantities{"phi",          "phi_bulk",     "porosity_bulk", "void_ratio_bulk",
                                                "coordination", "mean_overlap", "height",        "particles"};

struct EnsembleRow {
  int set = 0, pack = 0;
  std::uint64_t seed = 0;
  int code = 0;                                             ///< exit code of the pack
  std::array<double, ensemble_quantities.size()> values{};  ///< NaN if there is no pack
};

struct EnsembleTable {
  std::string name;
  std::vector<EnsembleRow> packs;
};

/// Rank-local. A row with the values of the summary file (NAME.json) of the pack; none: "". Throws Error(io_failure).
[[nodiscard]] EnsembleRow ensemble_row(int set, int pack, std::uint64_t seed, int code, const std::string& summary);

/// Mean, standard deviation (n - 1), coefficient of variation, and the half width of the 95 % confidence interval of
/// the mean (Student's t) of those values that are numbers. Local.
struct Statistics {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  int count = 0;
  double mean = unknown, sd = unknown, variation = unknown, confidence = unknown;  ///< NaN: too few packs to tell
};
[[nodiscard]] Statistics statistics(const std::vector<double>& values);

[[nodiscard]] std::string to_csv(const EnsembleTable& table);       ///< a row a pack
[[nodiscard]] std::string to_json(const EnsembleTable& table);      ///< packs, and statistics of each set and of all
[[nodiscard]] std::string to_markdown(const EnsembleTable& table);  ///< statistics of each set and of all

}  // namespace packmpi::report
