// The long form of the test of the numbering: 500 random logs with every fault, and the speed on a
// steady log. Prints a table.
#include "goingrate/base/thread_clock.hpp"
#include "support/faulty_text.hpp"

#include <cstdio>
#include <cstdlib>

namespace {

using namespace goingrate;
using test::NumberingScore;

double percent(std::int64_t part, std::int64_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

void print(const NumberingScore& s) {
  const auto n = [](std::int64_t value) { return static_cast<long long>(value); };
  std::printf("%lld logs, %lld events, %lld segments\n", n(s.logs), n(s.events), n(s.segments));
  std::printf("upward crossings            %9lld\n", n(s.good));
  std::printf("  numbered right            %9lld  (%.4f %% of those numbered)\n", n(s.right),
              percent(s.right, s.right + s.wrong));
  std::printf("  numbered wrong            %9lld  in %lld logs (%.2f %% of logs without)\n",
              n(s.wrong), n(s.logs_wrong), percent(s.logs - s.logs_wrong, s.logs));
  std::printf("  marked bad                %9lld  (%.2f of 1e4)\n", n(s.bad),
              100.0 * percent(s.bad, s.good));
  std::printf("  rival of the event taken  %9lld\n", n(s.rival));
  std::printf("false events                %9lld\n", n(s.false_events));
  std::printf("  taken for a missed beat   %9lld\n", n(s.missed_accepted));
  std::printf("  taken instead of a beat   %9lld\n", n(s.accepted));
  std::printf("downward crossings          %9lld  (%.4f %% right, %.2f of 1e4 marked bad)\n",
              n(s.downs), percent(s.downs_right, s.downs), 100.0 * percent(s.downs_bad, s.downs));
  std::printf("gaps of more than 8 cycles, by claimed probability of the count\n");
  const char* names[] = {"below 0.5", "0.5-0.9", "0.9-0.99", "0.99-0.999", "0.999-1"};
  for (std::size_t k = 0; k < s.bins.size(); ++k) {
    const auto& bin = s.bins[k];
    if (bin.gaps > 0)
      std::printf("  %-11s %5lld gaps, claimed %.4f, right %.4f, stops %lld\n", names[k],
                  n(bin.gaps), bin.claimed / static_cast<double>(bin.gaps),
                  0.01 * percent(bin.right, bin.gaps), n(bin.stops));
  }
  std::printf("stops of the clock among them: %lld, of which %lld bridged\n", n(s.breaks),
              n(s.stops_bridged));
}

// One row for each fault of loggers and users, every log along the road of the command.
void faults_one_by_one(std::uint64_t logs, std::uint64_t first) {
  std::printf(
      "\nfaults one by one, %llu logs each, as the command loads them; of 1e4 upward crossings "
      "on time\n",
      static_cast<unsigned long long>(logs));
  std::printf("%-20s %9s %8s %10s %9s %9s %9s\n", "", "crossings", "refused", "logs wrong", "wrong",
              "marked", "replaced");
  for (std::size_t k = 0; k < test::all_text_faults.size(); ++k) {
    test::NumberingJudge judge;
    std::uint64_t refused = 0;
    for (std::uint64_t seed = first; seed < first + logs; ++seed)
      refused +=
          test::judge_text(test::FaultyTextMaker(test::all_text_faults[k], seed).make(), judge) ? 0
                                                                                                : 1;
    const NumberingScore& s = judge.score();
    const auto of_1e4 = [&](std::int64_t part) { return 100.0 * percent(part, s.good); };
    std::printf("%-20s %9lld %8llu %10lld %9.2f %9.2f %9.2f\n", test::text_fault_names[k],
                static_cast<long long>(s.good), static_cast<unsigned long long>(refused),
                static_cast<long long>(s.logs_wrong), of_1e4(s.wrong), of_1e4(s.bad),
                of_1e4(s.accepted));
  }
  std::printf(
      "wrong: numbered otherwise than the rest of their segment; marked: as spurious or bounces; "
      "replaced: a false event was taken instead\n");
}

void steady_log() {
  constexpr int count = 10'000'000;
  RandomStream random(1, StreamPurpose::jitter);
  std::vector<Beat> events;
  events.reserve(count);
  for (int i = 0; i < count; ++i)
    events.push_back(event_at(Instant{2 * i, 0.5 + 1e-4 * random.normal()}));
  Beats beats;
  const double seconds = thread_seconds([&] { beats = number_beats(std::move(events), "steady"); });
  std::printf("%d steady beats: %.1f ns each (last is cycle %lld)\n", count, 1e9 * seconds / count,
              static_cast<long long>(beats.beats.back().cycle));
}

} // namespace

int main(int argc, char** argv) {
  const std::uint64_t logs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 5000;
  // Logs below 12001, and 20001 to 25000, were looked at while the numbering was made; these were
  // not.
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 70001;
  std::printf("seeds %llu to %llu\n", static_cast<unsigned long long>(first),
              static_cast<unsigned long long>(first + logs - 1));
  test::NumberingJudge judge;
  for (std::uint64_t seed = first; seed < first + logs; ++seed) {
    const test::FaultyLog made = test::FaultyLogMaker(seed).make();
    ClockLog log = made.log;
    mark_bounces(log);
    judge.add(made, number_beats(log));
  }
  print(judge.score());
  faults_one_by_one(std::max<std::uint64_t>(logs / 50, 1), first);
  steady_log();
}
