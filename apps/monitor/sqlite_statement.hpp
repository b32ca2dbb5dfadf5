// Statements and transactions of SQLite.
#pragma once

#include <cstdint>
#include <cstring>
#include <sqlite3.h>
#include <string>
#include <vector>

namespace goingrate::apps {

/// A prepared statement: values are bound in order, columns read in order.
class Statement {
public:
  Statement(sqlite3* handle, const char* sql) {
    sqlite3_prepare_v2(handle, sql, -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::int64_t value) {
    sqlite3_bind_int64(statement_, ++bound_, value);
    return *this;
  }
  Statement& bind(double value) {
    sqlite3_bind_double(statement_, ++bound_, value);
    return *this;
  }
  Statement& bind(const std::string& value) {
    sqlite3_bind_text(statement_, ++bound_, value.c_str(), -1, SQLITE_TRANSIENT);
    return *this;
  }
  Statement& bind(const std::vector<double>& values) {
    sqlite3_bind_blob64(statement_, ++bound_, values.data(), values.size() * sizeof(double),
                        SQLITE_TRANSIENT);
    return *this;
  }
  /// Whether there is a further row; false also where the statement failed.
  bool step() {
    read_ = 0;
    result_ = sqlite3_step(statement_);
    return result_ == SQLITE_ROW;
  }
  [[nodiscard]] bool is_done() const { return result_ == SQLITE_DONE; }
  std::int64_t whole() { return sqlite3_column_int64(statement_, read_++); }
  double real() { return sqlite3_column_double(statement_, read_++); }
  std::vector<double> reals() {
    const void* bytes = sqlite3_column_blob(statement_, read_);
    const int size = sqlite3_column_bytes(statement_, read_++);
    std::vector<double> values(static_cast<std::size_t>(size) / sizeof(double));
    if (bytes != nullptr) std::memcpy(values.data(), bytes, values.size() * sizeof(double));
    return values;
  }
  std::string text() {
    const auto* words = sqlite3_column_text(statement_, read_++);
    return words == nullptr ? "" : reinterpret_cast<const char*>(words);
  }

private:
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0, read_ = 0, result_ = SQLITE_OK;
};

/// Takes back what was not committed.
class Transaction {
public:
  explicit Transaction(sqlite3* handle) : handle_(handle) {}
  ~Transaction() {
    if (sqlite3_get_autocommit(handle_) == 0)
      sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

private:
  sqlite3* handle_;
};

} // namespace goingrate::apps
