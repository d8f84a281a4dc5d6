#include "clients/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace dwell::client {
namespace {

constexpr int kGap = 2;  // cells between two columns

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  for (const Column& column : columns_) widths_.push_back(display_width(column.header));
}

void Table::add(std::vector<std::string> cells, Mark mark) {
  for (std::size_t i = 0; i < columns_.size(); ++i) widths_[i] = std::max(widths_[i], display_width(cells.at(i)));
  rows_.push_back({std::move(cells), mark});
}

std::vector<bool> Table::columns_that_fit(int columns) const {
  std::vector<bool> shown(columns_.size(), true);
  for (;;) {
    int width = -kGap;
    std::size_t first_to_go = 0;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (!shown[i]) continue;
      width += widths_[i] + kGap;
      if (!shown[first_to_go] || columns_[i].rank > columns_[first_to_go].rank) first_to_go = i;
    }
    if (width <= columns || columns_[first_to_go].rank == 0) return shown;
    shown[first_to_go] = false;
  }
}

std::string Table::join(const std::vector<std::string>& cells, const std::vector<bool>& shown) const {
  std::string text;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (!shown[i]) continue;
    const std::string pad(static_cast<std::size_t>(widths_[i] - display_width(cells[i])), ' ');
    text += columns_[i].right ? pad + cells[i] : cells[i] + pad;
    text.append(kGap, ' ');
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

Lines Table::lines(const Page& page, const std::string& noun) const {
  const std::vector<bool> shown = columns_that_fit(page.columns);
  std::vector<std::string> headers;
  headers.reserve(columns_.size());
  for (const Column& column : columns_) headers.push_back(column.header);
  Lines lines{{join(headers, shown), Mark::kBold}};

  // The header and the count take a row each; one row of the table is shown whatever the page.
  const auto room = static_cast<std::size_t>(std::max(page.rows - 1, 2));
  const std::size_t count = rows_.size() <= room ? rows_.size() : room - 1;
  for (std::size_t i = 0; i < count; ++i) lines.push_back({join(rows_[i].cells, shown), rows_[i].mark});
  if (count < rows_.size()) lines.push_back({fmt::format("... {} more {}", rows_.size() - count, noun)});
  return lines;
}

}  // namespace dwell::client
