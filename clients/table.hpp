#pragma once

#include <string>
#include <vector>

#include "clients/text.hpp"

namespace dwell::client {

struct Column {
  std::string header;
  bool right = false;  // numbers stand right
  int rank = 0;        // where the page is too narrow the columns of the highest rank go first; 0 always stays
};

/// A table as wide as its cells, made to fit a page: columns are dropped by rank, rows beyond it are counted
/// in a last line "... 12 more tracks".
class Table {
 public:
  explicit Table(std::vector<Column> columns);

  /// One cell a column.
  void add(std::vector<std::string> cells, Mark mark = Mark::kPlain);

  /// `noun`: what the rows are, in the plural.
  Lines lines(const Page& page, const std::string& noun) const;

 private:
  struct Row {
    std::vector<std::string> cells;
    Mark mark;
  };

  std::vector<bool> columns_that_fit(int columns) const;
  std::string join(const std::vector<std::string>& cells, const std::vector<bool>& shown) const;

  std::vector<Column> columns_;
  std::vector<int> widths_;
  std::vector<Row> rows_;
};

}  // namespace dwell::client
