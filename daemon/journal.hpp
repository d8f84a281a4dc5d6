#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dwell/v1/control.pb.h"

namespace dwell {

/// Writes what is needed to repeat a run: its config, and each request that changed it with its scan.
///
/// A record is its length (varint), the bytes of a JournalRecord, and the CRC-32 of both (4 bytes, least significant
/// first). It is on the disk (fdatasync) before the call returns.
class JournalWriter {
 public:
  /// Creates the file; an existing one is refused. Errors: std::system_error.
  JournalWriter(const std::filesystem::path& file, const v1::JournalHeader& header);
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// False, with the reason in `problem`, where the record could not be written.
  bool append(const v1::JournalRecord& record, std::string& problem);

 private:
  int file_;
};

/// What other threads had not done when it was due: the scans that went on without it.
struct LateResults {
  std::map<std::uint64_t, std::vector<std::uint64_t>> value_sets;  ///< keys
  std::set<std::uint64_t> calibrations;
};

/// A journal that was read whole.
struct Journal {
  v1::JournalHeader header;
  std::vector<v1::JournalRequest> requests;  ///< in order of their scans
  LateResults late;
  std::optional<v1::JournalEnd> end;  ///< empty where the run was cut off
};

/// Errors   InvalidInput: unreadable, no header, another version, a record that is damaged, cut off or out of place
///          (with its byte offset).
Journal read_journal(const std::filesystem::path& file);

}  // namespace dwell
