// Time of whole stability tables (values, noise types and intervals) for stability.sh.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <vector>

#include "goingrate/base/random.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/spectra/stability.hpp"
#include "support/published_tables.hpp"

namespace {

using namespace goingrate;
using Kind = DeviationKind;

struct Case {
  Kind kind;
  std::size_t points;
};

constexpr Case cases[] = {
    {Kind::adev, 1'000'000}, {Kind::oadev, 1'000'000},  {Kind::oadev, 10'000'000},
    {Kind::mdev, 1'000'000}, {Kind::hdev, 1'000'000},   {Kind::ohdev, 1'000'000},
    {Kind::totdev, 100'000}, {Kind::totdev, 1'000'000}, {Kind::mtotdev, 4'000},
    {Kind::htotdev, 4'000},  {Kind::theo1, 20'000},     {Kind::theo1, 100'000},
    {Kind::mtie, 100'000},   {Kind::mtie, 1'000'000},   {Kind::tierms, 1'000'000},
    {Kind::pdev, 1'000'000}};

// A walk of white frequency noise with white phase noise on top.
std::vector<double> walk(std::size_t points) {
  RandomStream stream(1, StreamPurpose::jitter);
  std::vector<double> phase(points);
  double sum = 0.0;
  for (double& x : phase) {
    sum += stream.normal();
    x = sum + 3.0 * stream.normal();
  }
  return phase;
}

double median_seconds(Kind kind, const std::vector<double>& phase, const DeviationOptions& options,
                      const std::vector<std::size_t>& factors, DeviationTable& table) {
  std::vector<double> seconds;
  constexpr double budget_s = 0.3; // in all; short runs scatter most
  for (double spent = 0.0; seconds.size() < 3 || (spent < budget_s && seconds.size() < 51);
       spent += seconds.back()) {
    seconds.push_back(
        thread_seconds([&] { table = stability_table(kind, phase, 1.0, factors, options); }));
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

// Kind, points, seconds, seconds without looking for the noise, and factor = value of every row.
void print_case(const Case& one, const std::vector<double>& all) {
  const std::vector<double> phase(all.begin(), all.begin() + static_cast<long>(one.points));
  DeviationTable table;
  const double seconds = median_seconds(one.kind, phase, {.remove_bias = false, .threads = 1},
                                        octave_factors(one.points, one.kind), table);
  DeviationTable plain; // the noise given, so that it need not be looked for
  const double given =
      median_seconds(one.kind, phase, {.alpha = 0, .remove_bias = false, .threads = 1},
                     octave_factors(one.points, one.kind), plain);
  std::printf("%s %zu %.6f %.6f", std::string(name_of(one.kind)).c_str(), one.points, seconds,
              given);
  for (const DeviationRow& row : table.rows)
    std::printf(" %zu=%.12g", row.m, row.value);
  std::printf("\n");
  std::fflush(stdout);
}

void print_threads() {
  const std::vector<double> phase = walk(100'000);
  for (std::size_t threads : {1u, 2u}) {
    const auto begin = std::chrono::steady_clock::now();
    (void)stability_table(Kind::oadev, phase, 1.0, all_factors(phase.size()), {.threads = threads});
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::printf("oadev, all 49999 factors of 100000 phases, %zu thread(s): %.2f s\n", threads,
                took.count());
  }
}

void print_published() {
  std::printf("%-44s %5s %7s %16s\n", "table", "rows", "differ", "worst, relative");
  for (const test::PublishedTable& table : test::published_tables) {
    const auto rows = test::compare(table);
    if (!rows) continue;
    std::size_t others = 0;
    double worst = 0.0;
    for (const test::ComparedRow& row : *rows) {
      const bool other_noise =
          !std::isnan(row.printed.alpha) && row.ours.alpha != static_cast<int>(row.printed.alpha);
      others += other_noise ? 1 : 0;
      const double value = row.ours.value * std::sqrt(row.ours.bias * table.variance_factor);
      const double unbiased =
          other_noise ? value : row.ours.value * std::sqrt(table.variance_factor);
      if (!other_noise || row.ours.bias == 1.0)
        worst = std::max(worst, std::abs(unbiased / row.printed.value - 1.0));
    }
    const std::string file(table.file.substr(table.file.find('/') + 1));
    std::printf("%-44s %5zu %7zu %16.1e\n", file.c_str(), rows->size(), others, worst);
  }
}

} // namespace

// study_stability write FILE | time | threads | published
int main(int argc, char** argv) {
  const std::vector<double> all = walk(10'000'000);
  if (argc == 3 && std::strcmp(argv[1], "write") == 0) {
    std::FILE* file = std::fopen(argv[2], "wb");
    if (file == nullptr) return 1;
    const bool whole = std::fwrite(all.data(), sizeof(double), all.size(), file) == all.size();
    return std::fclose(file) == 0 && whole ? 0 : 1;
  }
  if (argc != 2) return 2;
  if (std::strcmp(argv[1], "time") == 0)
    for (const Case& one : cases)
      print_case(one, all);
  if (std::strcmp(argv[1], "threads") == 0) print_threads();
  if (std::strcmp(argv[1], "published") == 0) print_published();
}
