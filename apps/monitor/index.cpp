#include "index.hpp"

#include "sqlite_statement.hpp"

#include "goingrate/base/errors.hpp"

#include <filesystem>
#include <sys/stat.h>

namespace goingrate::apps {

namespace {

constexpr const char* schema = R"(
PRAGMA journal_mode = WAL;
PRAGMA user_version = 3;
CREATE TABLE IF NOT EXISTS day (day TEXT PRIMARY KEY, bytes INTEGER, changed INTEGER,
  first_seconds INTEGER, first_fraction REAL, first_cycle INTEGER);
CREATE TABLE IF NOT EXISTS hour (start INTEGER PRIMARY KEY, beats INTEGER, missed INTEGER,
  spurious INTEGER, amplitude_sum REAL, amplitudes INTEGER, beat_error_sum REAL,
  beat_errors INTEGER, last_cycle INTEGER, mark_seconds INTEGER, mark_fraction REAL,
  mark_cycle INTEGER, run INTEGER);
CREATE TABLE IF NOT EXISTS learnt (day TEXT PRIMARY KEY, numbers BLOB);
CREATE TABLE IF NOT EXISTS break (seconds INTEGER, fraction REAL, after_cycle INTEGER,
  missing INTEGER, probability REAL, UNIQUE (after_cycle));
CREATE TABLE IF NOT EXISTS alarm (at REAL, kind TEXT, raised INTEGER, text TEXT,
  UNIQUE (at, kind, raised));
)";

// A file's size and when it was last changed, ns since 1970; zeros if there is no such file.
struct FileState {
  std::int64_t bytes = 0, changed_ns = 0;
  bool operator==(const FileState&) const = default;
};

FileState state_of(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {found.st_size, found.st_mtim.tv_sec * 1'000'000'000 + found.st_mtim.tv_nsec};
}

} // namespace

struct ArchiveIndex::Database {
  sqlite3* handle = nullptr;
  std::string path;

  ~Database() { sqlite3_close(handle); }

  // SQLITE_OK, or the reason why the index cannot be used.
  [[nodiscard]] int open() {
    constexpr int patience_ms = 100; // while another program reads: beats must not wait longer
    int code = sqlite3_open(path.c_str(), &handle);
    if (code == SQLITE_OK) code = sqlite3_busy_timeout(handle, patience_ms);
    if (code == SQLITE_OK && is_older())
      code = sqlite3_exec(handle, "DROP TABLE day; DROP TABLE hour;", nullptr, nullptr, nullptr);
    if (code == SQLITE_OK) code = sqlite3_exec(handle, schema, nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) return code;
    return is_sound() ? SQLITE_OK : SQLITE_CORRUPT;
  }
  // Whether an earlier version of goingrate wrote it; its days are then computed anew.
  [[nodiscard]] bool is_older() const {
    std::string version;
    const auto keep = [](void* to, int, char** columns, char**) {
      *static_cast<std::string*>(to) = columns[0] != nullptr ? columns[0] : "";
      return 0;
    };
    sqlite3_exec(handle, "PRAGMA user_version", keep, &version, nullptr);
    return version == "1" || version == "2";
  }
  [[nodiscard]] bool is_sound() const {
    std::string says;
    const auto keep = [](void* to, int, char** columns, char**) {
      static_cast<std::string*>(to)->append(columns[0] != nullptr ? columns[0] : "");
      return 0;
    };
    return sqlite3_exec(handle, "PRAGMA quick_check(1)", keep, &says, nullptr) == SQLITE_OK &&
           says == "ok";
  }
  [[noreturn]] void fail() const { throw OutputError(path, sqlite3_errmsg(handle)); }
  void run(const char* sql) const {
    if (sqlite3_exec(handle, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
};

ArchiveIndex::ArchiveIndex(const std::string& folder) : folder_(folder) {
  const auto opened = [this](const std::string& path) {
    database_ = std::make_unique<Database>();
    database_->path = path;
    return database_->open();
  };
  const std::string path = folder + "/.index.sqlite";
  const int code = opened(path);
  if (code == SQLITE_OK) return;
  if (code == SQLITE_CORRUPT || code == SQLITE_NOTADB) {
    database_.reset();
    std::error_code ignored;
    for (const char* end : {"", "-wal", "-shm"})
      std::filesystem::remove(path + end, ignored);
    if (opened(path) == SQLITE_OK) return;
  }
  if (opened(":memory:") != SQLITE_OK) database_->fail();
}

ArchiveIndex::~ArchiveIndex() = default;

std::vector<std::string> ArchiveIndex::days() const {
  std::vector<std::string> days;
  Statement select(database_->handle, "SELECT day FROM day ORDER BY day");
  while (select.step())
    days.push_back(select.text());
  return days;
}

std::optional<Beat> ArchiveIndex::first_of_run(const std::string& day) const {
  Statement select(database_->handle,
                   "SELECT first_seconds, first_fraction, first_cycle FROM day WHERE day = ? AND "
                   "first_cycle IS NOT NULL");
  if (!select.bind(day).step()) return {};
  Instant at;
  at.seconds = select.whole();
  at.fraction = select.real();
  Beat first = event_at(at);
  first.cycle = select.whole();
  return first;
}

bool ArchiveIndex::is_of_the_files() const {
  Statement select(database_->handle, "SELECT day, bytes, changed FROM day");
  while (select.step()) {
    const std::string path = folder_ + "/" + select.text() + ".csv";
    FileState put;
    put.bytes = select.whole();
    put.changed_ns = select.whole();
    if (!(put == state_of(path))) return false;
  }
  return true;
}

std::vector<GoingBlock> ArchiveIndex::hours() const {
  std::vector<GoingBlock> hours;
  Statement select(
      database_->handle,
      "SELECT start, beats, missed, spurious, amplitude_sum, amplitudes, "
      "beat_error_sum, beat_errors, last_cycle, mark_seconds, mark_fraction, mark_cycle, run "
      "FROM hour ORDER BY start");
  while (select.step()) {
    GoingBlock h;
    h.start_s = select.whole();
    h.beats = select.whole();
    h.missed = select.whole();
    h.spurious = select.whole();
    h.amplitude_sum = select.real();
    h.amplitudes = select.whole();
    h.beat_error_sum = select.real();
    h.beat_errors = select.whole();
    h.last_cycle = select.whole();
    h.mark_time.seconds = select.whole();
    h.mark_time.fraction = select.real();
    h.mark_cycle = select.whole();
    h.run = select.whole();
    hours.push_back(h);
  }
  return hours;
}

std::vector<CountBreak> ArchiveIndex::breaks() const {
  std::vector<CountBreak> breaks;
  Statement select(database_->handle, "SELECT seconds, fraction, after_cycle, missing, probability "
                                      "FROM break ORDER BY seconds DESC LIMIT 500");
  while (select.step()) {
    CountBreak gap;
    gap.at.seconds = select.whole();
    gap.at.fraction = select.real();
    gap.after_cycle = select.whole();
    gap.missing = select.whole();
    gap.probability = select.real();
    breaks.push_back(gap);
  }
  return breaks;
}

std::vector<AlarmRecord> ArchiveIndex::alarms() const {
  std::vector<AlarmRecord> alarms;
  Statement select(database_->handle,
                   "SELECT at, kind, raised, text FROM alarm ORDER BY at DESC LIMIT 500");
  while (select.step()) {
    AlarmRecord alarm;
    alarm.at_s = select.real();
    alarm.kind = select.text();
    alarm.is_raised = select.whole() != 0;
    alarm.text = select.text();
    alarms.push_back(alarm);
  }
  return alarms;
}

void ArchiveIndex::put_day(const std::string& day, const std::vector<GoingBlock>& hours,
                           const std::optional<Beat>& first_of_run) {
  const Transaction transaction(database_->handle);
  database_->run("BEGIN");
  for (const GoingBlock& h : hours) {
    Statement insert(database_->handle,
                     "INSERT OR REPLACE INTO hour VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    insert.bind(h.start_s).bind(h.beats).bind(h.missed).bind(h.spurious).bind(h.amplitude_sum);
    insert.bind(h.amplitudes).bind(h.beat_error_sum).bind(h.beat_errors);
    insert.bind(h.last_cycle).bind(h.mark_time.seconds).bind(h.mark_time.fraction);
    insert.bind(h.mark_cycle).bind(h.run);
    insert.step();
    if (!insert.is_done()) database_->fail();
  }
  Statement insert(database_->handle, "INSERT OR REPLACE INTO day VALUES (?, ?, ?, ?, ?, ?)");
  const FileState file = state_of(folder_ + "/" + day + ".csv");
  insert.bind(day).bind(file.bytes).bind(file.changed_ns);
  if (first_of_run) {
    insert.bind(first_of_run->time.seconds).bind(first_of_run->time.fraction);
    insert.bind(first_of_run->cycle);
  }
  insert.step();
  if (!insert.is_done()) database_->fail();
  database_->run("COMMIT");
}

void ArchiveIndex::put_learnt(const std::string& day, const std::vector<double>& numbers) {
  Statement insert(database_->handle, "INSERT OR REPLACE INTO learnt VALUES (?, ?)");
  insert.bind(day).bind(numbers).step();
  if (!insert.is_done()) database_->fail();
  database_->run("DELETE FROM learnt WHERE day NOT IN (SELECT day FROM learnt ORDER BY day DESC "
                 "LIMIT 30)");
}

std::vector<double> ArchiveIndex::learnt(const std::string& day) const {
  Statement select(database_->handle, "SELECT numbers FROM learnt WHERE day = ?");
  return select.bind(day).step() ? select.reals() : std::vector<double>();
}

void ArchiveIndex::put_break(const CountBreak& gap) {
  Statement insert(database_->handle, "INSERT OR REPLACE INTO break VALUES (?, ?, ?, ?, ?)");
  insert.bind(gap.at.seconds).bind(gap.at.fraction).bind(gap.after_cycle).bind(gap.missing);
  insert.bind(gap.probability).step();
}

void ArchiveIndex::put_alarm(const AlarmRecord& alarm) {
  Statement insert(database_->handle, "INSERT OR REPLACE INTO alarm VALUES (?, ?, ?, ?)");
  insert.bind(alarm.at_s).bind(alarm.kind).bind(std::int64_t{alarm.is_raised}).bind(alarm.text);
  insert.step();
  if (!insert.is_done()) database_->fail();
}

void ArchiveIndex::clear() {
  database_->run("DELETE FROM day");
  database_->run("DELETE FROM hour");
  database_->run("DELETE FROM learnt");
  database_->run("DELETE FROM break");
  database_->run("DELETE FROM alarm");
}

} // namespace goingrate::apps
