// Reads and numbers a year of a seconds pendulum: speed and memory.
#include "goingrate/log/reading.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/base/thread_clock.hpp"
#include "goingrate/log/beats.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <vector>

namespace {

using namespace goingrate;

// Unix seconds with 12 decimals, one per line: a period of 2.0001 s and 10 us of jitter.
void write_year(const char* path, std::int64_t beats) {
  std::FILE* file = std::fopen(path, "w");
  if (file == nullptr) std::exit(1);
  RandomStream random(1, StreamPurpose::jitter);
  for (std::int64_t i = 0; i < beats; ++i) {
    // Beyond the even seconds, in ps: what 64 bits hold.
    const auto jitter_ps = static_cast<std::int64_t>(1e7 * random.normal());
    const std::int64_t ps = 227990600000 + 100000000 * i + jitter_ps;
    constexpr std::int64_t second = 1000000000000;
    std::fprintf(file, "%lld.%012lld\n", static_cast<long long>(1361605080 + 2 * i + ps / second),
                 static_cast<long long>(ps % second));
  }
  std::fclose(file);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

} // namespace

// study_reading write FILE BEATS | study_reading read FILE
int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "write") == 0) {
    write_year(argv[2], std::atoll(argv[3]));
    return 0;
  }
  if (argc != 3) return 2;
  struct stat status {};
  if (::stat(argv[2], &status) != 0) return 1;
  const double megabytes = 1e-6 * static_cast<double>(status.st_size);
  std::vector<double> reading, numbering;
  std::size_t events = 0;
  constexpr int runs = 5;
  for (int run = 0; run < runs; ++run) {
    ClockLog log;
    Beats beats;
    reading.push_back(thread_seconds([&] { log = read_log_file(argv[2]); }));
    events = log.events.size();
    numbering.push_back(
        thread_seconds([&] { beats = number_beats(std::move(log.events), log.source); }));
    if (beats.spurious != 0 || beats.missed != 0 || beats.segments != 1) return 1;
  }
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const double both = median(reading) + median(numbering);
  std::printf("%zu crossings, %.0f MB; medians of %d runs\n", events, megabytes, runs);
  std::printf("read      %6.2f s  %5.0f MB/s\n", median(reading), megabytes / median(reading));
  std::printf("numbered  %6.2f s  %5.1f ns a crossing\n", median(numbering),
              1e9 * median(numbering) / static_cast<double>(events));
  std::printf("both      %6.2f s  %5.0f MB/s\n", both, megabytes / both);
  std::printf("memory of the whole process: %.1f bytes a crossing\n",
              1024.0 * static_cast<double>(use.ru_maxrss) / static_cast<double>(events));
}
