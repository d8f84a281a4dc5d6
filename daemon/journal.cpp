#include "daemon/journal.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/delimited_message_util.h>

#include "radar/violation.hpp"

namespace dwell {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kChecksumSize = 4;

/// CRC-32 of IEEE 802.3, reflected, bit by bit: a journal grows by a few records an hour.
std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::string checksum(std::string_view bytes) {
  const std::uint32_t crc = crc32(bytes);
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) text += static_cast<char>((crc >> shift) & 0xFFU);
  return text;
}

std::string framed(const v1::JournalRecord& record) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream output(&bytes);
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(record, &output);
  }
  return bytes + checksum(bytes);
}

/// The record at the start of `bytes` and its size in the file; empty where it is damaged or cut off.
std::optional<std::pair<v1::JournalRecord, std::size_t>> first_record(std::string_view bytes) {
  google::protobuf::io::CodedInputStream input(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                               static_cast<int>(bytes.size()));
  std::uint32_t length = 0;
  if (!input.ReadVarint32(&length)) return std::nullopt;
  const auto prefix = static_cast<std::size_t>(input.CurrentPosition());
  const std::size_t body = prefix + length;
  if (bytes.size() < body + kChecksumSize) return std::nullopt;
  if (bytes.substr(body, kChecksumSize) != checksum(bytes.substr(0, body))) return std::nullopt;
  v1::JournalRecord record;
  if (!record.ParseFromArray(bytes.data() + prefix, static_cast<int>(length))) return std::nullopt;
  return std::pair(std::move(record), body + kChecksumSize);
}

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
  const std::string bytes = framed(record);
  const off_t before = ::lseek(file_, 0, SEEK_END);
  const ssize_t written = ::write(file_, bytes.data(), bytes.size());
  const bool whole = written == static_cast<ssize_t>(bytes.size());
  if (whole && ::fdatasync(file_) == 0) return true;
  problem = written < 0 || whole ? std::strerror(errno) : "disk full";
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
  std::ostringstream content;
  content << input.rdbuf();
  const std::string bytes = content.str();
  Journal journal;
  for (std::size_t offset = 0; offset < bytes.size();) {
    auto next = first_record(std::string_view(bytes).substr(offset));
    const std::string place = "at byte " + std::to_string(offset);
    if (!next) refuse("record", place, "is damaged or cut off");
    auto& [record, size] = *next;
    if (record.has_header() != (offset == 0) || journal.end) refuse("record", place, "is out of place");
    offset += size;
    if (record.has_header()) {
      journal.header = std::move(*record.mutable_header());
      if (journal.header.version() != kVersion) {
        refuse("version", std::to_string(journal.header.version()), "must be " + std::to_string(kVersion));
      }
    } else if (record.has_request()) {
      const bool ordered = journal.requests.empty() || journal.requests.back().scan() <= record.request().scan();
      if (!ordered) refuse("request.scan", std::to_string(record.request().scan()), "must not go back");
      journal.requests.push_back(std::move(*record.mutable_request()));
    } else if (record.has_late_values()) {
      const auto& keys = record.late_values().key();
      journal.late.value_sets[record.late_values().scan()].assign(keys.begin(), keys.end());
    } else if (record.has_late_calibration()) {
      journal.late.calibrations.insert(record.late_calibration().scan());
    } else if (record.has_end()) {
      journal.end = record.end();
    }
  }
  if (bytes.empty()) refuse("file", "", "is empty");
  return journal;
}

}  // namespace dwell
