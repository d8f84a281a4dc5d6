#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dwell/v1/control.pb.h"

namespace dwell::client {

/// The messages carry numbers; people read names.
class Names {
 public:
  Names() = default;
  explicit Names(const v1::Snapshot& snapshot);

  void set_radar(std::uint32_t number, const std::string& name);
  void set_track(std::uint32_t id, const std::string& name);

  /// The radar's name; "#3" while it is not known.
  std::string radar(std::uint32_t number) const;
  /// "7 two"; "7" for a track without a name.
  std::string track(std::uint32_t id) const;
  /// The name alone, empty where there is none.
  std::string track_name(std::uint32_t id) const;
  /// Of the classes of targets, in their order; empty without.
  const std::vector<std::string>& classes() const { return classes_; }

 private:
  std::map<std::uint32_t, std::string> radar_;
  std::map<std::uint32_t, std::string> track_;
  std::vector<std::string> classes_;
};

}  // namespace dwell::client
