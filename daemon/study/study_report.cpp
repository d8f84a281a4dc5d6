#include "daemon/study/study_report.hpp"

#include <fstream>
#include <stdexcept>

#include <google/protobuf/text_format.h>

namespace dwell {

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream output(file, std::ios::binary);
  output << text << std::flush;
  if (!output) throw std::runtime_error("cannot write " + file.string());
}

void write_config(const std::filesystem::path& directory, const v1::Config& config) {
  std::string text;
  google::protobuf::TextFormat::PrintToString(config, &text);
  write_file(directory / "config.textproto", text);
}

}  // namespace dwell
