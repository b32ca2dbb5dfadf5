// Confusion of causes on clocks drawn from those people have, through analyse(): causes of the
// list, causes that are not in it, pairs, and health. Arguments: clocks of each kind (10), first
// seed (1), greatest length in days (3).
#include "support/sick_clocks.hpp"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <thread>

namespace {

using namespace goingrate;

struct Kind {
  std::vector<Cause> faults;
  bool in_list = true;
};

std::vector<Kind> kinds() {
  const std::vector<Cause> list{Cause::slow_drive,       Cause::drive_step,  Cause::friction_step,
                                Cause::growing_friction, Cause::temperature, Cause::pressure,
                                Cause::length_step,      Cause::wheel,       Cause::sensor_shift,
                                Cause::missed_beats,     Cause::rough_drive};
  std::vector<Kind> all;
  for (const Cause cause : list)
    all.push_back({{cause}});
  for (const Cause cause : {Cause::length_drift, Cause::log_clock, Cause::unlogged_weather,
                            Cause::knock, Cause::magnet, Cause::stop})
    all.push_back({{cause}, false});
  all.push_back({{Cause::length_step, Cause::temperature}});
  all.push_back({{Cause::missed_beats, Cause::slow_drive}});
  all.push_back({{Cause::wheel, Cause::growing_friction}});
  all.push_back({{}});
  return all;
}

std::string words_for(const std::vector<Cause>& faults) {
  std::string words;
  for (const Cause fault : faults)
    words += (words.empty() ? "" : " and ") + std::string(name_of(fault));
  return words.empty() ? "healthy" : words;
}

} // namespace

int main(int count, char** words) {
  const int each = count > 1 ? std::atoi(words[1]) : 10;
  const auto first_seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  const double longest = count > 3 ? std::atof(words[3]) : 3.0;
  const bool log_alone = count > 4 && std::string(words[4]) == "log";
  std::map<std::string, std::pair<int, int>> shares;
  std::printf("%-34s right  named first\n", "truth");
  std::uint64_t seed = first_seed;
  for (const Kind& kind : kinds()) {
    std::vector<std::vector<Suspicion>> found(static_cast<std::size_t>(each));
    const auto half = [&](std::size_t begin) {
      for (std::size_t i = begin; i < found.size(); i += 2) {
        RandomStream chance(seed + i, StreamPurpose::jitter);
        const test::SickClock clock{kind.faults, std::pow(longest, chance.uniform()), seed + i};
        found[i] = log_alone ? test::suspected(clock) : test::diagnosed(clock);
      }
    };
    std::thread other(half, 1);
    half(0);
    other.join();
    seed += found.size();
    std::map<std::string, int> named;
    int right = 0;
    for (const auto& suspicions : found) {
      ++named[suspicions.empty() ? "healthy" : std::string(name_of(suspicions[0].cause))];
      right += kind.faults.empty() ? suspicions.empty()
                                   : test::is_named(suspicions, kind.faults, kind.in_list);
    }
    auto& [sum, of] = shares[kind.faults.empty()      ? "healthy"
                             : !kind.in_list          ? "not in the list"
                             : kind.faults.size() > 1 ? "pairs"
                                                      : "in the list"];
    sum += right;
    of += each;
    std::printf("%-34s %2d/%d ", words_for(kind.faults).c_str(), right, each);
    for (const auto& [name, times] : named)
      std::printf(" %s %d,", name.c_str(), times);
    std::printf("\n");
    std::fflush(stdout);
  }
  for (const auto& [name, share] : shares)
    std::printf("%-16s %.3f of %d\n", name.c_str(), static_cast<double>(share.first) / share.second,
                share.second);
}
