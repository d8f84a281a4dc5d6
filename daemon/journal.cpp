#include "daemon/journal.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include <google/protobuf/io/zero_copy_stream_impl.h>
#include <google/protobuf/util/delimited_message_util.h>

#include "radar/violation.hpp"

namespace dwell {
namespace {

constexpr std::uint32_t kVersion = 1;

}  // namespace

JournalWriter::JournalWriter(const std::filesystem::path& file, const v1::JournalHeader& header)
    : file_(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644)) {
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), "cannot create journal " + file.string());
  v1::JournalRecord record;
  *record.mutable_header() = header;
  record.mutable_header()->set_version(kVersion);
  std::string problem;
  if (!append(record, problem)) {
    ::close(file_);
    throw std::runtime_error("journal " + file.string() + ": " + problem);
  }
}

JournalWriter::~JournalWriter() { ::close(file_); }

bool JournalWriter::append(const v1::JournalRecord& record, std::string& problem) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream output(&bytes);
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(record, &output);
  }
  const off_t before = ::lseek(file_, 0, SEEK_END);
  const ssize_t written = ::write(file_, bytes.data(), bytes.size());
  if (written == static_cast<ssize_t>(bytes.size()) && ::fdatasync(file_) == 0) return true;
  problem = written < 0 ? std::strerror(errno) : "disk full";
  // A torn record must not stand before the next one.
  if (before >= 0 && ::ftruncate(file_, before) != 0) problem += " (and the journal's end is torn)";
  return false;
}

Journal read_journal(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& field, const std::string& value, const std::string& rule) {
    throw InvalidInput(file.string(), {{field, value, rule}});
  };
  std::ifstream input(file, std::ios::binary);
  if (!input || std::filesystem::is_directory(file)) refuse("file", "", "cannot be read");
  google::protobuf::io::IstreamInputStream stream(&input);
  Journal journal;
  bool has_header = false;
  for (;;) {
    const std::int64_t offset = stream.ByteCount();
    v1::JournalRecord record;
    bool clean_end = false;
    if (!google::protobuf::util::ParseDelimitedFromZeroCopyStream(&record, &stream, &clean_end)) {
      if (!clean_end) refuse("record", "at byte " + std::to_string(offset), "is damaged or cut off");
      break;
    }
    if (has_header != !record.has_header()) refuse("record", "at byte " + std::to_string(offset), "is out of place");
    if (record.has_header()) {
      has_header = true;
      journal.header = std::move(*record.mutable_header());
      if (journal.header.version() != kVersion) {
        refuse("version", std::to_string(journal.header.version()), "must be " + std::to_string(kVersion));
      }
    } else if (record.has_request()) {
      const bool ordered =
          journal.requests.empty() || journal.requests.back().scan() <= record.request().scan();
      if (!ordered) refuse("request.scan", std::to_string(record.request().scan()), "must not go back");
      journal.requests.push_back(std::move(*record.mutable_request()));
    } else if (record.has_end()) {
      journal.end = record.end();
    }
  }
  if (!has_header) refuse("file", "", "has no journal header");
  return journal;
}

}  // namespace dwell
